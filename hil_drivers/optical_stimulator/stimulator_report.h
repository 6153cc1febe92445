#pragma once
// Contribution of the testbed to record, summary and report: bench.csv, the object "optical_stimulator" of
// summary.json, a section.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hil_drivers/optical_stimulator/bench_row.h"
#include "hil_drivers/optical_stimulator/calibration_file/bench_calibration.h"
#include "hil_drivers/optical_stimulator/hardware/bench_devices.h"
#include "hil_drivers/optical_stimulator/self_check/self_check.h"
#include "host_sim/report/extension.h"
#include "host_sim/report/provenance.h"

namespace vbar::optical_stimulator {

/// Holds the figures at the end of a run, beside the rows.
struct RunFigures {
  std::filesystem::path calibration_file;
  const BenchCalibration* calibration = nullptr;
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
