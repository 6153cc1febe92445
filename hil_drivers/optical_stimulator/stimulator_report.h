#pragma once
// Contribution of the testbed to record, summary and report: bench.csv, the object "optical_stimulator" of
// summary.json, a section.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hil_drivers/optical_stimulator/hardware/devices.h"
#include "hil_drivers/optical_stimulator/imaging/self_check.h"
#include "hil_drivers/optical_stimulator/optics/calibration.h"
#include "host_sim/report/extension.h"
#include "host_sim/report/provenance.h"
#include "host_sim/report/run_columns.h"

namespace vbar::optical_stimulator {

// Row of bench.csv: one image of the testbed.

struct StimulatorRow {
  double time_s = 0.0;     ///< middle of the exposure, since the mission's epoch
  std::int64_t image = 0;  ///< number of the exposure
  std::int64_t frame = 0;  ///< number of the picture in the frame strip
  std::int64_t tries = 1;  ///< images taken for it
  std::int64_t stale = 0;  ///< images of another picture or of an earlier trigger, refused
  std::int64_t packets_resent = 0, reconnects = 0;
  // Wall-clock times.
  double render_s = 0.0;          ///< scene to expected electrons to counts
  double show_s = 0.0;            ///< until the picture is on the screen, and its settling
  double receive_s = 0.0;         ///< from the trigger until the image is whole: exposure, readout, transfer
  double strip_brightness = 0.0;  ///< relative to the calibration
  std::optional<double> rail_lens_mm, rail_display_mm;  ///< set for an image after which the rails were asked
  std::int64_t points = 0;                              ///< drawn with matched counts
  double wanted_electrons = 0.0, clipped_electrons = 0.0;
};

template <report::columns::RowOf<StimulatorRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  using report::ColumnName;
  visit(ColumnName{"time_s", "s, since the epoch of the mission: middle of the exposure"}, row.time_s);
  visit(ColumnName{"image", "number of the exposure"}, row.image);
  visit(ColumnName{"frame", "number of the picture in the frame strip"}, row.frame);
  visit(ColumnName{"tries", "images taken for it"}, row.tries);
  visit(ColumnName{"stale", "images of another picture or of an earlier trigger, refused"}, row.stale);
  visit(ColumnName{"packets_resent", "by the camera"}, row.packets_resent);
  visit(ColumnName{"reconnects", "to the camera"}, row.reconnects);
  visit(ColumnName{"render_s", "wall-clock time from the scene to the counts of the display"}, row.render_s);
  visit(ColumnName{"show_s", "wall-clock time until the picture is on the screen, with its settling"}, row.show_s);
  visit(ColumnName{"receive_s", "wall-clock time from the trigger until the image is complete"}, row.receive_s);
  visit(ColumnName{"strip_brightness", "relative to the calibration"}, row.strip_brightness);
  visit(ColumnName{"rail_lens_mm", "position, if the rails were asked"}, row.rail_lens_mm);
  visit(ColumnName{"rail_display_mm", "position, if the rails were asked"}, row.rail_display_mm);
  visit(ColumnName{"points", "drawn with matched counts"}, row.points);
  visit(ColumnName{"wanted_electrons", "sum over the image"}, row.wanted_electrons);
  visit(ColumnName{"clipped_electrons", "of these, beyond the brightness of the display"}, row.clipped_electrons);
}

/// Holds the figures at the end of a run, beside the rows.
struct RunFigures {
  std::filesystem::path calibration_file;
  const StimulatorCalibration* calibration = nullptr;
  std::optional<SelfCheckFigures> self_check;
  CameraIdentity devices;
  std::vector<report::FileDigest> bench_files;  ///< program and files of an emulator
  std::map<std::string, int> faults;            ///< faults that the emulator has set and that have taken effect
};

/// Adds the figures to record.summary.testbeds["optical_stimulator"] and, for the files, to its provenance.
void add_figures(const RunFigures& figures, report::RunRecord& record);

// Functions of the report's extension.
[[nodiscard]] std::vector<report::TableKind> tables();
void summarise(const report::RunRecord& record, report::Summary& summary);
[[nodiscard]] std::vector<report::Section> sections(const report::RunRecord& record);

}  // namespace vbar::optical_stimulator
