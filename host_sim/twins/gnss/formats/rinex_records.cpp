#include "host_sim/twins/gnss/formats/rinex_records.h"

#include <array>
#include <cmath>

#include <erfa.h>
#include <fmt/format.h>

#include "host_sim/twins/gnss/formats/rinex_header.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::twins::gnss {
namespace {

using files::TextLines;

constexpr std::size_t kLinesOfOrbit = 7;  // of GPS, Galileo and BeiDou
constexpr std::size_t kWidth = 19;

/// Values of the lines of the orbit, four a line; what is left blank is 0.
using Values = std::array<double, 4 * kLinesOfOrbit>;

constexpr std::size_t at(std::size_t line, std::size_t place) {
  return 4 * (line - 1) + place - 1;
}

/// Where things stand in a version.
struct Layout {
  std::size_t clock;  ///< column of the first number of the first line
  std::size_t orbit;  ///< and of the following ones
};
constexpr Layout layout_of(int version) {
  return version == 2 ? Layout{23, 4} : Layout{24, 5};
}

int whole(const TextLines& lines, std::size_t first, std::size_t last, std::string_view what) {
  const auto value = files::integer_of(lines.columns(first, last));
  if (!value) lines.refuse(fmt::format("{} in columns {} to {}", what, first, last));
  return *value;
}

/// Seconds of the calendar time of the record in its own time scale since 1980-01-06.
double epoch_s(const TextLines& lines, int version) {
  int year = 0;
  double second = 0.0;
  std::array<int, 4> rest{};  // month, day, hour, minute
  if (version == 2) {
    year = whole(lines, 4, 5, "the year");
    year += year < 80 ? 2000 : 1900;
    for (std::size_t k = 0; k < rest.size(); ++k) rest[k] = whole(lines, 7 + 3 * k, 8 + 3 * k, "a part of the date");
    second = rinex_number(lines, 18, 22, "the seconds");
  } else {
    year = whole(lines, 5, 8, "the year");
    for (std::size_t k = 0; k < rest.size(); ++k) rest[k] = whole(lines, 10 + 3 * k, 11 + 3 * k, "a part of the date");
    second = rinex_number(lines, 22, 23, "the seconds");
  }
  double zero = 0.0, mjd = 0.0;
  const auto [month, day, hour, minute] = rest;
  if (year < 1980 || year > 2171 || eraCal2jd(year, month, day, &zero, &mjd) != 0 || hour < 0 || hour > 23 ||
      minute < 0 || minute > 59 || !(second >= 0.0 && second < 60.0))
    lines.refuse("a date and a time of day of the clock");
  constexpr double kMjdOfGpsEpoch = 44244.0;
  return 86400.0 * (mjd - kMjdOfGpsEpoch) + 3600.0 * hour + 60.0 * minute + second;
}

std::optional<SatelliteId> satellite_of(const TextLines& lines, int version) {
  SatelliteId satellite;
  if (version == 2) {
    satellite.prn = whole(lines, 1, 2, "the number of a satellite");
  } else {
    constexpr std::string_view kFlying = "GEC", kOthers = "RSJI";
    const std::string_view letter = lines.columns(1, 1);
    const std::size_t system = kFlying.find(letter);
    if (letter.empty() || (system == std::string_view::npos && kOthers.find(letter) == std::string_view::npos))
      lines.refuse("a satellite of one of the systems G, R, E, C, J, I, S");
    if (system == std::string_view::npos) return std::nullopt;
    satellite.system = static_cast<System>(system);
    satellite.prn = whole(lines, 2, 3, "the number of a satellite");
  }
  if (satellite.prn < 1 || satellite.prn > 63) lines.refuse("a satellite from 01 to 63");
  return satellite;
}

void read_line(const TextLines& lines, std::size_t first, std::size_t count, double* to) {
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t begin = first + kWidth * k, end = begin + kWidth - 1;
    to[k] = files::trimmed(lines.columns(begin, end)).empty() ? 0.0 : rinex_number(lines, begin, end, "a number");
  }
}

void take_orbit(const Values& v, BroadcastRecord& record) {
  Ephemeris& set = record.elements;
  set.crs = v[at(1, 2)];
  set.delta_n = v[at(1, 3)];
  set.m0 = v[at(1, 4)];
  set.cuc = v[at(2, 1)];
  set.e = v[at(2, 2)];
  set.cus = v[at(2, 3)];
  set.sqrt_a = v[at(2, 4)];
  record.toe_s = v[at(3, 1)];
  set.cic = v[at(3, 2)];
  record.omega0 = v[at(3, 3)];
  set.cis = v[at(3, 4)];
  set.i0 = v[at(4, 1)];
  set.crc = v[at(4, 2)];
  set.omega = v[at(4, 3)];
  set.omega_dot = v[at(4, 4)];
  set.i_dot = v[at(5, 1)];
  record.week = v[at(5, 3)];
  // GPS TGD, BeiDou TGD1; Galileo BGD(E1,E5a) and BGD(E1,E5b).
  set.group_delay_s = record.satellite.system == System::kGalileo ? v[at(6, 4)] : v[at(6, 3)];
}

