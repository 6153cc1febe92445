#include "host_sim/installation/sensor_kinds.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "host_sim/installation/navigation_telecommands.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/mission/mission.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "host_sim/sensors/ideal_navigation_kind.h"
#include "host_sim/sensors/installed_testbeds.h"
#include "host_sim/sensors/range_finder/range_finder_kind.h"

namespace vbar::sensors {
namespace {

constexpr const SensorKind* kSensorKinds[] = {&kIdealNavigation, &kGnss, &kCamera, &kRangeFinder};

/// Adds a note on each testbed whose programs and devices are not started, as nothing in the mission has it as source.
void note_unused_testbeds(const mission::Mission& mission, std::vector<std::string>& notes) {
  for (const mission::Testbed& testbed : mission.testbeds) {
    const auto has_sensor = [&](const mission::Spacecraft& spacecraft) {
      return std::ranges::any_of(
          spacecraft.sensors, [&](const mission::Sensor& sensor) { return sensor.settings->source == testbed.name; });
    };
    if (mission.truth_source == testbed.name || std::ranges::any_of(mission.spacecraft, has_sensor)) continue;
    notes.push_back("testbed." + testbed.name +
                    " has no effect in this mission: neither a sensor nor the truth has source = \"" + testbed.name +
                    "\"");
  }
}

}  // namespace

std::span<const SensorKind* const> sensor_kinds() {
  return kSensorKinds;
}

const SensorKind& kind_of(const mission::Sensor& sensor) {
  const auto found =
      std::ranges::find_if(kSensorKinds, [&](const SensorKind* kind) { return kind->name == sensor.kind; });
  if (found == std::end(kSensorKinds)) throw std::logic_error("\"" + sensor.kind + "\" is not a kind of sensor");
  return **found;
}

mission::Installation installation() {
  mission::Installation installation;
  installation.data_directory = mission::data_directory();
  installation.kinds.assign(std::begin(kSensorKinds), std::end(kSensorKinds));
  const auto testbeds = testbeds::testbed_kinds();
  installation.testbeds.assign(testbeds.begin(), testbeds.end());
  installation.clocks = {&engine::kMonotonicClock};
  const auto clocks = testbeds::testbed_clocks();
  installation.clocks.insert(installation.clocks.end(), clocks.begin(), clocks.end());
  return installation;
}

mission::Mission load_mission(const std::filesystem::path& file, std::span<const std::string> overrides) {
  return mission::load_mission(file, overrides, installation());
}

mission::Mission parse_mission(std::string_view text, const std::filesystem::path& file,
                               std::span<const std::string> overrides) {
  return mission::parse_mission(text, file, overrides, installation());
}

MadeSources make_sources(const mission::Mission& mission, const mission::Spacecraft& servicer,
                         const std::filesystem::path& data_directory, twins::TruthOutlook* outlook) {
  MadeSources made;
  SharedObjects shared;
  testbeds::OpenTestbeds testbeds;
  const MakeContext context{mission, servicer, data_directory, shared, testbeds, outlook, made.data_notes};
  for (const mission::Sensor& sensor : servicer.sensors) kind_of(sensor).add_sources(sensor, context, made.sources);
  made.testbeds = testbeds.runs();
  note_unused_testbeds(mission, made.data_notes);
  return made;
}

std::unique_ptr<twins::TileSource> make_tile_source(const RestoreContext& context, twins::ImagesOfLog&& images) {
  const auto* const found =
      std::ranges::find_if(kSensorKinds, [](const SensorKind* kind) { return kind->make_tile_source != nullptr; });
  if (found == std::end(kSensorKinds)) throw std::logic_error("no kind of sensor restores the tiles of images");
  return (*found)->make_tile_source(context, std::move(images));
}

std::vector<NamedEvaluation> make_evaluations(const mission::Mission& mission, const mission::Spacecraft& servicer,
                                              report::RunRecord& record) {
  std::vector<NamedEvaluation> evaluations;
  const EvaluationContext context{mission, servicer, record};
  for (const mission::Sensor& sensor : servicer.sensors) {
    const SensorKind& kind = kind_of(sensor);
    auto evaluation = kind.evaluate != nullptr ? kind.evaluate(sensor, context) : nullptr;
    if (evaluation) evaluations.push_back({source_name(servicer, sensor), std::move(evaluation)});
  }
  return evaluations;
}

void add_facts(const mission::Mission& mission, const mission::Spacecraft& servicer, report::RunFacts& facts) {
  for (const mission::Sensor& sensor : servicer.sensors)
    if (const SensorKind& kind = kind_of(sensor); kind.add_facts != nullptr)
      kind.add_facts(sensor, mission, servicer, facts);
}

report::Extensions extensions() {
  static const auto kExtensions = [] {
    std::vector<const report::Extension*> all;
    for (const SensorKind* const kind : kSensorKinds) all.push_back(&kind->report);
    for (const testbeds::TestbedKind* const kind : testbeds::testbed_kinds()) all.push_back(&kind->report);
    return all;
  }();
  return kExtensions;
}

std::vector<twins::Packet> telecommands_of(const TelecommandContext& context) {
  Telecommands telecommands(context.mission.start_time(), context.servicer.number);
  telecommands.add(context.mission.guidance.configuration);
  add_navigation_telecommands(context, telecommands);
  for (const mission::Sensor& sensor : context.servicer.sensors) {
    const SensorKind& kind = kind_of(sensor);
    if (kind.add_telecommands != nullptr) kind.add_telecommands(sensor, context, telecommands);
  }
  telecommands.add(mission::waypoint_table_of(context.mission));
  if (context.mission.safety) telecommands.add(*context.mission.safety);
  telecommands.add(mission::mode_command_of(context.mission));
  return telecommands.packets();
}

}  // namespace vbar::sensors
