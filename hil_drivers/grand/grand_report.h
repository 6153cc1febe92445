#pragma once
// Contributions of the testbed to record, summary and report: grand.csv, the object "grand" of summary.json, a section.

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hil_drivers/grand/generators/generator.h"
#include "hil_drivers/grand/grand_row.h"
#include "hil_drivers/grand/pps/edge_clock.h"
#include "hil_drivers/grand/receiver_link.h"
#include "host_sim/report/extension.h"
#include "host_sim/report/provenance.h"

namespace vbar::grand {

/// Figures at the end of a run, beside the rows.
struct RunFigures {
  Pace pace = Pace::kLockStep;
  std::string_view generator;
  std::vector<report::FileDigest> bench_files;  ///< program and scenario of an emulator; empty: hardware
  bool is_emulated = false;
  std::map<std::string, int> faults;                              ///< faults of an emulator that have taken effect
  std::map<std::string, double> generator_counters;               ///< of an emulator: samples as they arrived
  std::optional<EdgeStatistics> edges;                            ///< real time with edges only
  std::vector<std::pair<std::string, LinkStatistics>> receivers;  ///< by spacecraft
};

/// Adds the figures to record.summary.testbeds["grand"] and the files to its provenance.
void add_figures(const RunFigures& figures, report::RunRecord& record);

// Parts of the extension.
[[nodiscard]] std::vector<report::TableKind> tables();
void summarise(const report::RunRecord& record, report::Summary& summary);
[[nodiscard]] std::vector<report::Section> sections(const report::RunRecord& record);

}  // namespace vbar::grand
