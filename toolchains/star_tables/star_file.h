#pragma once
// The star file data/stars/hipparcos_v8.csv, read by the generator of the flight tables.

#include <string>
#include <vector>

namespace vbar::star_tables {

/// Unit vector, ICRS.
struct Direction {
  double x = 0.0, y = 0.0, z = 0.0;
};

struct Star {
  Direction direction;
  double magnitude = 0.0;  ///< V
  int hipparcos = 0;       ///< 0: has none
};

/// Rows of the file, propagated by their proper motion from J2000.0 to the Julian year `epoch`, in the file's order.
/// Throws std::runtime_error "file:line: found, accepted" for a file that is damaged or truncated: a line "# rows N"
/// states the number of its rows.
std::vector<Star> read_star_file(const std::string& path, double epoch);

}  // namespace vbar::star_tables
