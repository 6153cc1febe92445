#pragma once
// Exposures from the truth of an instant, for a camera on one of the spacecraft.

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/exposure.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins::camera {

/// Mounting of a camera on its spacecraft, and the shapes of the other spacecraft.
struct CameraMount {
  std::string spacecraft;
  Eigen::Quaterniond q_camera_body = Eigen::Quaterniond::Identity();
  fsw::Vector3 position_body = fsw::Vector3::Zero();  ///< from the centre of mass, m

  /// A spacecraft with a shape.
  struct Model {
    std::string spacecraft;
    std::string model;                                        ///< its CAD file
    fsw::Vector3 centre_of_mass_body = fsw::Vector3::Zero();  ///< from the origin of the file's axes, m
  };
  std::vector<Model> models;
};

/// Returns the share of the Sun's disc that the ellipsoidal Earth leaves uncovered; geocentric, m.
double sunlit_fraction(const fsw::Vector3& position_eci, const fsw::Vector3& sun_eci);

/// Returns exposure `number` at the instant of `truth`. The objects are the spacecraft of `mount.models` other than the
/// camera's own, in that order; those that the truth lacks, or that have no attitude, are omitted. Sun, Moon and the
/// Earth's velocity by ERFA, sunlight on the objects by the umbra and penumbra of the ellipsoidal Earth. Throws
/// std::invalid_argument, which names what is missing, if the camera's spacecraft or its attitude is.
Exposure exposure_of_truth(const CameraMount& mount, const TruthSnapshot& truth, std::int64_t number);

}  // namespace vbar::twins::camera
