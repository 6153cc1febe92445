#include "host_sim/twins/gnss/rinex.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <erfa.h>
#include <fmt/format.h>

#include "host_sim/files/text_lines.h"
#include "host_sim/twins/gnss/ephemeris_file.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::twins::gnss {

LeftOut::Entry& LeftOut::entry(std::string_view kind) {
  constexpr std::size_t kMaxKinds = 40;  // systems and messages that exist; a damaged file may name any number
  const auto found = std::ranges::find(entries_, kind, &Entry::kind);
  if (found != entries_.end()) return *found;
  if (entries_.size() == kMaxKinds) return entries_.back();
  entries_.push_back({std::string(kind), {}, 0});
  return entries_.back();
}

void LeftOut::add_defective(std::string_view kind, const std::string& first) {
  Entry& one = entry(kind);
  one.count += 1;
  if (one.first.empty()) one.first = first;
}

std::string LeftOut::text() const {
  std::string text;
  for (const Entry& one : entries_) {
    if (!text.empty()) text += ", ";
    text += fmt::format("{} ({}", one.kind, one.count);
    if (!one.first.empty()) text += fmt::format("; {}{}", one.count > 1 ? "the first: " : "", one.first);
    text += ")";
  }
  return text;
}

namespace {

using files::TextLines;

std::string_view label_of(const TextLines& lines) {
  return files::trimmed(lines.columns(61, 80));
}

int version_of(const TextLines& lines) {
  if (label_of(lines) != "RINEX VERSION / TYPE") lines.refuse("RINEX VERSION / TYPE in columns 61 to 80");
  const double version = lines.number_in(1, 9, "the version of RINEX");
  if (!(version >= 2.0 && version < 5.0)) lines.refuse(fmt::format("RINEX version {}", version), "2, 3 or 4");
  return static_cast<int>(version);
}

void check_type(const TextLines& lines, int version) {
  const std::string_view type = lines.columns(21, 21), system = lines.columns(41, 41);
  constexpr std::string_view kAccepted = "navigation data (N) of GPS, Galileo, BeiDou or mixed systems";
  // Version 2 has a type for each system: N is GPS, G is GLONASS, H are geostationary ones.
  if (type != "N") lines.refuse(fmt::format("a file of type {}", files::quoted(lines.columns(21, 40))), kAccepted);
  // A simulator of signals writes version 3.00 without a system; the records name theirs.
  constexpr std::string_view kSystems = "GECM";
  if (version > 2 && !files::trimmed(system).empty() && kSystems.find(system) == std::string_view::npos)
    lines.refuse(fmt::format("the satellite system {}", files::quoted(files::trimmed(lines.columns(41, 60)))),
                 kAccepted);
}

/// Four coefficients from column `first` on.
void read_four(const TextLines& lines, std::size_t first, std::array<double, 4>& to) {
  constexpr std::size_t kWidth = 12;
  for (std::size_t k = 0; k < to.size(); ++k)
    to[k] = lines.number_in(first + kWidth * k, first + kWidth * k + kWidth - 1, "a coefficient of the ionosphere");
}

void take(const TextLines& lines, BroadcastCorrections& corrections) {
  const std::string_view label = label_of(lines), kind = lines.columns(1, 4);
  if (label == "ION ALPHA") read_four(lines, 3, corrections.klobuchar.alpha);
  if (label == "ION BETA") read_four(lines, 3, corrections.klobuchar.beta);
  if (label == "IONOSPHERIC CORR" && kind == "GPSA") read_four(lines, 6, corrections.klobuchar.alpha);
  if (label == "IONOSPHERIC CORR" && kind == "GPSB") read_four(lines, 6, corrections.klobuchar.beta);
  if (label == "DELTA-UTC: A0,A1,T,W") {
    corrections.utc_a0_s = lines.number_in(4, 22, "A0 of UTC");
    corrections.utc_a1 = lines.number_in(23, 41, "A1 of UTC");
  }
  if (label == "TIME SYSTEM CORR" && kind == "GPUT") {
    corrections.utc_a0_s = lines.number_in(6, 22, "A0 of UTC");
    corrections.utc_a1 = lines.number_in(23, 38, "A1 of UTC");
  }
}

}  // namespace