/// Galileo's I/NAV of E1-B or E5b-I, whose clock goes with BGD(E1,E5b); F/NAV is the other message.
bool is_wanted(const BroadcastRecord& record, const Values& v) {
  constexpr unsigned kInav = 0b101;
  const double sources = v[at(5, 2)];
  if (record.satellite.system != System::kGalileo || !(sources >= 0.0 && sources < 1024.0)) return true;
  return (static_cast<unsigned>(sources) & kInav) != 0;
}

/// Message of a record of version 4 that has the layout of version 3.
bool has_known_message(std::string_view message) {
  return message == "LNAV" || message == "INAV" || message == "D1" || message == "D2" || message == "D1D2";
}

}  // namespace

bool RinexRecords::begins_record() const {
  if (version_ == 2) return !files::trimmed(lines_.columns(1, 2)).empty();
  return !lines_.line().empty() && lines_.line().front() != ' ';
}

void RinexRecords::skip_record() {
  do {
    advance();
  } while (has_line_ && !begins_record());
}

void RinexRecords::need_line(std::string_view of_what) {
  advance();
  if (!has_line_) lines_.refuse("the end of the file", fmt::format("the next line of {}", of_what));
}

std::optional<BroadcastRecord> RinexRecords::next(BroadcastCorrections& corrections) {
  while (has_line_) {
    if (lines_.is_blank()) {
      advance();
    } else if (version_ == 4) {
      if (!lines_.line().starts_with('>')) lines_.refuse("a record that begins with >");
      const auto words = lines_.words();
      if (words.size() >= 4 && words[1] == "EPH" && has_known_message(words[3])) {
        need_line("the record");
        if (auto record = read_set()) return record;
      } else {
        read_frame(corrections);
      }
    } else if (auto record = read_set()) {
      return record;
    }
  }
  return std::nullopt;
}

std::optional<BroadcastRecord> RinexRecords::read_set() {
  if (!begins_record()) lines_.refuse("the first line of a satellite's record");
  const auto satellite = satellite_of(lines_, version_);
  if (!satellite) {
    skip_record();
    return std::nullopt;
  }
  const Layout layout = layout_of(version_);
  BroadcastRecord record;
  record.satellite = *satellite;
  const double toc_s = epoch_s(lines_, version_);
  std::array<double, 3> clock{};
  read_line(lines_, layout.clock, clock.size(), clock.data());
  record.af0 = clock[0];
  record.af1 = clock[1];
  record.af2 = clock[2];
  Values values{};
  for (std::size_t line = 1; line <= kLinesOfOrbit; ++line) {
    need_line(fmt::format("the record of {}", name_of(*satellite)));
    if (begins_record()) lines_.refuse(fmt::format("line {} of the record of {}", line + 1, name_of(*satellite)));
    read_line(lines_, layout.orbit, 4, values.data() + at(line, 1));
  }
  take_orbit(values, record);
  // BeiDou's weeks begin in 2006; the date is in its own time.
  const double week_zero_s = satellite->system == System::kBeidou ? 1356.0 * kSecondsPerWeek : 0.0;
  record.toc_s = toc_s - week_zero_s - record.week * static_cast<double>(kSecondsPerWeek);
  // Files merged from many receivers hold some sets of zeros and some with the week of another one; they are of no use.
  const bool is_set = record.elements.sqrt_a != 0.0 && std::abs(record.toc_s - record.toe_s) <= kLongestClockAge_s;
  const std::string problem = problem_of(record);
  if (is_set && !problem.empty())
    lines_.refuse(fmt::format("a record of {} that cannot be right", name_of(*satellite)), problem);
  advance();
  if (!is_set || !is_wanted(record, values)) return std::nullopt;
  return record;
}

void RinexRecords::read_frame(BroadcastCorrections& corrections) {
  const auto words = lines_.words();
  const bool is_gps = words.size() >= 4 && words[2].starts_with('G') && words[3] == "LNAV";
  if (is_gps && words[1] == "ION") return read_ionosphere(corrections);
  if (is_gps && words[1] == "STO") return read_utc(corrections);
  skip_record();
}

void RinexRecords::read_ionosphere(BroadcastCorrections& corrections) {
  std::array<double, 9> values{};
  need_line("the ionosphere's record");
  read_line(lines_, 24, 3, values.data());
  need_line("the ionosphere's record");
  read_line(lines_, 5, 4, values.data() + 3);
  need_line("the ionosphere's record");
  read_line(lines_, 5, 1, values.data() + 7);
  std::copy_n(values.begin(), 4, corrections.klobuchar.alpha.begin());
  std::copy_n(values.begin() + 4, 4, corrections.klobuchar.beta.begin());
  skip_record();
}

void RinexRecords::read_utc(BroadcastCorrections& corrections) {
  need_line("the time offset's record");
  const bool is_utc = files::trimmed(lines_.columns(25, 42)).starts_with("GPUT");
  need_line("the time offset's record");
  std::array<double, 4> values{};
  read_line(lines_, 5, 4, values.data());
  if (is_utc) {
    corrections.utc_a0_s = values[1];
    corrections.utc_a1 = values[2];
  }
  skip_record();
}

}  // namespace vbar::twins::gnss
