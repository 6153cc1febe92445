#include "host_sim/observation_files/rinex_observations.h"

#include <algorithm>

#include <fmt/format.h>

namespace vbar::observation_files {

using orbit_files::TimeSystem;

ObservedValue RecordedEpoch::value(const SatelliteObservations& satellite, std::string_view name) const {
  const std::vector<std::string>& names = types->of(satellite.system);
  const auto found = std::ranges::find(names, name);
  const auto place = static_cast<std::size_t>(found - names.begin());
  return place < satellite.values.size() ? satellite.values[place] : ObservedValue{};
}

ObservationReader::ObservationReader(std::string_view text, const std::string& file) : lines_(text, file) {
  read_header();
}

void ObservationReader::read_header() {
  if (!lines_.next()) lines_.refuse("an empty file", "a RINEX observation file");
  types_ = std::make_shared<ObservationTypes>(observation_version(lines_));
  // Blank and M: GPS, unless a satellite names its system.
  const char system = lines_.columns(41, 41).empty() ? ' ' : lines_.columns(41, 41).front();
  if (system >= 'A' && system <= 'Z' && system != 'M') default_system_ = system;
  if (system == 'R') time_system_ = TimeSystem::kUtc;
  if (system == 'C') time_system_ = TimeSystem::kBeidou;
  while (lines_.next()) {
    if (label_of(lines_) == "END OF HEADER") {
      types_->check_complete(lines_);
      if (types_->empty()) lines_.refuse("a header without observation types", "a list of them before its end");
      return;
    }
    take_header_line();
  }
  lines_.refuse("the end of the file", "END OF HEADER");
}

void ObservationReader::take_header_line() {
  const std::string_view label = label_of(lines_);
  types_->take(lines_);
  if (label == "MARKER NAME") marker_ = files::printable(files::trimmed(lines_.columns(1, 60)));
  if (label == "INTERVAL") {
    interval_s_ = lines_.number_in(1, 10, "the interval");
    if (!(interval_s_ >= 0.0 && interval_s_ <= 86400.0)) lines_.refuse("an interval from 0 to 86400 s");
  }
  if (label == "SYS / SCALE FACTOR" && lines_.integer_in(3, 6, "a scale factor") != 1)
    lines_.refuse("observations that are multiplied by a factor", "factor 1");
  if (label == "TIME OF FIRST OBS") {
    const std::string_view name = files::trimmed(lines_.columns(49, 51));
    if (name.empty()) return;
    if (name == "GLO") {
      time_system_ = TimeSystem::kUtc;
    } else if (const auto system = orbit_files::time_system_named(name)) {
      time_system_ = *system;
    } else if (name == "QZS" || name == "IRN") {
      time_system_ = TimeSystem::kGps;
    } else {
      lines_.refuse(fmt::format("the time system {}", files::quoted(name)), "GPS, GLO, GAL, BDT, QZS or IRN");
    }
  }
}

void ObservationReader::need_line(std::string_view of_what) {
  if (!lines_.next()) lines_.refuse("the end of the file", fmt::format("the next line of {}", of_what));
}

ObservationReader::EpochLine ObservationReader::read_epoch_line() const {
  const bool is_old = types_->version() == 2;
  if (!is_old && !lines_.line().starts_with('>')) lines_.refuse("an epoch that begins with >");
  EpochLine line;
  const std::string_view flag = is_old ? lines_.columns(29, 29) : lines_.columns(32, 32);
  line.flag = files::trimmed(flag).empty() ? 0 : lines_.integer_in(is_old ? 29 : 32, is_old ? 29 : 32, "a flag");
  if (line.flag < 0 || line.flag > 6) lines_.refuse(fmt::format("the flag {}", line.flag), "0 to 6");
  line.count = lines_.integer_in(is_old ? 30 : 33, is_old ? 32 : 35, "the number of satellites");
  const bool is_event = line.flag >= 2 && line.flag <= 5;
  if (line.count < 0 || (!is_event && line.count > kMaxSatellites))
    lines_.refuse(fmt::format("{} satellites", line.count), fmt::format("0 to {}", kMaxSatellites));
  const std::string_view date = is_old ? lines_.columns(1, 26) : lines_.columns(2, 29);
  if (is_event && files::trimmed(date).empty()) return line;
  orbit_files::Calendar calendar;
  if (is_old) {
    calendar.year = lines_.integer_in(2, 3, "the year");
    calendar.year += calendar.year < 80 ? 2000 : 1900;
  } else {
    calendar.year = lines_.integer_in(3, 6, "the year");
  }
  const std::size_t first = is_old ? 5 : 8;
  calendar.month = lines_.integer_in(first, first + 1, "the month");
  calendar.day = lines_.integer_in(first + 3, first + 4, "the day");
  calendar.hour = lines_.integer_in(first + 6, first + 7, "the hour");
  calendar.minute = lines_.integer_in(first + 9, first + 10, "the minute");
  calendar.second = lines_.number_in(first + 11, first + 21, "the seconds");
  if (calendar.month != 0) line.time = orbit_files::instant_of_carried(calendar, time_system_);
  if (!line.time) lines_.refuse("a date and a time of day");
  return line;
}

std::pair<char, int> ObservationReader::satellite_in(std::size_t column) const {
  const std::string_view letter = lines_.columns(column, column);
  const char system =
      letter == " " && types_->version() == 2 ? default_system_ : (letter.empty() ? ' ' : letter.front());
  const auto number = files::integer_of(lines_.columns(column + 1, column + 2));
  if (system < 'A' || system > 'Z' || !number || *number < 1)
    lines_.refuse(fmt::format("a satellite, as G05, in columns {} to {}", column, column + 2));
  return {system, *number};
}

std::vector<std::pair<char, int>> ObservationReader::satellites_of_version_2(int count) {
  constexpr std::size_t kFirst = 33, kPerLine = 12;
  std::vector<std::pair<char, int>> satellites;
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
    if (k > 0 && k % kPerLine == 0) need_line("the list of satellites");
    satellites.push_back(satellite_in(kFirst + 3 * (k % kPerLine)));
  }
  return satellites;
}

