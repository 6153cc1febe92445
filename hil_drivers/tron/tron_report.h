#pragma once
// Contribution of the testbed to record, summary and report: tron.csv, the object "tron" of summary.json, a section.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "hil_drivers/tron/imaging/image_exchange.h"
#include "host_sim/report/extension.h"
#include "host_sim/report/provenance.h"

namespace vbar::tron {

/// Holds the figures at the end of a run, beside the rows.
struct RunFigures {
  bool is_emulated = false;
  std::string clock;                         ///< clock of the testbed: "virtual", "real"
  std::string camera;                        ///< vendor, model, serial number
  std::vector<std::filesystem::path> files;  ///< bench file and calibration
  /// Counters of the devices, by name: late answers, stops, restarts, frames lost, ...
  std::map<std::string, double> devices;
  std::map<std::string, double> calibration;    ///< its figures
  std::vector<report::FileDigest> bench_files;  ///< program and files of an emulator
  std::map<std::string, int> faults;            ///< faults that the emulator has set and that have taken effect
};

/// Adds the figures to record.summary.testbeds["tron"] and, for the files, to its provenance.
void add_figures(const RunFigures& figures, report::RunRecord& record);

// Functions of the report's extension.
[[nodiscard]] std::vector<report::TableKind> tables();
void summarise(const report::RunRecord& record, report::Summary& summary);
[[nodiscard]] std::vector<report::Section> sections(const report::RunRecord& record);

}  // namespace vbar::tron
