#pragma once
// A spacecraft's ephemeris as a CCSDS Orbit Ephemeris Message in keyword = value notation (CCSDS 502.0-B-2, section 5),
// which flight dynamics programs read.

#include <filesystem>
#include <string>

#include "fsw/core/gps_time.h"
#include "host_sim/report/partial_file.h"
#include "host_sim/report/propagation_record.h"

namespace vbar::report {

/// One message with one segment: centre Earth, frame GCRF, time system UTC, km and km/s to a micrometre and a
/// micrometre a second. Interpolation is advised by Hermite polynomials of degree 7, or less if there are fewer states.
class OemFile {
 public:
  struct Span {
    fsw::GpsTime start;      ///< time of the first row
    fsw::GpsTime stop;       ///< time of the last row
    std::size_t states = 2;  ///< how many rows there will be
    fsw::GpsTime created;    ///< when the file is made
  };

  /// `object`: name of the spacecraft, which is its identifier as well: simulated ones have no international
  /// designator. Throws std::runtime_error that names the file, as the others do.
  OemFile(const std::filesystem::path& file, const std::string& object, const Span& span);

  /// Rows in order of time.
  void append(const EphemerisRow& row);
  void finish() { file_.finish(); }

 private:
  files::PartialFile file_;
};

}  // namespace vbar::report
