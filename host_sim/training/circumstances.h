#pragma once
// The scene of one crop: pose of the target, illumination, background, exposure and region of the crop.

#include <filesystem>

#include <Eigen/Geometry>

#include "fsw/pose/crop.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/training/target_shape.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::training {

/// Returns the close-range camera with its binning: TRON's lens, pixels in groups of 2 x 2 (data/cameras/tron.toml).
/// Its exposure is kNominalExposureS.
[[nodiscard]] twins::camera::CameraSettings close_range_camera(const std::filesystem::path& data_directory);

/// Exposure at which a white surface that faces the Sun and the camera fills 60 % of the full well.
inline constexpr double kNominalExposureS = 47e-6;

/// Scene of a crop. Camera axes: z boresight, x right, y down.
struct Circumstances {
  fsw::Vector3 centre_of_mass_camera = fsw::Vector3::Zero();  ///< position of the target's centre of mass, m
  fsw::Matrix3 R_camera_body = fsw::Matrix3::Identity();
  fsw::Vector3 sun_camera = fsw::Vector3::UnitZ();                   ///< unit
  fsw::Vector3 nadir_camera = fsw::Vector3::UnitY();                 ///< unit
  Eigen::Quaterniond q_camera_eci = Eigen::Quaterniond::Identity();  ///< orientation of the sky
  double phase_angle = 0.0;                                          ///< Sun, target, camera; rad
  double sunlit = 1.0;                                               ///< share of the Sun's disc
  double exposure = 1.0;                                             ///< in kNominalExposureS
  double point_spread_sigma_px = 0.8;
  double glow_electrons = 0.0;                     ///< even stray light, a pixel
  fsw::Vector2 glow_slope = fsw::Vector2::Zero();  ///< its change over the crop, relative
  fsw::pose::CropRegion region;
};

/// Draws the scene of a crop. A camera 700 km up looks about level (seven in ten) or has the Earth in its field. The
/// Sun is 15 to 130 deg from behind the camera as the target sees it, at times to 150 deg, and is never behind the
/// Earth. The range is 4 to 15 m; attitudes are uniform over all rotations. Only the radius of `shape` is used.
[[nodiscard]] Circumstances draw_circumstances(const twins::camera::CameraSettings& camera, const TargetShape& shape,
                                               engine::RandomStream& stream);

inline constexpr double kAltitudeM = 700e3;
inline constexpr double kLeastRangeM = 4.0;
inline constexpr double kMostRangeM = 15.0;

}  // namespace vbar::training
