#include "host_sim/sensors/ideal_navigation_kind.h"

#include <algorithm>

#include "host_sim/sensors/sensor_kind.h"
#include "host_sim/twins/ideal_navigation.h"
#include "host_sim/twins/recorded_log.h"

namespace vbar::sensors {
namespace {

using mission::TableReader;

std::shared_ptr<const mission::SensorSettings> read(const TableReader& section, const mission::SensorContext& context) {
  auto sensor = std::make_shared<NavigationSensor>();
  const std::vector<std::string>& names = context.spacecraft_names;
  mission::read_source(section, "ideal", context, *sensor);
  sensor->navigation = vbar::navigation_configuration::kUseIdeal;
  sensor->observed = section.name("target", "target");
  if (std::find(names.begin(), names.end(), sensor->observed) == names.end())
    section.refuse("target", "the spacecraft \"" + sensor->observed + "\"",
                   mission::listing_of({names.begin(), names.end()}));
  sensor->period =
      section.span("period_s", 1.0, mission::from_to(1e-3, 1e6), fsw::seconds(context.mission.step.shortest_period()));
  return sensor;
}

void check(const TableReader& section, const mission::Sensor& sensor, const mission::Spacecraft& spacecraft,
           const mission::Mission& /*mission*/) {
  for (const mission::Sensor& other : spacecraft.sensors)
    if (&other != &sensor && other.kind == sensor.kind)
      section.refuse("", "a second sensor of kind " + sensor.kind, "one, whose states navigation can take for true");
}

void add_sources(const mission::Sensor& sensor, const MakeContext& context, std::vector<twins::NamedSource>& sources) {
  const auto& own = settings_of<NavigationSensor>(sensor);
  const std::string name = source_name(context.servicer, sensor);
  if (own.source == "recorded") {
    const twins::RecordedLog::Selection selection{context.servicer.number, {fsw::packets::Apid::kIdealNavigation}};
    sources.push_back({name, own.source, std::make_unique<twins::RecordedLog>(own.log, selection)});
    return;
  }
  if (auto packets = only_packets_of_testbed(sensor, kIdealNavigation, context, fsw::packets::Apid::kIdealNavigation)) {
    sources.push_back({name, own.source, std::move(packets)});
    return;
  }
  twins::IdealNavigation::Settings settings;
  settings.servicer = context.servicer.name;
  settings.servicer_number = context.servicer.number;
  settings.target = own.observed;
  settings.start = context.mission.start_time();
  settings.period = own.period;
  sources.push_back({name, own.source, std::make_unique<twins::IdealNavigation>(settings)});
}

void add_facts(const mission::Sensor& sensor, const mission::Mission& /*mission*/,
               const mission::Spacecraft& /*servicer*/, report::RunFacts& facts) {
  facts.navigation = sensor.settings->source;
}

}  // namespace

const SensorKind kIdealNavigation{
    {"navigation", "", read, nullptr, check}, {fsw::packets::Apid::kIdealNavigation}, nullptr, add_sources, add_facts};

}  // namespace vbar::sensors