/// Reads the fields of one satellite from the present line on.
void ObservationReader::read_values(SatelliteObservations& satellite, std::size_t first_column, std::size_t per_line) {
  constexpr std::size_t kWidth = 16, kNumber = 14;
  const std::size_t types = types_->of(satellite.system).size();
  for (std::size_t k = 0; k < types; ++k) {
    if (k > 0 && k % per_line == 0) need_line("a satellite");
    const std::size_t first = first_column + kWidth * (k % per_line);
    ObservedValue& value = satellite.values.emplace_back();
    value.value = lines_.number_or_blank_in(first, first + kNumber - 1, "an observation").value_or(0.0);
    const auto digit = [&](std::size_t column) {
      const std::string_view text = files::trimmed(lines_.columns(column, column));
      if (text.empty()) return std::uint8_t{0};
      if (text.front() < '0' || text.front() > '9')
        lines_.refuse(fmt::format("{} in column {}", files::quoted(text), column), "a digit or a blank");
      return static_cast<std::uint8_t>(text.front() - '0');
    };
    value.loss_of_lock = digit(first + kNumber);
    value.strength = digit(first + kNumber + 1);
  }
}

std::vector<SatelliteObservations> ObservationReader::read_satellites(int count) {
  const bool is_old = types_->version() == 2;
  std::vector<SatelliteObservations> satellites;
  const auto listed = is_old ? satellites_of_version_2(count) : std::vector<std::pair<char, int>>{};
  std::set<std::pair<char, int>> seen;
  for (int k = 0; k < count; ++k) {
    need_line(fmt::format("satellite {} of {}", k + 1, count));
    if (!is_old && lines_.line().starts_with('>')) lines_.refuse(fmt::format("satellite {} of {}", k + 1, count));
    const auto [system, number] = is_old ? listed[static_cast<std::size_t>(k)] : satellite_in(1);
    if (!seen.insert({system, number}).second)
      lines_.refuse(fmt::format("{}{:02d} a second time in one epoch", system, number), "each satellite once");
    if (types_->of(system).empty())
      lines_.refuse(fmt::format("the system {} without types in the header", system), "a system of the header");
    SatelliteObservations& satellite = satellites.emplace_back();
    satellite.system = system;
    satellite.number = number;
    constexpr std::size_t kFieldsOfVersion2 = 5;
    read_values(satellite, is_old ? 1 : 4, is_old ? kFieldsOfVersion2 : std::size_t{ObservationTypes::kMaxTypes});
  }
  return satellites;
}

/// Lines of an event: those of a header among them are valid from there on.
void ObservationReader::skip_event(const EpochLine& line) {
  ++counts_.events;
  auto changed = std::make_shared<ObservationTypes>(*types_);
  std::swap(changed, types_);
  for (int k = 0; k < line.count; ++k) {
    need_line(fmt::format("an event (flag {})", line.flag));
    if (line.flag == 3 || line.flag == 4) take_header_line();
  }
  types_->check_complete(lines_);
}

void ObservationReader::note_slips(const std::vector<SatelliteObservations>& satellites) {
  ++counts_.slip_records;
  for (const SatelliteObservations& one : satellites)
    for (std::size_t k = 0; k < one.values.size(); ++k)
      if (one.values[k].value != 0.0 || one.values[k].loss_of_lock != 0)
        slips_.insert({std::pair{one.system, one.number}, k});
}

void ObservationReader::apply_slips(RecordedEpoch& epoch) {
  if (slips_.empty()) return;
  for (SatelliteObservations& one : epoch.satellites)
    for (std::size_t k = 0; k < one.values.size(); ++k)
      if (one.values[k].value != 0.0 && slips_.erase({std::pair{one.system, one.number}, k}) > 0)
        one.values[k].loss_of_lock |= 1U;
}

std::optional<RecordedEpoch> ObservationReader::next() {
  while (lines_.next()) {
    if (lines_.is_blank()) continue;
    const EpochLine line = read_epoch_line();
    if (line.flag >= 2 && line.flag <= 5) {
      skip_event(line);
      continue;
    }
    const fsw::GpsTime time = *line.time;
    if (line.flag == 6) {
      note_slips(read_satellites(line.count));
      continue;
    }
    if (last_ && time <= *last_) lines_.refuse("an epoch at or before the one before", "epochs in ascending order");
    last_ = time;
    ++counts_.epochs;
    RecordedEpoch epoch;
    epoch.time = time;
    epoch.after_power_failure = line.flag == 1;
    if (epoch.after_power_failure) ++counts_.power_failures;
    epoch.types = types_;
    epoch.satellites = read_satellites(line.count);
    apply_slips(epoch);
    return epoch;
  }
  return std::nullopt;
}

bool is_observation_file(std::string_view text) {
  const std::string_view first = text.substr(0, text.find('\n'));
  return is_compact_rinex(text) ||
         (first.size() > 60 && first.substr(60).starts_with("RINEX VERSION / TYPE") && first[20] == 'O');
}

std::string plain_observations(std::string text, const std::string& file) {
  return is_compact_rinex(text) ? expand_compact_rinex(text, file) : std::move(text);
}

}  // namespace vbar::observation_files