RinexHeader read_rinex_header(TextLines& lines) {
  RinexHeader header;
  if (!lines.next()) lines.refuse("an empty file", "a RINEX navigation file");
  header.version = version_of(lines);
  check_type(lines, header.version);
  while (lines.next()) {
    if (label_of(lines) == "END OF HEADER") return header;
    take(lines, header.corrections);
  }
  lines.refuse("the end of the file", "END OF HEADER");
}

namespace {

constexpr std::size_t kLinesOfOrbit = 7;  // lines of GPS, Galileo and BeiDou
constexpr std::size_t kWidth = 19;
constexpr std::string_view kSystemLetters = "GEC";  // in the order of System

/// Values of the lines of the orbit, four a line; what is left blank or not needed is 0.
using Values = std::array<double, 4 * kLinesOfOrbit>;

constexpr std::size_t at(std::size_t line, std::size_t place) {
  return 4 * (line - 1) + place - 1;
}

/// Whether a value of the orbit is used: spare fields and those of accuracy, health and transmission hold anything.
constexpr bool is_needed(System system, std::size_t line, std::size_t place) {
  const bool is_galileo = system == System::kGalileo;
  switch (line) {
    case 1:
      return place >= 2;
    case 5:  // Galileo: also the sources of the data
      return place == 1 || place == 3 || (place == 2 && is_galileo);
    case 6:  // GPS TGD, BeiDou TGD1; Galileo BGD(E1,E5a) and BGD(E1,E5b)
      return place == (is_galileo ? 4 : 3);
    case 7:
      return false;
    default:
      return true;
  }
}

/// Columns of a version.
struct Layout {
  std::size_t clock;  ///< column of the first number of the first line
  std::size_t orbit;  ///< and of the following ones
};
constexpr Layout layout_of(int version) {
  return version == 2 ? Layout{23, 4} : Layout{24, 5};
}

/// Reads the fields of one set; the first that cannot be read makes the set a defective one.
class SetFields {
 public:
  explicit SetFields(const TextLines& lines) : lines_(lines) {}

  /// 0 for a blank field.
  double number(std::size_t first, std::size_t last) {
    if (files::trimmed(lines_.columns(first, last)).empty()) return 0.0;
    const auto value = files::number_of(lines_.columns(first, last));
    if (!value || lines_.is_cut_in(first, last)) complain(first, last, "a number");
    return value.value_or(0.0);
  }

  int whole(std::size_t first, std::size_t last) {
    const auto value = files::integer_of(lines_.columns(first, last));
    if (!value) complain(first, last, "an integer");
    return value.value_or(0);
  }

