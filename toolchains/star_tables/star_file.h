#pragma once
// The star file data/stars/hipparcos_v8.csv as the maker of the flight tables reads it.

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

/// Rows of the file, moved by their proper motion from J2000.0 to the Julian year `epoch`, in the file's order. Throws
/// std::runtime_error "file:line: what was found, what is accepted" for a file that is damaged or cut short: it says
/// itself, in a line "# rows N", how many rows it must have.
std::vector<Star> read_star_file(const std::string& path, double epoch);

}  // namespace vbar::star_tables
