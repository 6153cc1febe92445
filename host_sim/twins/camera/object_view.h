#pragma once
// The light of an extended object as a camera receives it: many points, each with direction and flux.

#include <functional>
#include <string>
#include <vector>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::twins::camera {

struct LightSample {
  fsw::Vector3 direction_camera = fsw::Vector3::UnitZ();  ///< towards it, unit
  double photons_per_m2_s = 0.0;  ///< at the lens, as CameraSettings::zero_magnitude_photons counts them
};

// The interface between scene and renderers of spacecraft.

/// A spacecraft in view of the camera and its illumination; camera axes.
struct ObjectView {
  std::string model;                                     ///< its CAD file, data/models/<model>.obj
  fsw::Vector3 position_camera = fsw::Vector3::UnitZ();  ///< position of its body frame's origin, m
  fsw::Matrix3 R_camera_body = fsw::Matrix3::Identity();
  fsw::Vector3 sun_direction_camera = fsw::Vector3::UnitZ();    ///< unit
  double sun_photons_per_m2_s = 0.0;                            ///< that reach it: none in the Earth's shadow
  fsw::Vector3 earth_direction_camera = fsw::Vector3::UnitZ();  ///< to the middle of the Earth's light, unit
  double earth_photons_per_m2_s = 0.0;                          ///< on a surface that looks there
  double earth_half_angle = 1.1;  ///< half angle of the Earth's disc as the object sees it, rad
  double pixel_rad = 0.0;         ///< angle subtended by a pixel of the camera
};

/// Appends the object's light to `out`. One call at a time.
using ObjectRenderer = std::function<void(const ObjectView& view, std::vector<LightSample>& out)>;

/// Replaces `covered` by the fraction of each pixel of `region`, in rows, in which the object hides the
/// background. One call at a time.
using ObjectCover = std::function<void(const ObjectView& view, const Projection& optics, const Region& region,
                                       std::vector<float>& covered)>;

// The simplest spacecraft model: a Lambert sphere. Its light is known in closed form.

/// Renders every model as a Lambert sphere of `radius_m` and `albedo` in the Sun's light alone, by `points_across`
/// points over its disc. At a distance its flux is that of the sunlight times (2/3) albedo (radius/distance)^2 (sin a +
/// (pi - a) cos a)/pi at the phase angle a (Russell 1916).
ObjectRenderer lambert_sphere(double radius_m, double albedo, int points_across = 96);

}  // namespace vbar::twins::camera
