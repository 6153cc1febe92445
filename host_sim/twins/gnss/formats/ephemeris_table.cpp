#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "host_sim/files/text_lines.h"
#include "host_sim/twins/gnss/formats/ephemeris_formats.h"

namespace vbar::twins::gnss {
namespace {

constexpr std::string_view kColumns =
    "satellite,week,toe_s,toc_s,sqrt_a,e,m0,delta_n,omega0,omega_dot,i0,i_dot,omega,cuc,cus,cic,cis,crc,crs,af0,af1,"
    "af2,group_delay_s";
constexpr std::size_t kNumbers = 22;  // numbers of a satellite's row, after its name

struct Row {
  std::string_view name;
  std::array<double, kNumbers> numbers{};
  std::size_t count = 0;
};

class LineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

Row split(std::string_view line) {
  Row row;
  row.name = line.substr(0, line.find(','));
  std::string_view rest = line.substr(row.name.size());
  while (!rest.empty()) {
    rest.remove_prefix(1);
    const std::string_view text = rest.substr(0, rest.find(','));
    if (row.count == kNumbers) throw LineError("more than 22 numbers");
    double& number = row.numbers[row.count++];
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(number))
      throw LineError(fmt::format("{} is not a number", files::quoted(text)));
    rest.remove_prefix(text.size());
  }
  return row;
}

SatelliteId satellite_of(std::string_view name) {
  constexpr std::string_view kLetters = "GEC";
  SatelliteId satellite;
  const std::size_t system = name.empty() ? std::string_view::npos : kLetters.find(name.front());
  const char* const end = name.data() + name.size();
  if (system == std::string_view::npos || std::from_chars(name.data() + 1, end, satellite.prn).ptr != end ||
      satellite.prn < 1 || satellite.prn > 63)
    throw LineError(
        fmt::format("{} is not a satellite; accepted are G, E or C and a number from 01 to 63", files::quoted(name)));
  satellite.system = static_cast<System>(system);
  return satellite;
}

Ephemeris set_of(const Row& row) {
  if (row.count != kNumbers) throw LineError(fmt::format("{} numbers instead of {}", row.count, kNumbers));
  const auto& v = row.numbers;
  BroadcastRecord record{.satellite = satellite_of(row.name), .week = v[0], .toe_s = v[1], .toc_s = v[2]};
  Ephemeris& set = record.elements;
  set.sqrt_a = v[3];
  set.e = v[4];
  set.m0 = v[5];
  set.delta_n = v[6];
  record.omega0 = v[7];
  set.omega_dot = v[8];
  set.i0 = v[9];
  set.i_dot = v[10];
  set.omega = v[11];
  set.cuc = v[12];
  set.cus = v[13];
  set.cic = v[14];
  set.cis = v[15];
  set.crc = v[16];
  set.crs = v[17];
  record.af0 = v[18];
  record.af1 = v[19];
  record.af2 = v[20];
  set.group_delay_s = v[21];
  if (const std::string problem = problem_of(record); !problem.empty()) throw LineError(problem);
  return ephemeris_of(record);
}

// True if the row is one of the corrections.
bool take_correction(const Row& row, BroadcastCorrections& corrections) {
  const auto need = [&row](std::size_t count) {
    if (row.count != count) throw LineError(fmt::format("{} needs {} numbers", row.name, count));
  };
  if (row.name == "klobuchar_alpha" || row.name == "klobuchar_beta") {
    need(4);
    auto& to = row.name == "klobuchar_alpha" ? corrections.klobuchar.alpha : corrections.klobuchar.beta;
    std::copy_n(row.numbers.begin(), 4, to.begin());
    return true;
  }
  if (row.name == "utc_a0_a1") {
    need(2);
    corrections.utc_a0_s = row.numbers[0];
    corrections.utc_a1 = row.numbers[1];
    return true;
  }
  return false;
}

}  // namespace

bool is_ephemeris_table(std::string_view text) {
  files::TextLines lines(text, "");
  while (lines.next()) {
    if (lines.is_blank() || lines.line().starts_with('#')) continue;
    return lines.line().find(',') != std::string_view::npos;
  }
  return true;  // a file without any line holds no satellite, as its reader says
}

EphemerisFile read_ephemeris_table(std::string_view text, const std::string& file, const SystemSet& /*used*/) {
  EphemerisFile result;
  bool columns_seen = false;
  files::TextLines lines(text, file);
  while (lines.next()) {
    const std::string_view line = lines.line();
    if (line.empty() || line.front() == '#') continue;
    lines.check_ended();
    try {
      if (line == kColumns) {
        columns_seen = true;
      } else if (columns_seen) {
        result.satellites.push_back(set_of(split(line)));
      } else if (!take_correction(split(line), result.corrections)) {
        throw LineError(fmt::format("expected klobuchar_alpha, klobuchar_beta, utc_a0_a1 or the columns {}", kColumns));
      }
    } catch (const LineError& error) {
      throw std::runtime_error(fmt::format("{}:{}: {}", file, lines.number(), error.what()));
    }
  }
  if (result.satellites.empty()) throw std::runtime_error(fmt::format("{}: holds no satellite", file));
  return result;
}

}  // namespace vbar::twins::gnss
