#pragma once
// A spacecraft's ephemeris as a CSV file, one row a sampling time.

#include <filesystem>

#include "host_sim/report/partial_file.h"
#include "host_sim/report/propagation_record.h"

namespace vbar::report {

/// Columns: time_s (since the epoch), utc, position_eci_{x,y,z}_m, velocity_eci_{x,y,z}_mps (GCRF), latitude_deg,
/// longitude_deg, altitude_m (WGS 84). Numbers read back as the same bits.
class EphemerisCsv {
 public:
  /// Throws std::runtime_error that names the file, as the others do.
  explicit EphemerisCsv(const std::filesystem::path& file);
  void append(const EphemerisRow& row);
  void finish() { file_.finish(); }

 private:
  files::PartialFile file_;
};

}  // namespace vbar::report