  void complain(std::size_t first, std::size_t last, std::string_view expected) {
    if (problem_.empty())
      problem_ = fmt::format("line {}: found {} in columns {} to {}, expected {}", lines_.number(),
                             files::quoted(lines_.columns(first, last)), first, last, expected);
  }

  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  const TextLines& lines_;
  std::string problem_;
};

/// Seconds of the calendar time of the record in its own time scale since 1980-01-06.
double epoch_s(SetFields& fields, int version) {
  const bool is_old = version == 2;
  int year = is_old ? fields.whole(4, 5) : fields.whole(5, 8);
  if (is_old) year += year < 80 ? 2000 : 1900;
  std::array<int, 4> rest{};  // month, day, hour, minute
  const std::size_t first = is_old ? 7 : 10;
  for (std::size_t k = 0; k < rest.size(); ++k) rest[k] = fields.whole(first + 3 * k, first + 1 + 3 * k);
  const double second = is_old ? fields.number(18, 22) : fields.number(22, 23);
  double zero = 0.0, mjd = 0.0;
  const auto [month, day, hour, minute] = rest;
  if (year < 1980 || year > 2171 || eraCal2jd(year, month, day, &zero, &mjd) != 0 || hour < 0 || hour > 23 ||
      minute < 0 || minute > 59 || !(second >= 0.0 && second < 60.0))
    fields.complain(is_old ? 4 : 5, is_old ? 22 : 23, "a date and a time of day of the clock");
  constexpr double kMjdOfGpsEpoch = 44244.0;
  return 86400.0 * (mjd - kMjdOfGpsEpoch) + 3600.0 * hour + 60.0 * minute + second;
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
  set.group_delay_s = record.satellite.system == System::kGalileo ? v[at(6, 4)] : v[at(6, 3)];
}

/// Galileo's I/NAV of E1-B or E5b-I, whose clock goes with BGD(E1,E5b); F/NAV is the other message.
bool is_inav(const Values& v) {
  constexpr unsigned kInav = 0b101;
  const double sources = v[at(5, 2)];
  return !(sources >= 0.0 && sources < 1024.0) || (static_cast<unsigned>(sources) & kInav) != 0;
}

/// Counts the week of a record as its date does. Navigation messages of GPS hold it modulo 1024, which some receivers
/// write down, and Galileo's own count begins 1024 weeks after that of GPS. True if that changed it.
bool resolve_week(BroadcastRecord& record, double toc_s) {
  constexpr double kRollover = 1024.0;
  if (record.satellite.system == System::kBeidou || !(record.week >= 0.0 && record.week < 1e4)) return false;
  const double week_of_date = (toc_s - record.toe_s) / static_cast<double>(kSecondsPerWeek);
  const double rollovers = std::round((week_of_date - record.week) / kRollover);
  record.week += kRollover * rollovers;
  return rollovers != 0.0;
}

std::string_view system_name(char letter) {
  constexpr std::array<std::pair<char, std::string_view>, 7> kNames{{{'G', "GPS"},
                                                                     {'R', "GLONASS"},
                                                                     {'E', "Galileo"},
                                                                     {'C', "BeiDou"},
                                                                     {'J', "QZSS"},
                                                                     {'I', "NavIC"},
                                                                     {'S', "SBAS"}}};
  for (const auto& [known, name] : kNames)
    if (known == letter) return name;
  return "unknown systems";
}

/// Message of a record of version 4 that has the layout of version 3.
bool has_known_message(std::string_view message) {
  return message == "LNAV" || message == "INAV" || message == "D1" || message == "D2" || message == "D1D2";
}

}  // namespace

bool RinexRecords::begins_record() const {
  if (version_ == 2) return !files::trimmed(lines_.columns(1, 2)).empty();
  if (version_ == 4) return lines_.line().starts_with('>');
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
    } else if (auto record = version_ == 4 ? read_frame(corrections) : read_record()) {
      return record;
    }
  }
  return std::nullopt;
}

/// A record of version 4 behind the line that names type, satellite and message.
std::optional<BroadcastRecord> RinexRecords::read_frame(BroadcastCorrections& corrections) {
  if (!begins_record()) lines_.refuse("a record that begins with >");
  const auto words = lines_.words();
  const std::string_view type = words.size() > 1 ? words[1] : "", satellite = words.size() > 2 ? words[2] : "",
                         message = words.size() > 3 ? words[3] : "";
  const bool is_gps = satellite.starts_with('G') && message == "LNAV";
  if (type == "EPH" && has_known_message(message)) {
    need_line("the record");
    return read_record();
  }
  if (is_gps && type == "ION") {
    read_ionosphere(corrections);
  } else if (is_gps && type == "STO") {
    read_utc(corrections);
  } else {
    const char letter = satellite.empty() ? ' ' : satellite.front();
    if (type == "EPH") left_out_.add(fmt::format("{} {}", system_name(letter), files::printable(message.substr(0, 8))));
    skip_record();
  }
  return std::nullopt;
}

