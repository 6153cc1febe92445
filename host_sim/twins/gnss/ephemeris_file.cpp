#include "host_sim/twins/gnss/ephemeris_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/twins/gnss/system_time.h"

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

std::span<const EphemerisFormat> ephemeris_formats() {
  static constexpr std::array kFormats{
      EphemerisFormat{"RINEX navigation file (2, 3 or 4)", is_rinex, read_rinex},
      EphemerisFormat{"the table of data/gps", is_ephemeris_table, read_ephemeris_table},
  };
  return kFormats;
}

EphemerisFile read_ephemerides(std::string_view text, const std::string& file, const SystemSet& used) {
  const auto formats = ephemeris_formats();
  const auto format = std::ranges::find_if(formats, [&](const auto& one) { return one.recognises(text); });
  if (format != formats.end()) return format->read(text, file, used);
  files::TextLines lines(text, file);
  lines.next();
  std::vector<std::string_view> names;
  for (const EphemerisFormat& one : formats) names.push_back(one.name);
  lines.refuse(fmt::format("broadcast ephemerides in one of the formats {}", fmt::join(names, ", ")));
}

EphemerisFile read_ephemeris_file(const std::filesystem::path& file, const SystemSet& used) {
  const files::DataStream stream(file);
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot be read", file.string()));
  return read_ephemerides(stream.view(), file.string(), used);
}

std::string problem_of(const BroadcastRecord& record) {
  constexpr double kLastWeek = 9999.0;  // the year 2171
  const Ephemeris& set = record.elements;
  if (!(record.week >= 0.0 && record.week <= kLastWeek && record.week == std::floor(record.week)))
    return fmt::format("week {} is not an integer from 0 to {}", record.week, kLastWeek);
  if (!(record.toe_s >= 0.0 && record.toe_s < static_cast<double>(kSecondsPerWeek)))
    return fmt::format("toe of {} s does not lie in a week", record.toe_s);
  if (!(std::abs(record.toc_s - record.toe_s) <= kLongestClockAge_s))
    return fmt::format("week and toe are {:.0f} s from the reference time of the clock; they must lie within a day",
                       std::abs(record.toc_s - record.toe_s));
  if (!(set.sqrt_a > 2000.0 && set.sqrt_a < 9000.0))
    return fmt::format("sqrt_a of {} m^(1/2) does not lie between 2000 and 9000", set.sqrt_a);
  if (!(set.e >= 0.0 && set.e < kMaxEccentricity))
    return fmt::format("an eccentricity of {} does not lie between 0 and {}", set.e, kMaxEccentricity);
  return {};
}

Ephemeris ephemeris_of(const BroadcastRecord& record) {
  Ephemeris set = record.elements;
  const System system = record.satellite.system;
  set.satellite = record.satellite;
  set.toe = gps_time_of(system, static_cast<int>(record.week), static_cast<std::int64_t>(record.toe_s));
  set.node_at_toe = record.omega0 - earth_rate(system) * record.toe_s;
  const double elapsed_s = record.toe_s - record.toc_s;
  set.af0 = record.af0 + (record.af1 + record.af2 * elapsed_s) * elapsed_s;
  set.af1 = record.af1 + 2.0 * record.af2 * elapsed_s;
  set.af2 = record.af2;
  return set;
}

}  // namespace vbar::twins::gnss
