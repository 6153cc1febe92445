#include "host_sim/report/run_record.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "host_sim/sensors/gnss/gnss_row.h"

namespace vbar::sensors {

using report::ConsistencyFigure;

std::vector<ConsistencyFigure> gnss_consistency(const report::RunRecord& record) {
  constexpr double kStates = 6.0;
  std::vector<ConsistencyFigure> figures;
  for (const auto& [time_s, nees] : gnss_nees(record))
    figures.push_back({time_s, ConsistencyFigure::Kind::kNees, nees, kStates});
  std::int32_t pairs = 0;
  for (const GnssRow& row : record.tables.rows<GnssRow>()) {
    const bool is_new = row.pairs != pairs;  // a step without new measurements repeats the figures
    pairs = row.pairs;
    if (!is_new) continue;
    figures.push_back({row.time_s, ConsistencyFigure::Kind::kNis, row.code_nis + row.phase_nis,
                       static_cast<double>(row.codes_used + row.phases_used)});
  }
  return figures;
}

}  // namespace vbar::sensors
