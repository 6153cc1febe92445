#pragma once
// Random vectors and rotations.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "fsw/vision/pose/crop.h"
#include "fsw/vision/pose/keypoint.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/model/cad_model.h"

namespace vbar::training {

inline double log_uniform(double low, double high, engine::RandomStream& stream) {
  return low * std::exp(stream.uniform() * std::log(high / low));
}

inline std::size_t index_below(std::size_t count, engine::RandomStream& stream) {
  return std::min(static_cast<std::size_t>(stream.uniform() * static_cast<double>(count)), count - 1);
}

inline fsw::Vector3 normal_vector(engine::RandomStream& stream) {
  const double x = stream.normal(), y = stream.normal(), z = stream.normal();
  return {x, y, z};
}

/// Draws a unit vector uniform on the sphere.
inline fsw::Vector3 unit_vector(engine::RandomStream& stream) {
  return normal_vector(stream).normalized();
}

/// Draws a unit vector uniform on the circle about `axis` (unit).
inline fsw::Vector3 perpendicular(const fsw::Vector3& axis, engine::RandomStream& stream) {
  const fsw::Vector3 v = unit_vector(stream);
  return (v - axis * axis.dot(v)).normalized();
}

/// Draws a unit vector at `angle` (rad) from `axis` (unit), uniform about it.
inline fsw::Vector3 at_angle(const fsw::Vector3& axis, double angle, engine::RandomStream& stream) {
  return std::cos(angle) * axis + std::sin(angle) * perpendicular(axis, stream);
}

/// Draws an attitude uniform on SO(3).
inline Eigen::Quaterniond attitude(engine::RandomStream& stream) {
  const double w = stream.normal(), x = stream.normal(), y = stream.normal(), z = stream.normal();
  return Eigen::Quaterniond(w, x, y, z).normalized();
}

// The keypoints of the target that training labels.

/// The target in body axes, everything from the centre of mass, m.
struct TargetShape {
  fsw::pose::KeypointShape keypoints;
  fsw::Vector3 model_origin = fsw::Vector3::Zero();  ///< origin of the CAD file
  double radius_m = 0.0;                             ///< distance of the farthest keypoint

  /// Loads the target whose body file has this name; throws mission::MissionError.
  static TargetShape load(const std::filesystem::path& data_directory, const std::string& target);
};

// The purpose of crops.

/// Purpose of a crop. Held-out crops show materials near those of the target's own file, unlike all crops of the other
/// kinds.
enum class CropKind { kTraining, kCalibration, kHeldOut };

[[nodiscard]] constexpr std::string_view name_of(CropKind kind) {
  switch (kind) {
    case CropKind::kCalibration:
      return "calibration";
    case CropKind::kHeldOut:
      return "held_out";
    case CropKind::kTraining:
      break;
  }
  return "training";
}

// Surface materials of the target in one crop: they have not been measured, so the network is trained with many.

inline constexpr double kOwnFamily = 0.3;  ///< share of a value, either way: limit of what counts as near the file's

/// Draws grey materials for the faces, one for each of `file`'s. Training and calibration: diffuse and specular part a
/// third to three times those of the material itself or (three in ten) of another one, exponents a fifth to five times;
/// never both parts within kOwnFamily of the material itself. Held out: both parts and the exponent within kOwnFamily.
[[nodiscard]] std::vector<twins::camera::Material> draw_materials(CropKind kind,
                                                                  std::span<const twins::camera::Material> file,
                                                                  engine::RandomStream& stream);

/// Whether both parts of `drawn` are within kOwnFamily of `own`.
[[nodiscard]] bool is_of_own_family(const twins::camera::Material& drawn, const twins::camera::Material& own);

// The scene of one crop: pose of the target, illumination, background, exposure and region of the crop.

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
inline constexpr double kMinRangeM = 4.0;
inline constexpr double kMaxRangeM = 15.0;

}  // namespace vbar::training
