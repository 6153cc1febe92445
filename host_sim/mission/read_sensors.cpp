#include <algorithm>
#include <utility>
#include <vector>

#include "host_sim/mission/data_file.h"
#include "host_sim/mission/name_search.h"
#include "host_sim/mission/read_sections.h"
#include "host_sim/mission/sensor_reader.h"

namespace vbar::mission {

namespace {

constexpr std::size_t kMaxPeriods = 32;

/// Parts that end before the start of the mission are of no effect; the one in force at the start begins there.
engine::Cadence from_start(std::vector<engine::Cadence::Part> parts, fsw::GpsTime start) {
  while (parts.size() > 1 && parts[1].from <= start) parts.erase(parts.begin());
  if (parts.front().from < start) parts.front().from = start;
  return engine::Cadence(std::move(parts));
}

}  // namespace

engine::Cadence read_cadence(const TableReader& section, std::string_view key, Range period_s, const Mission& mission,
                             const engine::Cadence& default_value) {
  if (!section.has(key)) return default_value;
  if (!section.is_array(key)) return {mission.start_time(), section.span(key, 1.0, period_s)};
  std::vector<engine::Cadence::Part> parts;
  for (const auto& [from_h, seconds] : section.pairs(key, kMaxPeriods, from_to(0.0, kLongestMission_h), period_s)) {
    const fsw::GpsTime from = mission.epoch + fsw::nearest_duration(kHour_s * from_h);
    if (!parts.empty() && from <= parts.back().from) section.refuse_value(key, "hours in increasing order");
    parts.push_back({from, fsw::nearest_duration(seconds)});
  }
  return from_start(std::move(parts), mission.start_time());
}

engine::Cadence read_cadence(const TableReader& section, std::string_view key, Range period_s, const Mission& mission,
                             fsw::Duration default_value) {
  return read_cadence(section, key, period_s, mission, engine::Cadence(mission.start_time(), default_value));
}

namespace {

constexpr std::string_view kRecorded = "recorded";

template <class Readers>
std::vector<std::string_view> names_of(const Readers& readers) {
  std::vector<std::string_view> names;
  for (const auto* const reader : readers) names.push_back(reader->name);
  return names;
}

/// Index of the kind in the program's list. A sensor with the name of a kind need not specify the kind.
std::size_t kind_of(const TableReader& section, const std::string& name, const Installation& installation) {
  const std::vector<std::string_view> kinds = names_of(installation.kinds);
  const auto place_of = [&](std::string_view kind) {
    return static_cast<std::size_t>(std::find(kinds.begin(), kinds.end(), kind) - kinds.begin());
  };
  const std::string kind = section.text("kind", name);
  const std::size_t place = place_of(kind);
  if (place < kinds.size()) return place;
  section.refuse("kind",
                 (section.has("kind") ? "the text \"" : "nothing, and the sensor has the name \"") + kind + "\"" +
                     did_you_mean(kind, kinds),
                 listing_of(kinds));
}

}  // namespace

std::vector<Sensor> read_sensors(const TableReader& sensors, const SensorContext& context) {
  std::vector<std::vector<Sensor>> by_kind(context.installation.kinds.size());
  for (const std::string& name : sensors.keys()) {
    const TableReader section = sensors.table(name);
    if (!is_name(name)) sensors.refuse(name, "the name \"" + name + "\"", std::string(kNameRule));
    const std::size_t kind = kind_of(section, name, context.installation);
    const SensorReader& reader = *context.installation.kinds[kind];
    by_kind[kind].push_back({name, std::string(reader.name), reader.read(section, context)});
    section.finish();
  }
  std::vector<Sensor> all;
  for (std::vector<Sensor>& some : by_kind) std::ranges::move(some, std::back_inserter(all));
  return all;
}

void check_sensors(const TableReader& sensors, const Spacecraft& spacecraft, const Mission& mission,
                   const Installation& installation) {
  for (const Sensor& sensor : spacecraft.sensors) {
    const auto reader =
        std::ranges::find_if(installation.kinds, [&](const SensorReader* kind) { return kind->name == sensor.kind; });
    if ((*reader)->check != nullptr) (*reader)->check(sensors.table(sensor.name), sensor, spacecraft, mission);
  }
}

void read_source(const TableReader& section, std::string_view twin, const SensorContext& context,
                 SensorSettings& settings, std::string_view another) {
  std::vector<std::string_view> accepted{twin, kRecorded};
  if (!another.empty()) accepted.push_back(another);
  for (const Testbed& testbed : context.mission.testbeds) accepted.push_back(testbed.name);
  settings.source = section.choice("source", accepted, twin);
  const std::string log = section.text("log", "");
  const bool is_recorded = settings.source == kRecorded;
  if (is_recorded && log.empty()) section.refuse("log", "nothing", "the packets.lcmlog to play, as source is recorded");
  if (!is_recorded && !log.empty()) section.refuse_value("log", "nothing, unless source is recorded");
  if (!is_recorded) return;
  settings.log = file_on_command_line(section, "log", log);
  if (settings.log.empty()) settings.log = context.mission.file.parent_path() / log;  // an absolute one stays as it is
}

void read_shared(const TableReader& document, Mission& mission, const Installation& installation) {
  for (const SensorReader* const kind : installation.kinds) {
    if (kind->read_shared == nullptr) continue;
    mission.shared.push_back(kind->read_shared(document, mission));
  }
  read_navigation(document, mission);
}

void read_testbeds(const TableReader& document, Mission& mission, const Installation& installation) {
  const TableReader testbeds = document.table("testbed");
  for (const std::string& name : testbeds.keys()) {
    const TableReader section = testbeds.table(name);
    const auto driver =
        std::ranges::find_if(installation.testbeds, [&](const TestbedReader* reader) { return reader->name == name; });
    if (driver == installation.testbeds.end()) {
      const std::string drivers = listing_of(names_of(installation.testbeds));
      section.refuse("", "a testbed without a driver in this program",
                     drivers.empty() ? "no testbed: no driver is registered" : drivers);
    }
    mission.testbeds.push_back({name, (*driver)->read(section)});
    section.finish();
  }
}

void check_testbeds(const TableReader& document, const Mission& mission, const Installation& installation) {
  for (const Testbed& testbed : mission.testbeds) {
    const auto driver = std::ranges::find(installation.testbeds, testbed.name, &TestbedReader::name);
    if ((*driver)->check != nullptr)
      (*driver)->check(document.table("testbed").table(testbed.name), *testbed.settings, mission);
  }
}

}  // namespace vbar::mission
