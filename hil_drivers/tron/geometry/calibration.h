#pragma once
// Result of a calibration of TRON: `vbar_tron calibrate` writes the file, and the driver reads it.
//
// Frames as in testbed_design.h. C camera, T target, V frame of motion capture, OC and OT its objects on camera and
// target.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "hil_drivers/tron/geometry/calibrated_chain.h"
#include "hil_drivers/tron/geometry/kinematics.h"
#include "hil_drivers/tron/geometry/testbed_design.h"

namespace vbar::tron {

// Pinhole camera with Brown-Conrady distortion, as OpenCV orders its terms, for any scalar.

/// Returns the pixel of a point in camera axes; `focal_centre`: fx, fy, cx, cy; `distortion`: k1, k2, p1, p2, k3.
template <typename T>
Eigen::Matrix<T, 2, 1> project_point(const std::array<T, 4>& focal_centre, const T* distortion,
                                     const Eigen::Matrix<T, 3, 1>& point) {
  const T x = point.x() / point.z(), y = point.y() / point.z();
  const T r2 = x * x + y * y;
  const T radial = T(1.0) + r2 * (distortion[0] + r2 * (distortion[1] + r2 * distortion[4]));
  const T xd = x * radial + T(2.0) * distortion[2] * x * y + distortion[3] * (r2 + T(2.0) * x * x);
  const T yd = y * radial + distortion[2] * (r2 + T(2.0) * y * y) + T(2.0) * distortion[3] * x * y;
  return {focal_centre[0] * xd + focal_centre[2], focal_centre[1] * yd + focal_centre[3]};
}

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Holds a pose as the file has it.
struct PoseFigures {
  std::array<double, 3> rotation_rad{};  ///< rotation vector
  std::array<double, 3> translation_m{};
  [[nodiscard]] Eigen::Isometry3d isometry() const;
  static PoseFigures of(const Eigen::Isometry3d& pose);
};

/// States where and with which devices the calibration was made.
struct CalibrationValidity {
  std::string date_utc;  ///< ISO 8601
  std::string bench;     ///< name of the bench file
  bool emulated = false;
  std::uint64_t seed = 0;  ///< seed of the choice of poses and, if emulated, of the emulator
  std::string camera_model, camera_serial;
  std::string data_sha256;  ///< digest of the file of raw data
};

struct LensCalibration {
  int width_px = 1920, height_px = 1200;
  double fx_px = 0.0, fy_px = 0.0, cx_px = 0.0, cy_px = 0.0;  ///< an integer is the centre of a pixel
  std::array<double, 5> distortion{};  ///< Brown-Conrady k1, k2, p1, p2, k3, as OpenCV orders them

  /// Returns the pixel of a point in C, m.
  [[nodiscard]] fsw::Vector2 project(const fsw::Vector3& point_C) const;
};

struct ArmCalibration {
  ArmLengths lengths;                                     ///< as designed
  PoseFigures base;                                       ///< T_L_base; of the arm on the track, T_carriage_base
  std::array<double, kJoints> offset_rad{};               ///< added to the joints that the controller states
  std::array<std::array<double, 6>, kLinkErrors> link{};  ///< after A1..A5: rotation vector, rad; translation, m
  std::array<double, kFlexes> flex_rad_m{};               ///< flex of A2 and A3, per metre of horizontal lever
  PoseFigures mount;                                      ///< X_C = T_flange_C, X_T = T_flange_T
};

struct TrackCalibration {
  TrackGrid grid;
  double scale = 0.0;
  std::vector<std::array<double, kTrackErrors>> knots;  ///< roll, pitch, yaw, rad; sideways, height, m
};

struct ViconCalibration {
  std::string rotation = "xyz";  ///< order of the matrices, found by the calibration
  PoseFigures T_C_object;        ///< OC in C
  PoseFigures T_object_T;        ///< T in OT
  PoseFigures T_V_L;             ///< laboratory frame in the frame of motion capture
};

/// Holds the covariance of an error of T_C_T in the camera's axes: rotation vector, rad (R_true = exp(error) R), and
/// translation divided by the range.
struct SourceCovariances {
  Matrix6 arms = Matrix6::Zero(), vicon = Matrix6::Zero();
};

/// Holds the light of a source at levels of its DMX value (share of 65535), relative to that at full power.
struct LightTable {
  std::string source;  ///< "lamp", "box 1" .. "box 10"
  std::vector<double> level, light;
};

struct CameraCalibration {
  int bits = 12;
  double offset_dn = 0.0;
  double read_noise_dn = 0.0;
  /// Level of the lamp at full power on a white patch that faces it, per second of exposure, DN above the offset.
  double lamp_dn_per_s = 0.0;
};

/// Holds the errors of a source over the poses that were not fitted.
struct ErrorFigures {
  double translation_mean_mm = 0.0, translation_sigma_mm = 0.0, translation_median_mm = 0.0;
  double rotation_mean_deg = 0.0, rotation_sigma_deg = 0.0, rotation_median_deg = 0.0;
  double pixel_mean_px = 0.0, pixel_sigma_px = 0.0, pixel_median_px = 0.0;
};

struct StageFigures {
  std::string stage;  ///< "mounts", "offsets and mounts", ... "fused"
  int poses = 0;
  ErrorFigures board;                 ///< against the pose of the board by the image
  std::optional<ErrorFigures> truth;  ///< errors against the truth of an emulator
};

struct Calibration {
  CalibrationValidity validity;
  LensCalibration lens;
  ArmCalibration camera_arm, target_arm;
  TrackCalibration track;
  ViconCalibration vicon;
  SourceCovariances covariance;
  std::vector<LightTable> lights;
  CameraCalibration camera;
  std::vector<StageFigures> figures;
};

/// Returns the calibration as designed, without any error: the start of a fit.
[[nodiscard]] Calibration calibration_as_designed(const TestbedDesign& bench);

/// Returns laboratory poses by the calibrated chain.
[[nodiscard]] Eigen::Isometry3d T_L_C_of_arm(const Calibration& calibration, const Posture& posture);
[[nodiscard]] Eigen::Isometry3d T_L_T_of_arm(const Calibration& calibration, const Posture& posture);
/// Returns the relative pose by the arms.
[[nodiscard]] Eigen::Isometry3d T_C_T_of_arms(const Calibration& calibration, const Posture& posture);
/// Returns the relative pose by motion capture, from the poses of its two objects in its frame.
[[nodiscard]] Eigen::Isometry3d T_C_T_of_vicon(const Calibration& calibration, const Eigen::Isometry3d& T_V_camera,
                                               const Eigen::Isometry3d& T_V_target);

/// Returns the covariance of SourceCovariances at the pose T_C_T, as fusion takes it: of the vector [rotation, rad;
/// translation, m] in the axes of T with T_true = T_C_T exp(vector).
[[nodiscard]] Matrix6 covariance_at(const Matrix6& covariance_camera, const Eigen::Isometry3d& T_C_T);

/// Throws a MissionError that names the file and the key if the file is missing, damaged or not a calibration.
[[nodiscard]] Calibration load_calibration(const std::filesystem::path& file);
[[nodiscard]] Calibration parse_calibration(std::string_view text, const std::string& file);

/// Returns TOML; the shortest decimal numbers that read back as the same bits.
[[nodiscard]] std::string toml_of(const Calibration& calibration);
/// Replaces the file as a whole.
void save_calibration(const Calibration& calibration, const std::filesystem::path& file);

}  // namespace vbar::tron
