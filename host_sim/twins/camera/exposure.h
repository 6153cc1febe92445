#pragma once
// All inputs of one exposure beside the settings of the camera: they determine the image bit for
// bit.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins::camera {

/// A spacecraft, in the field of view or not.
struct ObjectInView {
  std::string name;                                  ///< name of the spacecraft
  std::string model;                                 ///< its CAD file, data/models/<model>.obj
  fsw::Vector3 position_eci = fsw::Vector3::Zero();  ///< position of its body frame's origin from the camera, m
  fsw::Vector3 velocity_eci = fsw::Vector3::Zero();  ///< the same, m/s
  Eigen::Quaterniond q_body_eci = Eigen::Quaterniond::Identity();
  double sunlit = 1.0;  ///< visible fraction of the Sun's disc, 0 to 1

  friend bool operator==(const ObjectInView& a, const ObjectInView& b) {
    return a.name == b.name && a.model == b.model && a.position_eci == b.position_eci &&
           a.velocity_eci == b.velocity_eci && a.q_body_eci.coeffs() == b.q_body_eci.coeffs() && a.sunlit == b.sunlit;
  }
};

/// Inputs at the middle of the exposure; GCRF axes. Positions are geometric. Light time and aberration of a co-moving
/// object cancel, so objects are drawn where they are; stars, Sun and Moon are drawn where aberration puts them.
struct Exposure {
  fsw::GpsTime time;
  std::int64_t number = 0;                                           ///< from 0; selects the noise
  std::optional<double> duration_s = std::nullopt;                   ///< as commanded; otherwise that of the settings
  Eigen::Quaterniond q_camera_eci = Eigen::Quaterniond::Identity();  ///< camera axes: z boresight, x right, y down
  fsw::Vector3 rate_camera = fsw::Vector3::Zero();  ///< rate of the camera with respect to ECI, in its own axes, rad/s
  fsw::Vector3 camera_position_eci = fsw::Vector3::Zero();  ///< geocentric, m
  fsw::Vector3 camera_velocity_eci = fsw::Vector3::Zero();  ///< geocentric, m/s
  fsw::Vector3 earth_velocity_bcrs = fsw::Vector3::Zero();  ///< barycentric, m/s: for aberration
  fsw::Vector3 sun_eci = fsw::Vector3::Zero();              ///< geocentric, m
  fsw::Vector3 moon_eci = fsw::Vector3::Zero();             ///< geocentric, m
  double years_since_j2000 = 0.0;                           ///< Julian years of TT: for proper motion
  std::vector<ObjectInView> objects;
};

// Exposures from the truth of an instant, for a camera on one of the spacecraft.

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
