#include "host_sim/sensors/gnss/gnss_kind.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "fsw/math/math.h"
#include "host_sim/sensors/gnss/gnss_evaluation.h"
#include "host_sim/sensors/gnss/gnss_row.h"
#include "host_sim/sensors/packets_of_testbed.h"
#include "host_sim/twins/gnss/body_frame.h"
#include "host_sim/twins/gnss/gnss_receiver.h"
#include "host_sim/twins/gnss_sensor.h"
#include "host_sim/twins/recorded_log.h"

namespace vbar::sensors {
namespace {

using mission::find_settings;
using mission::Mission;
using mission::Sensor;
using mission::Spacecraft;
using mission::TableReader;

/// The receivers of a pair are in one testbed or in none.
void check_sources(const TableReader& section, const Sensor& sensor, const Spacecraft& partner) {
  const std::string& own = sensor.settings->source;
  const std::string& other = find_settings<GnssSensor>(partner)->source;
  if (own == other) return;
  if (testbeds::find_testbed(own) == nullptr && testbeds::find_testbed(other) == nullptr) return;
  section.refuse_value("source", other + ", the source of " + partner.name + ": the receivers of a pair share a sky");
}

/// Checks that both ends of relative navigation by GNSS have the sensors for it.
void check(const TableReader& section, const Sensor& sensor, const Spacecraft& spacecraft, const Mission& mission) {
  if (settings_of<GnssSensor>(sensor).line.wired == testbeds::Wiring::kBoard && !spacecraft.flight_computer)
    section.refuse_value("wired", "host: " + spacecraft.name + " has no flight computer");
  for (const Sensor& other : spacecraft.sensors) {
    if (&other == &sensor) continue;
    if (other.kind == sensor.kind) section.refuse("", "a second sensor of kind gnss", "one on a spacecraft");
    if (other.settings->navigation == vbar::navigation_configuration::kUseIdeal)
      section.refuse("", "a second way to navigate", "a sensor of kind navigation or gnss, not both");
  }
  const bool is_beside_camera = std::ranges::any_of(spacecraft.sensors, [](const Sensor& other) {
    using Use = vbar::navigation_configuration;
    return (other.settings->navigation & (std::int32_t{Use::kUseBearings} + Use::kUseKeypoints)) != 0;
  });
  if (!spacecraft.flight_computer || (is_beside_camera && sensor.settings->observed.empty())) return;
  const Spacecraft* const partner = mission.find_spacecraft(sensor.settings->observed);
  if (partner == nullptr || find_settings<GnssSensor>(*partner) == nullptr)
    section.refuse("partner", partner == nullptr ? "nothing" : "the spacecraft \"" + partner->name + "\" without GNSS",
                   "a spacecraft that has sensors.gnss too");
  check_sources(section, sensor, *partner);
  for (const Spacecraft* one : {&spacecraft, partner})
    if (!one->attitude)
      section.refuse("", "no attitude of " + one->name, "both spacecraft with an attitude: antennas point somewhere");
}

std::unique_ptr<twins::gnss::ReceiverBytes> make_twin(const MakeContext& context, const Spacecraft& carrier) {
  const Mission& mission = context.mission;
  const auto sky = context.shared.get<const twins::gnss::Constellation>("gnss/sky", [&] {
    auto made = std::make_shared<const twins::gnss::Constellation>(
        context.data_directory, mission::shared_settings<GnssShared>(mission).constellation, mission.start_time(),
        mission.seed);
    context.data_notes.insert(context.data_notes.end(), made->notes().begin(), made->notes().end());
    return made;
  });
  return std::make_unique<twins::gnss::GnssReceiver>(find_settings<GnssSensor>(carrier)->receiver, sky,
                                                     context.data_directory, mission.seed, carrier.name);
}

std::unique_ptr<twins::gnss::ReceiverBytes> make_of_testbed(const testbeds::TestbedKind& testbed,
                                                            const MakeContext& context, const Spacecraft& carrier) {
  if (context.outlook == nullptr) throw std::logic_error("a testbed requires the truth of the run");
  const auto run = context.testbeds.run_of(testbed, {context.mission, context.data_directory, *context.outlook});
  const GnssSensor& settings = *find_settings<GnssSensor>(carrier);
  auto receiver = run->make_receiver({carrier.name, settings.receiver, settings.line});
  if (!receiver) throw std::runtime_error("testbed \"" + std::string(testbed.name) + "\" has no GNSS receivers");
  return receiver;
}

std::unique_ptr<twins::PacketSource> make_receiver(const MakeContext& context, const std::string& source,
                                                   const Spacecraft& carrier) {
  const Mission& mission = context.mission;
  const testbeds::TestbedKind* const testbed = testbeds::find_testbed(source);
  twins::GnssSensor::Settings sensor;
  sensor.spacecraft = carrier.name;
  sensor.flight_number = context.servicer.number;
  sensor.start = mission.start_time();
  auto receiver = testbed != nullptr ? make_of_testbed(*testbed, context, carrier) : make_twin(context, carrier);
  sensor.period = receiver->call_period().value_or(
      fsw::nearest_duration(find_settings<GnssSensor>(carrier)->receiver.output.period_s));
  // The partner's epochs are those of the servicer's receiver, whenever they begin.
  if (&carrier != &context.servicer)
    sensor.start = twins::next_periodic_epoch(
        sensor.start, sensor.period, mission.epoch + mission::shared_settings<GnssShared>(mission).crosslink_from);
  std::unique_ptr<twins::gnss::Crosslink> crosslink;
  if (&carrier != &context.servicer)
    crosslink = std::make_unique<twins::gnss::Crosslink>(mission::shared_settings<GnssShared>(mission).crosslink,
                                                         mission.seed, carrier.name);
  return std::make_unique<twins::GnssSensor>(sensor, std::move(receiver), std::move(crosslink));
}

/// Those of the own receiver, or those that the crosslink delivers.
std::vector<fsw::packets::Apid> messages_of(const Spacecraft& carrier, const Spacecraft& servicer) {
  using fsw::packets::Apid;
  if (&carrier == &servicer) return {Apid::kGnssBytes, Apid::kAttitude};
  return {Apid::kCrosslinkGnssBytes, Apid::kCrosslinkAttitude};
}

void add_sources(const Sensor& sensor, const MakeContext& context, std::vector<twins::NamedSource>& sources) {
  if (sensor.settings->source == "recorded") {
    using fsw::packets::Apid;
    const twins::RecordedLog::Selection selection{
        context.servicer.number,
        {Apid::kGnssBytes, Apid::kAttitude, Apid::kCrosslinkGnssBytes, Apid::kCrosslinkAttitude}};
    sources.push_back({source_name(context.servicer, sensor), sensor.settings->source,
                       std::make_unique<twins::RecordedLog>(sensor.settings->log, selection)});
    return;
  }
  const std::string& source = sensor.settings->source;
  const auto add = [&](const Spacecraft& carrier) {
    auto packets = packets_of_testbed(sensor, kGnss, context, carrier, messages_of(carrier, context.servicer), 0);
    if (!packets) packets = make_receiver(context, source, carrier);
    sources.push_back({source_name(carrier, sensor), source, std::move(packets)});
  };
  add(context.servicer);
  if (const Spacecraft* const partner = context.mission.find_spacecraft(sensor.settings->observed)) add(*partner);
}

void add_telecommands(const Sensor& sensor, const TelecommandContext& context, Telecommands& telecommands) {
  telecommands.add(receiver_configuration_of(context.servicer));
  if (!sensor.settings->observed.empty()) telecommands.add(carrier_configuration_of(context.mission, context.servicer));
}

template <std::size_t kAxes>
void copy_antenna(const GnssSensor& gnss, double (&antenna_m)[kAxes]) {
  const fsw::Vector3& nominal = gnss.receiver.body_frame.antenna_in_body_m;
  std::copy(nominal.begin(), nominal.end(), antenna_m);
}

void add_facts(const Sensor& sensor, const Mission& mission, const Spacecraft& servicer, report::RunFacts& facts) {
  facts.gnss = sensor.settings->source;
  facts.navigation = "gnss";
  facts.static_floor_m = gnss_static_floor_m(mission, servicer);
}

std::unique_ptr<Evaluation> evaluate(const Sensor& /*sensor*/, const EvaluationContext& context) {
  return std::make_unique<GnssEvaluation>(context);
}

constexpr fsw::packets::Apid kMessagesInTables[] = {fsw::packets::Apid::kTelemetryGnss};

std::vector<report::TableKind> tables() {
  return {report::table_of_extension<GnssRow>("gnss.csv"),
          report::table_of_extension<SignalNoiseRow>("signal_noise.csv")};
}

std::vector<report::Section> sections(const report::RunRecord& record) {
  return {gnss_section(record), signal_noise_section(record)};
}

}  // namespace

const SensorKind kGnss{{"gnss", "constellation", read_gnss, read_gnss_shared, check},
                       {fsw::packets::Apid::kGnssBytes, fsw::packets::Apid::kCrosslinkGnssBytes},
                       add_telecommands,
                       add_sources,
                       add_facts,
                       evaluate,
                       false,
                       {tables, summarise_gnss, sections, kMessagesInTables, gnss_paper_columns, gnss_consistency}};

vbar::receiver_configuration receiver_configuration_of(const Spacecraft& servicer) {
  vbar::receiver_configuration configuration{};
  copy_antenna(*find_settings<GnssSensor>(servicer), configuration.antenna_body_m);
  return configuration;
}

vbar::carrier_configuration carrier_configuration_of(const Mission& mission, const Spacecraft& servicer) {
  vbar::carrier_configuration configuration = mission::shared_settings<GnssShared>(mission).carrier;
  const Spacecraft& partner = *mission.find_spacecraft(find_settings<GnssSensor>(servicer)->observed);
  copy_antenna(*find_settings<GnssSensor>(partner), configuration.target_antenna_body_m);
  return configuration;
}

std::optional<double> gnss_static_floor_m(const Mission& mission, const Spacecraft& servicer) {
  const GnssSensor* const own = find_settings<GnssSensor>(servicer);
  if (own == nullptr || own->observed.empty()) return std::nullopt;
  const Spacecraft& partner = *mission.find_spacecraft(own->observed);
  const twins::gnss::BodyFrameSettings& ours = own->receiver.body_frame;
  const twins::gnss::BodyFrameSettings& theirs = find_settings<GnssSensor>(partner)->receiver.body_frame;
  const auto our_errors = twins::gnss::draw_body_frame(ours, mission.seed, servicer.name);
  const auto their_errors = twins::gnss::draw_body_frame(theirs, mission.seed, partner.name);
  return twins::gnss::static_floor_m(ours, our_errors, theirs, their_errors).norm();
}

}  // namespace vbar::sensors
