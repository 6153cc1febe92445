#pragma once
// Raw data of a calibration, from which a fit can be repeated.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "hil_drivers/tron/geometry/calibration.h"
#include "hil_drivers/tron/geometry/kinematics.h"

namespace vbar::tron::calibrate {

// Measurements of a calibration at a posture of the testbed.

/// Holds a corner of the board in an image.
struct Corner {
  int id = 0;  ///< BoardDesign::corner()
  fsw::Vector2 px = fsw::Vector2::Zero();
};

/// Holds the poses of the objects of motion capture, averaged at rest; rotations by the order of the bench file.
struct ViconObjects {
  Eigen::Isometry3d T_V_camera = Eigen::Isometry3d::Identity(), T_V_target = Eigen::Isometry3d::Identity();
};

struct Measurement {
  Posture posture;  ///< as the controllers state it, at rest
  std::vector<Corner> corners;
  std::optional<ViconObjects> vicon;
  /// True relative pose of the target's frame, from an emulator. A fit never uses it.
  std::optional<Eigen::Isometry3d> true_T_C_T;
};

/// Returns the pose whose three angles, which were taken as rotations in the order `from`, are in the order `to`
/// ("xyz": Rx Ry Rz).
[[nodiscard]] Eigen::Isometry3d reordered(const Eigen::Isometry3d& pose, const std::string& from,
                                          const std::string& to);

/// Holds the light of the white patch with one source on.
struct LightSample {
  std::string source;     ///< name of LightTable
  double level = 0.0;     ///< share of the largest value
  double dn_per_s = 0.0;  ///< mean over the patch above that with all off, per second of exposure
  double design_irradiance =
      0.0;  ///< irradiance of the patch at full power as designed, relative to that of the lamp on an area facing it
};

struct DarkFigures {
  double offset_dn = 0.0, read_noise_dn = 0.0;
};

struct CalibrationData {
  CalibrationValidity validity;  ///< without the digest
  int width_px = 1600, height_px = 1000, bits = 12;
  std::vector<Measurement> fitted, judged;
  std::vector<LightSample> lights;
  DarkFigures dark;
};

/// Returns JSON, one measurement a line; numbers read back as the same bits.
[[nodiscard]] std::string text_of(const CalibrationData& data);
void save_data(const CalibrationData& data, const std::filesystem::path& file);

/// Throws std::runtime_error, which names the file and the place in it, for anything else than what text_of writes.
[[nodiscard]] CalibrationData parse_data(std::string_view text, const std::string& file);
[[nodiscard]] CalibrationData load_data(const std::filesystem::path& file);

/// Adds the true poses of an emulator to the measurements, from the table of its exposures (truth.csv): the poses of
/// the board, found by their postures. Throws std::runtime_error, which names the file, if it is damaged; returns the
/// number of measurements found in the table.
int add_truth(std::vector<Measurement>& measurements, const std::filesystem::path& truth,
              const Eigen::Isometry3d& T_target_board);

}  // namespace vbar::tron::calibrate