/// From the line that begins with a satellite.
std::optional<BroadcastRecord> RinexRecords::read_record() {
  if (version_ == 2) {
    const int prn = lines_.integer_in(1, 2, "the number of a satellite");
    if (prn < 1 || prn > 63) lines_.refuse("a satellite from 01 to 63");
    return read_set({System::kGps, prn});
  }
  const char letter = lines_.is_blank() ? ' ' : lines_.line().front();
  const auto prn = files::integer_of(lines_.columns(2, 3));
  if (letter < 'A' || letter > 'Z' || !prn || *prn < 1)
    lines_.refuse("a satellite: the letter of a system and a number in columns 2 to 3");
  const std::size_t system = kSystemLetters.find(letter);
  if (system == std::string_view::npos || !used_[system]) {
    if (system == std::string_view::npos)
      left_out_.add(system_name(letter));
    else
      has_unused_systems_ = true;
    skip_record();
    return std::nullopt;
  }
  if (*prn > 63) lines_.refuse("a satellite from 01 to 63");
  return read_set({static_cast<System>(system), *prn});
}

std::optional<BroadcastRecord> RinexRecords::read_set(SatelliteId satellite) {
  const Layout layout = layout_of(version_);
  const std::string name = name_of(satellite);
  const int first_line = lines_.number();
  BroadcastRecord record;
  record.satellite = satellite;
  SetFields fields(lines_);
  const double toc_s = epoch_s(fields, version_);
  const auto clock = [&](std::size_t k) {
    return fields.number(layout.clock + kWidth * k, layout.clock + kWidth * (k + 1) - 1);
  };
  record.af0 = clock(0);
  record.af1 = clock(1);
  record.af2 = clock(2);
  Values values{};
  for (std::size_t line = 1; line <= kLinesOfOrbit; ++line) {
    need_line(fmt::format("the record of {}", name));
    const bool is_indented =
        version_ == 2 ? !begins_record() : lines_.columns(1, 4).find_first_not_of(' ') == std::string_view::npos;
    if (!is_indented) lines_.refuse(fmt::format("line {} of the record of {}", line + 1, name));
    for (std::size_t place = 1; place <= 4; ++place) {
      const std::size_t first = layout.orbit + kWidth * (place - 1);
      if (is_needed(satellite.system, line, place)) values[at(line, place)] = fields.number(first, first + kWidth - 1);
    }
  }
  if (version_ == 4)
    skip_record();  // with what later versions may add to it
  else
    advance();

  const auto leave_out = [&](std::string_view kind, const std::string& reason) {
    left_out_.add_defective(kind, reason.empty() ? fmt::format("{} in line {}", name, first_line)
                                                 : fmt::format("{} in line {}, {}", name, first_line, reason));
    return std::nullopt;
  };
  if (!fields.problem().empty()) return leave_out("sets with a field that cannot be read", fields.problem());
  take_orbit(values, record);
  if (satellite.system == System::kGalileo && !is_inav(values)) {
    left_out_.add("Galileo F/NAV");
    return std::nullopt;
  }
  // Files merged from many receivers hold some sets of zeros and some with the week of another one.
  if (record.elements.sqrt_a == 0.0) return leave_out("sets of zeros", "");
  const double published_week = record.week;
  // BeiDou's weeks begin in 2006; the date is in its own time.
  const double week_zero_s = satellite.system == System::kBeidou ? 1356.0 * kSecondsPerWeek : 0.0;
  const bool is_resolved = resolve_week(record, toc_s);
  record.toc_s = toc_s - week_zero_s - record.week * static_cast<double>(kSecondsPerWeek);
  if (!(std::abs(record.toc_s - record.toe_s) <= kLongestClockAge_s))
    return leave_out("sets whose week contradicts their date", fmt::format("week {}", published_week));
  if (const std::string problem = problem_of(record); !problem.empty())
    return leave_out("sets that cannot be right", problem);
  if (is_resolved) ++sets_with_resolved_week_;
  return record;
}

