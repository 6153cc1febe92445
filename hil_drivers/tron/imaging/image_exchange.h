#pragma once
// One image: placement, lights, motion, measured pose, one correction, exposure.

#include <cstdint>
#include <optional>
#include <string>

#include "hil_drivers/tron/geometry/calibration.h"
#include "hil_drivers/tron/imaging/devices.h"
#include "host_sim/report/run_columns.h"

namespace vbar::tron {

// Row of tron.csv: one image of the testbed.

struct TronRow {
  double time_s = 0.0;      ///< middle of the exposure, since the mission's epoch
  std::int64_t image = 0;   ///< number of the exposure
  std::string failure;      ///< why it was not taken; empty: it was
  std::string pose_source;  ///< "fused", "arms"; empty: the target was not lit, and the arms did not move
  std::int64_t hidden = 0;  ///< keypoints and centre that the target's arm hides
  std::int64_t shaded = 0;  ///< lit points of the target's hull, four a face, in the shadow of an arm
  std::int64_t moves = 0;
  double bench_s = 0.0, move_s = 0.0;  ///< bench time: of the image, of its moves
  // Measured pose less the commanded one, laboratory lengths: after the first move, and after the correction.
  std::optional<double> first_error_mm, first_error_deg, pose_error_mm, pose_error_deg;
  std::optional<double> disagreement;  ///< chi-square between arms and motion capture, six degrees of freedom
  std::optional<double> lamp_azimuth_deg, sun_error_deg;
  double lamp_power = 0.0;
  std::optional<double> earth_light_misfit;  ///< rms over the normals, relative to the largest irradiance of the Earth
  std::optional<double> light_level;         ///< light of the target relative to the prediction
  std::int64_t tries = 0, packets_resent = 0;
  double plan_wall_s = 0.0, move_wall_s = 0.0, expose_wall_s = 0.0, mask_wall_s = 0.0;
};

template <report::columns::RowOf<TronRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  using report::ColumnName;
  visit(ColumnName{"time_s", "s, since the epoch of the mission: middle of the exposure"}, row.time_s);
  visit(ColumnName{"image", "number of the exposure"}, row.image);
  visit(ColumnName{"failure", "why it was not taken; empty: it was"}, row.failure);
  visit(ColumnName{"pose_source", "fused or arms; empty: the target was not lit, and the arms did not move"},
        row.pose_source);
  visit(ColumnName{"hidden", "keypoints and centre that the target's arm hides"}, row.hidden);
  visit(ColumnName{"shaded", "lit points of the target's hull in the shadow of an arm"}, row.shaded);
  visit(ColumnName{"moves", "of the arms for this image"}, row.moves);
  visit(ColumnName{"bench_s", "bench time of the image"}, row.bench_s);
  visit(ColumnName{"move_s", "bench time of its moves"}, row.move_s);
  visit(ColumnName{"first_error_mm", "measured minus commanded pose after the first move, laboratory lengths"},
        row.first_error_mm);
  visit(ColumnName{"first_error_deg", "measured minus commanded pose after the first move"}, row.first_error_deg);
  visit(ColumnName{"pose_error_mm", "the same after the correction"}, row.pose_error_mm);
  visit(ColumnName{"pose_error_deg", "the same after the correction"}, row.pose_error_deg);
  visit(ColumnName{"disagreement", "of arms and motion capture, chi-square of six degrees of freedom"},
        row.disagreement);
  visit(ColumnName{"lamp_azimuth_deg", "of the lamp on its rail"}, row.lamp_azimuth_deg);
  visit(ColumnName{"sun_error_deg", "between the direction of the lamp and that of the Sun"}, row.sun_error_deg);
  visit(ColumnName{"lamp_power", "share of the full power"}, row.lamp_power);
  visit(ColumnName{"earth_light_misfit", "rms over the normals, relative to the largest irradiance of the Earth"},
        row.earth_light_misfit);
  visit(ColumnName{"light_level", "light of the target relative to the prediction"}, row.light_level);
  visit(ColumnName{"tries", "images taken for it"}, row.tries);
  visit(ColumnName{"packets_resent", "by the camera"}, row.packets_resent);
  visit(ColumnName{"plan_wall_s", "wall-clock time of planning"}, row.plan_wall_s);
  visit(ColumnName{"move_wall_s", "wall-clock time of moving"}, row.move_wall_s);
  visit(ColumnName{"expose_wall_s", "wall-clock time of the exposure"}, row.expose_wall_s);
  visit(ColumnName{"mask_wall_s", "wall-clock time of masking"}, row.mask_wall_s);
}

struct ExchangeSettings {
  double correct_above_m = 0.5e-3, correct_above_rad = 3.5e-4;
  double fail_above_m = 5e-3, fail_above_rad = 5.2e-3;
  double lamp_speed_rad_s = 0.17;
  double lamp_delay_s = 0.1;  ///< bench time: nothing acknowledges a lighting level
  int restarts_in_row = 2;    ///< interruptions of an image after which the run ends
  double slipped_chi_square =
      50.0;  ///< limit between arms and motion capture, six degrees of freedom: one in 10^8 of good ones
  int disagreements_in_row = 5;  ///< images at which arms and motion capture disagree, after which the run ends
};

struct SceneImage {
  std::vector<std::uint16_t> dn;                            ///< empty: there is none, see row.failure
  Eigen::Isometry3d T_C_T = Eigen::Isometry3d::Identity();  ///< as measured
  bool is_lit = false;
};

class ImageExchange {
 public:
  ImageExchange(const ExchangeSettings& settings, const Calibration& calibration, MotionPlanner& motion,
                LightPlanner& lights, Laboratory& laboratory)
      : settings_(settings), calibration_(calibration), motion_(motion), lights_(lights), laboratory_(laboratory) {}

  /// Takes an image and fills its parts of the row. Throws std::runtime_error if the testbed cannot go on.
  SceneImage take(const Scene& scene, std::int64_t number, double exposure_s, TronRow& row);

  /// Takes an image with all lights off; the arms stay.
  DetectorFrame take_dark(double exposure_s);

 private:
  struct PoseError {
    double translation_m = 0.0, rotation_rad = 0.0;
  };
  struct Reached {
    Eigen::Isometry3d T_C_T;
    Posture posture;
    PoseError error;
  };

  std::optional<Reached> reach(const Scene& scene, std::int64_t number, TronRow& row, Place& place);
  bool go_to(const Posture& posture, TronRow& row);
  std::optional<Reached> measure(const Scene& scene, TronRow& row);
  void set_lights(const LightLevels& levels);
  bool wait_for_lamp();

  ExchangeSettings settings_;
  const Calibration& calibration_;
  MotionPlanner& motion_;
  LightPlanner& lights_;
  Laboratory& laboratory_;
  std::optional<double> lamp_azimuth_rad_;  ///< as sent last
  double lights_ready_s_ = 0.0;             ///< bench time
  int disagreements_ = 0;
};

}  // namespace vbar::tron
