#pragma once
// What a module outside this library adds to the record of a run: tables, figures of the summary, a section of the
// report. A sensor's module is one (host_sim/sensors).

#include <algorithm>
#include <span>
#include <vector>

#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/published_figures.h"
#include "host_sim/report/table_kind.h"

namespace vbar::report {

/// A normalised square of navigation: chi-square distributed with `dimension` degrees of freedom if consistent.
struct ConsistencyFigure {
  enum class Kind { kNees, kNis };
  double time_s = 0.0;  ///< since the mission's epoch
  Kind kind = Kind::kNees;
  double value = 0.0;
  double dimension = 0.0;
};

/// Functions that are null add nothing.
struct Extension {
  std::vector<TableKind> (*tables)() = nullptr;
  /// Computes the figures of the module from its tables.
  void (*summarise)(const RunRecord& record, Summary& summary) = nullptr;
  /// Makes the sections of the module; those without content are left out, as the run has nothing to show.
  std::vector<Section> (*sections)(const RunRecord& record) = nullptr;
  /// Messages of telemetry whose every field is in a table of the module, with the truth beside it: they have no table
  /// of their own.
  std::span<const fsw::packets::Apid> messages{};
  /// Published figures of the experiment that the run repeats; none for any other run.
  std::vector<PaperColumn> (*paper_columns)(const RunRecord& record) = nullptr;
  /// Consistency figures of navigation by the module, in order of time.
  std::vector<ConsistencyFigure> (*consistency)(const RunRecord& record) = nullptr;
};

/// Whether a module makes rows of the message.
[[nodiscard]] inline bool is_in_table_of_module(Extensions extensions, fsw::packets::Apid message) {
  return std::ranges::any_of(extensions, [message](const Extension* extension) {
    return std::ranges::find(extension->messages, message) != extension->messages.end();
  });
}

}  // namespace vbar::report
