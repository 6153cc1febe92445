#pragma once
// Row of tron.csv: one image of the testbed.

#include <cstdint>
#include <optional>
#include <string>

#include "host_sim/report/run_columns.h"

namespace vbar::tron {

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

}  // namespace vbar::tron
