#pragma once
// The truth of an instant as a camera on one of the spacecraft sees it.

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/exposure.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins::camera {

/// How a camera sits on its spacecraft, and what else is about.
struct CameraMount {
  std::string spacecraft;
  Eigen::Quaterniond q_camera_body = Eigen::Quaterniond::Identity();
  fsw::Vector3 position_body = fsw::Vector3::Zero();  ///< from the centre of mass, m

  /// A spacecraft that has a shape.
  struct Model {
    std::string spacecraft;
    std::string model;                                        ///< its CAD file
    fsw::Vector3 centre_of_mass_body = fsw::Vector3::Zero();  ///< from the origin of the file's axes, m
  };
  std::vector<Model> models;
};

/// Share of the Sun's disc that the ellipsoidal Earth leaves uncovered; geocentric, m.
double sunlit_fraction(const fsw::Vector3& position_eci, const fsw::Vector3& sun_eci);

/// Exposure `number` at the instant of `truth`. The objects are the spacecraft of `mount.models` other than the
/// camera's own, in that order; those that the truth lacks, or that have no attitude, are left out. Sun, Moon and the
/// Earth's velocity by ERFA, sunlight on the objects by the umbra and penumbra of the ellipsoidal Earth. Throws
/// std::invalid_argument, which says what is missing, if the camera's spacecraft or its attitude is.
Exposure exposure_of_truth(const CameraMount& mount, const TruthSnapshot& truth, std::int64_t number);

}  // namespace vbar::twins::camera