void RinexRecords::read_ionosphere(BroadcastCorrections& corrections) {
  const auto four = [this](std::size_t from, std::size_t count, std::array<double, 9>& to, std::size_t place) {
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t first = from + kWidth * k;
      to[place + k] = lines_.number_or_blank_in(first, first + kWidth - 1, "a number").value_or(0.0);
    }
  };
  std::array<double, 9> values{};
  need_line("the ionosphere's record");
  four(24, 3, values, 0);
  need_line("the ionosphere's record");
  four(5, 4, values, 3);
  need_line("the ionosphere's record");
  four(5, 1, values, 7);
  std::copy_n(values.begin(), 4, corrections.klobuchar.alpha.begin());
  std::copy_n(values.begin() + 4, 4, corrections.klobuchar.beta.begin());
  skip_record();
}

void RinexRecords::read_utc(BroadcastCorrections& corrections) {
  need_line("the time offset's record");
  const bool is_utc = files::trimmed(lines_.columns(25, 42)).starts_with("GPUT");
  need_line("the time offset's record");
  if (is_utc) {
    corrections.utc_a0_s = lines_.number_in(24, 42, "A0 of UTC");
    corrections.utc_a1 = lines_.number_in(43, 61, "A1 of UTC");
  }
  skip_record();
}

// RINEX 2.11 (Gurtner 2007), 3.05 (Romero 2020) and 4.00 (Romero 2021), IGS.

namespace {

constexpr std::int64_t kDay_ns = 86400 * fsw::kNanosecondsPerSecond;

fsw::GpsTime noon_of(std::vector<Ephemeris>& sets) {
  const auto median = sets.begin() + static_cast<std::ptrdiff_t>(sets.size() / 2);
  std::vector<std::int64_t> times;
  for (const Ephemeris& set : sets) times.push_back(set.toe.ns);
  std::ranges::sort(times);
  const std::int64_t middle = times[static_cast<std::size_t>(median - sets.begin())];
  return {middle / kDay_ns * kDay_ns + kDay_ns / 2};
}

/// Returns one set of each satellite: that whose reference time is nearest to `noon`, the earlier of two as near.
std::vector<Ephemeris> nearest_to(fsw::GpsTime noon, const std::vector<Ephemeris>& sets) {
  const auto distance = [&](const Ephemeris& set) { return std::abs((set.toe - noon).ns); };
  std::map<SatelliteId, Ephemeris> nearest;
  for (const Ephemeris& set : sets) {
    const auto [place, is_new] = nearest.try_emplace(set.satellite, set);
    if (!is_new && distance(set) < distance(place->second)) place->second = set;
  }
  std::vector<Ephemeris> result;
  for (const auto& [satellite, set] : nearest) result.push_back(set);
  return result;
}

}  // namespace

bool is_rinex(std::string_view text) {
  files::TextLines lines(text, "");
  return lines.next() && files::trimmed(lines.columns(61, 80)) == "RINEX VERSION / TYPE";
}

EphemerisFile read_rinex_sets(std::string_view text, const std::string& file, const SystemSet& used) {
  files::TextLines lines(text, file);
  const RinexHeader header = read_rinex_header(lines);
  EphemerisFile result;
  result.corrections = header.corrections;
  RinexRecords records(lines, header.version, used);
  while (const auto record = records.next(result.corrections)) result.satellites.push_back(ephemeris_of(*record));
  const std::string left_out = records.left_out().text();
  // A run may take its systems from several files.
  if (result.satellites.empty() && !records.has_unused_systems())
    lines.refuse(left_out.empty() ? "no record of a satellite" : fmt::format("nothing but {}", left_out),
                 "at least one set of GPS LNAV, Galileo I/NAV or BeiDou D1 or D2");
  if (!left_out.empty()) result.note = fmt::format("{}: not used are {}.", file, left_out);
  if (const int resolved = records.sets_with_resolved_week(); resolved > 0)
    result.note += fmt::format("{}{}: sets whose week is counted modulo 1024 and resolved by their date: {}.",
                               result.note.empty() ? "" : " ", file, resolved);
  return result;
}

EphemerisFile read_rinex(std::string_view text, const std::string& file, const SystemSet& used) {
  EphemerisFile result = read_rinex_sets(text, file, used);
  if (!result.satellites.empty()) result.satellites = nearest_to(noon_of(result.satellites), result.satellites);
  return result;
}

}  // namespace vbar::twins::gnss
