#include "host_sim/report/run_record.h"
#include "host_sim/sensors/camera/camera_report.h"
#include "host_sim/sensors/camera/camera_rows.h"

namespace vbar::sensors {

using report::ConsistencyFigure;
using Kind = ConsistencyFigure::Kind;

std::vector<ConsistencyFigure> image_consistency(const report::RunRecord& record) {
  constexpr double kStates = 6.0, kBearing = 2.0;
  std::vector<ConsistencyFigure> figures;
  for (const ImageRow& row : record.tables.rows<ImageRow>()) {
    if (row.nees) figures.push_back({row.time_s, Kind::kNees, *row.nees, kStates});
    if (row.fate == telemetry_image::kEditFilter) figures.push_back({row.time_s, Kind::kNis, row.nis, kBearing});
  }
  for (const PoseRow& row : record.tables.rows<PoseRow>()) {
    if (row.nees) figures.push_back({row.time_s, Kind::kNees, *row.nees, kStates});
    if (row.fate == telemetry_pose::kEditKeypoints)
      figures.push_back({row.time_s, Kind::kNis, row.nis, static_cast<double>(row.nis_degrees)});
  }
  return figures;
}

}  // namespace vbar::sensors
