#include "star_file.h"

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>
#include <stdexcept>
#include <string_view>

namespace vbar::star_tables {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMilliarcsecond = kDegree / 3.6e6;
constexpr std::string_view kHeading = "hip,ra_deg,dec_deg,pm_ra_mas,pm_dec_mas,v,b_v";
constexpr std::size_t kColumns = 7;

struct Column {
  std::string_view name;
  double lowest;
  double highest;
};
constexpr std::array<Column, kColumns> kAccepted{{{"hip", 0, 130000},
                                                  {"ra_deg", 0, 360},
                                                  {"dec_deg", -90, 90},
                                                  {"pm_ra_mas", -20000, 20000},
                                                  {"pm_dec_mas", -20000, 20000},
                                                  {"v", -2, 8},
                                                  {"b_v", -1, 10}}};

/// Position in the file, for messages.
struct Place {
  const std::string& path;
  std::size_t line;
  [[noreturn]] void refuse(const std::string& what) const {
    throw std::runtime_error(path + ":" + std::to_string(line) + ": " + what);
  }
};

double number(std::string_view text, const Column& column, const Place& place) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() ||
      !(value >= column.lowest && value <= column.highest)) {
    place.refuse(std::string(column.name) + " is '" + std::string(text) + "', a number from " +
                 std::to_string(column.lowest) + " to " + std::to_string(column.highest) + " is accepted");
  }
  return value;
}

std::array<double, kColumns> fields(std::string_view line, const Place& place) {
  std::array<double, kColumns> values{};
  std::size_t begin = 0;
  for (std::size_t k = 0; k < kColumns; ++k) {
    const std::size_t comma = line.find(',', begin);
    const bool last = k + 1 == kColumns;
    if (last != (comma == std::string_view::npos)) {
      place.refuse("a star is " + std::to_string(kColumns) + " numbers with commas between them (" +
                   std::string(kHeading) + "), found '" + std::string(line) + "'");
    }
    values[k] = number(line.substr(begin, last ? comma : comma - begin), kAccepted[k], place);
    begin = comma + 1;
  }
  return values;
}

/// Straight motion on the tangent plane; over some decades the path curvature and the perspective effect stay below
/// 0.1 arcsec for the fastest star.
Star star_at(const std::array<double, kColumns>& row, double years) {
  const double ra = row[1] * kDegree;
  const double dec = row[2] * kDegree;
  const double east = row[3] * kMilliarcsecond * years;
  const double north = row[4] * kMilliarcsecond * years;
  const double x = std::cos(dec) * std::cos(ra) - east * std::sin(ra) - north * std::sin(dec) * std::cos(ra);
  const double y = std::cos(dec) * std::sin(ra) + east * std::cos(ra) - north * std::sin(dec) * std::sin(ra);
  const double z = std::sin(dec) + north * std::cos(dec);
  const double length = std::sqrt(x * x + y * y + z * z);
  return {{x / length, y / length, z / length}, row[5], static_cast<int>(row[0])};
}

}  // namespace

std::vector<Star> read_star_file(const std::string& path, double epoch) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  std::vector<Star> stars;
  Place place{path, 0};
  std::size_t promised = 0;
  bool heading_seen = false;
  std::string line;
  while (std::getline(file, line)) {
    ++place.line;
    if (file.eof()) place.refuse("the last line has no end: the file is cut short");
    if (line.starts_with("# rows ")) std::from_chars(line.data() + 7, line.data() + line.size(), promised);
    if (line.starts_with('#')) continue;
    if (!heading_seen) {
      if (line != kHeading) {
        place.refuse("found '" + line + "' where the columns should be named: " + std::string(kHeading));
      }
      heading_seen = true;
      continue;
    }
    stars.push_back(star_at(fields(line, place), epoch - 2000.0));
  }
  if (promised == 0) place.refuse("no line '# rows N' says how many stars there are");
  if (stars.size() != promised) {
    place.refuse("the file ends after " + std::to_string(stars.size()) + " stars, its line '# rows' promises " +
                 std::to_string(promised));
  }
  return stars;
}

}  // namespace vbar::star_tables
