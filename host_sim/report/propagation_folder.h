#pragma once
// The folder that a propagation leaves: propagation.json, and for each spacecraft its ephemeris. As a run's folder it
// says that it is incomplete from the moment it exists until all is known to be whole.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "host_sim/report/ephemeris_csv.h"
#include "host_sim/report/oem_file.h"
#include "host_sim/report/propagation_record.h"

namespace vbar::report {

class PropagationFolder {
 public:
  /// Makes the folder. What an earlier propagation left there, by its own list, is removed. Throws std::runtime_error
  /// that names the folder if it holds anything but a propagation, or cannot be made or written.
  PropagationFolder(std::filesystem::path folder, const std::string& mission);

  /// Starts `<name>.csv` of each spacecraft, and `<name>.oem` if `oem` is given.
  void start_files(std::span<const std::string> names, const OemFile::Span* oem);

  /// Appends a row to the ephemeris of a spacecraft, given by its place among the names.
  void append(std::size_t spacecraft, const EphemerisRow& row);

  /// Gives the files their names if the propagation is complete, then writes propagation.json.
  void finish(const PropagationRecord& record);

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

 private:
  std::filesystem::path folder_;
  std::vector<std::string> file_names_;
  std::vector<EphemerisCsv> csv_;
  std::vector<OemFile> oem_;
};

/// Returns the default folder of a propagation: runs/<mission>-truth.
[[nodiscard]] std::filesystem::path default_propagation_folder(const std::string& mission);

}  // namespace vbar::report
