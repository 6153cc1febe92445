#include "host_sim/sensors/gnss/gnss_kind.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "fsw/math/math.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/read_sections.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/sensors/gnss/gnss_evaluation.h"
#include "host_sim/sensors/gnss/gnss_rows.h"
#include "host_sim/sensors/sensor_kind.h"
#include "host_sim/sensors/settings/gnss_tables.h"
#include "host_sim/twins/gnss/body_frame.h"
#include "host_sim/twins/gnss/gnss_receiver.h"
#include "host_sim/twins/gnss/gnss_sensor.h"
#include "host_sim/twins/recorded_log.h"

namespace vbar::sensors {

namespace {

using mission::above_to;
using mission::from_to;
using mission::Names;
using mission::Range;
using mission::TableReader;

using twins::gnss::GpsEphemerisLog;
using twins::gnss::L1Code;
using twins::gnss::StartMode;

constexpr Names<StartMode, 3> kStartModes{
    {{"cold", StartMode::kCold}, {"warm", StartMode::kWarm}, {"hot", StartMode::kHot}}};
constexpr Names<GpsEphemerisLog, 2> kEphemerisLogs{
    {{"rawephem", GpsEphemerisLog::kRawEphem}, {"gpsephem", GpsEphemerisLog::kGpsEphem}}};

constexpr Names<testbeds::Wiring, 2> kWirings{{{"host", testbeds::Wiring::kHost}, {"board", testbeds::Wiring::kBoard}}};

void read_vector(const TableReader& section, std::string_view key, Range range, fsw::Vector3& value) {
  const auto xyz = section.three_numbers(key, range, std::array<double, 3>{value.x(), value.y(), value.z()});
  value = {xyz[0], xyz[1], xyz[2]};
}

constexpr Names<L1Code, 2> kL1Codes{{{"ca", L1Code::kCa}, {"p", L1Code::kP}}};

void read_tracking(const TableReader& section, twins::gnss::TrackingSettings& settings) {
  settings.thermal_noise = section.flag("thermal_noise", settings.thermal_noise);
  read(section, "code_loop_bandwidth_hz", above_to(0.0, 100.0), settings.code_loop_bandwidth_hz);
  read(section, "carrier_loop_bandwidth_hz", above_to(0.0, 200.0), settings.carrier_loop_bandwidth_hz);
  read(section, "integration_s", above_to(0.0, 1.0), settings.integration_s);
  read(section, "acquisition_threshold_dbhz", from_to(0.0, 60.0), settings.acquisition_threshold_dbhz);
  read(section, "loss_threshold_dbhz", from_to(0.0, 60.0), settings.loss_threshold_dbhz);
  read(section, "cycle_slips_per_hour", from_to(0.0, 1e4), settings.cycle_slips_per_hour);
  read(section, "undetected_slip_fraction", from_to(0.0, 1.0), settings.undetected_slip_fraction);
  read(section, "code_bias_sigma_m", from_to(0.0, 100.0), settings.code_bias_sigma_m);
  read(section, "carrier_wander_sigma_mm", from_to(0.0, 100.0), settings.carrier_wander_sigma_mm);
  read(section, "carrier_wander_time_s", above_to(0.0, 1e6), settings.carrier_wander_time_s);
  settings.l1_code = section.choice<L1Code>("l1_code", kL1Codes, settings.l1_code);
  read(section, "w_code_rate_khz", from_to(0.0, 10230.0), settings.w_code_rate_khz);
  constexpr Range kWander_m = from_to(0.0, 100.0);
  read(section, "code_wander_l1_zenith_m", kWander_m, settings.code_wander_l1.zenith_m);
  read(section, "code_wander_l1_horizon_m", kWander_m, settings.code_wander_l1.horizon_m);
  read(section, "code_wander_l2_zenith_m", kWander_m, settings.code_wander_l2.zenith_m);
  read(section, "code_wander_l2_horizon_m", kWander_m, settings.code_wander_l2.horizon_m);
  read(section, "code_wander_time_s", above_to(0.0, 1e6), settings.code_wander_time_s);
}

void read_start(const TableReader& section, twins::gnss::StartSettings& settings) {
  settings.mode = section.choice<StartMode>("mode", kStartModes, settings.mode);
  constexpr Range kDelay_s = from_to(0.0, 3600.0);
  read(section, "cold_search_min_s", kDelay_s, settings.cold_search_min_s);
  read(section, "cold_search_max_s", kDelay_s, settings.cold_search_max_s);
  read(section, "reacquisition_min_s", kDelay_s, settings.reacquisition_min_s);
  read(section, "reacquisition_max_s", kDelay_s, settings.reacquisition_max_s);
  read(section, "ephemeris_decoding_s", kDelay_s, settings.ephemeris_decoding_s);
}

void read_receiver_clock(const TableReader& section, twins::gnss::ClockSettings& settings) {
  read(section, "initial_offset_ms", from_to(0.0, 1e3), settings.initial_offset_ms);
  read(section, "initial_drift_sigma_ns_per_s", from_to(0.0, 1e5), settings.initial_drift_sigma_ns_per_s);
  read(section, "h0_s", from_to(0.0, 1e-15), settings.h0_s);
  read(section, "h_minus2_per_s", from_to(0.0, 1e-15), settings.h_minus2_per_s);
  read(section, "jump_threshold_ms", from_to(0.5, 1e6), settings.jump_threshold_ms);
}

void read_body_frame(const TableReader& section, twins::gnss::BodyFrameSettings& settings) {
  read_vector(section, "antenna_in_body_m", from_to(-50.0, 50.0), settings.antenna_in_body_m);
  read_vector(section, "boresight_in_body", from_to(-1.0, 1.0), settings.boresight_in_body);
  read(section, "com_radius_mm", from_to(0.0, 1e3), settings.com_radius_mm);
  read(section, "pco_bias_mm", from_to(0.0, 1e3), settings.pco_bias_mm);
  read(section, "pco_noise_mm", from_to(0.0, 1e3), settings.pco_noise_mm);
  read(section, "antenna_direction_arcsec", from_to(0.0, 1e5), settings.antenna_direction_arcsec);
  read(section, "attitude_knowledge_arcsec", from_to(0.0, 1e5), settings.attitude_knowledge_arcsec);
}

void read_line(const TableReader& section, double period_s, testbeds::ReceiverLine& line) {
  line.port = section.text("port", line.port);
  line.baud = static_cast<int>(section.integer("baud", 2400, 460800, line.baud));
  line.wired = section.choice<testbeds::Wiring>("wired", kWirings, line.wired);
  const double latest_s = std::max(0.0, period_s - 0.1);
  line.log_offset_s = section.number("log_offset_s", from_to(0.0, latest_s), std::min(line.log_offset_s, latest_s));
  line.clock_adjust = section.flag("clock_adjust", line.clock_adjust);
  read(section, "max_latency_s", above_to(0.0, 60.0), line.max_latency_s);
}

constexpr Names<bool, 2> kStrengths{{{"dbhz", false}, {"amplitude", true}}};

/// Three observation types: code, carrier phase, signal strength.
void read_types(const TableReader& section, std::string_view key, std::optional<twins::gnss::SignalTypes>& types) {
  const std::vector<std::string> names = section.texts(key);
  if (names.empty()) return;
  if (names.size() != 3) section.refuse_value(key, "three types: code, carrier phase, signal strength");
  types = twins::gnss::SignalTypes{names[0], names[1], names[2]};
}

/// Files of a receiver of source "rinex".
void read_recording(const TableReader& section, bool is_used, const mission::Mission& mission,
                    twins::gnss::RecordingSettings& recording) {
  constexpr std::array<std::string_view, 1> kNone{""};
  recording.observations = mission::data_file(section, "observations", "", mission, kNone);
  recording.navigation = mission::data_file(section, "navigation", "", mission, kNone);
  read_types(section, "l1", recording.l1);
  read_types(section, "l2", recording.l2);
  recording.uses_l2 = !section.flag("single_frequency", false);
  recording.corrects_code = section.flag("corrects_code", false);
  recording.strength_is_amplitude = section.choice<bool>("strength", kStrengths, false);
  if (recording.corrects_code && recording.uses_l2)
    section.refuse_value("corrects_code", "false, unless single_frequency is true: two frequencies need no correction");
  if (is_used && (recording.observations.empty() || recording.navigation.empty()))
    section.refuse(recording.observations.empty() ? "observations" : "navigation", "nothing",
                   "a RINEX file, as source is rinex");
  section.finish();
}

}  // namespace

std::shared_ptr<const mission::SensorSettings> read_gnss(const TableReader& section,
                                                         const mission::SensorContext& context) {
  auto sensor = std::make_shared<GnssSensor>();
  const std::vector<std::string>& names = context.spacecraft_names;
  mission::read_source(section, "digital", context, *sensor, kRinex);
  using Use = vbar::navigation_configuration;
  sensor->observed = section.text("partner", "");
  sensor->navigation = Use::kUseOwnGnss + (sensor->observed.empty() ? 0 : std::int32_t{Use::kUseCarrierPair});
  const bool is_known = std::find(names.begin(), names.end(), sensor->observed) != names.end();
  if (!sensor->observed.empty() && (!is_known || sensor->observed == context.spacecraft))
    section.refuse_value("partner", "another spacecraft: " + mission::listing_of({names.begin(), names.end()}));
  twins::gnss::GnssReceiverSettings& receiver = sensor->receiver;
  read(section, "period_s", from_to(0.1, 60.0), receiver.output.period_s);
  read(section, "ephemeris_period_s", from_to(1.0, 1e5), receiver.output.ephemeris_period_s);
  read(section, "corrections_period_s", from_to(1.0, 1e5), receiver.output.corrections_period_s);
  receiver.output.gps_ephemeris =
      section.choice<GpsEphemerisLog>("gps_ephemeris", kEphemerisLogs, receiver.output.gps_ephemeris);
  receiver.ionosphere = section.flag("ionosphere", receiver.ionosphere);
  read_line(section, receiver.output.period_s, sensor->line);
  read_visibility(section.table("visibility"), receiver.visibility);
  const TableReader link_budget = section.table("link_budget");
  read_link_budget(link_budget, receiver.link_budget);
  receiver.link_budget.antenna_pattern =
      mission::data_file(link_budget, "antenna_pattern", receiver.link_budget.antenna_pattern, context.mission);
  read_tracking(section.table("tracking"), receiver.tracking);
  read_start(section.table("start"), receiver.start);
  read_receiver_clock(section.table("clock"), receiver.clock);
  read_body_frame(section.table("body_frame"), receiver.body_frame);
  read_recording(section.table("recording"), sensor->source == kRinex, context.mission, sensor->recording);
  sensor->recording.tracking = receiver.tracking;
  sensor->recording.ephemeris_period_s = receiver.output.ephemeris_period_s;
  section.finish();
  try {
    twins::gnss::check(receiver);  // what depends on more than one key
  } catch (const std::invalid_argument& error) {
    section.refuse("", error.what(), "settings that fit together");
  }
  return sensor;
}

namespace {

void read_crosslink(const TableReader& section, GnssShared& shared) {
  constexpr double kHour_s = 3600.0;
  shared.crosslink_from = section.span("from_h", kHour_s, from_to(0.0, mission::kLongestMission_h), 0.0);
  twins::gnss::CrosslinkSettings& crosslink = shared.crosslink;
  if (section.has("latency")) crosslink.link.latency = mission::read_latency(section.table("latency"));
  read(section, "loss_probability", from_to(0.0, 1.0), crosslink.link.loss_probability);
  read(section, "silence_begin_s", from_to(0.0, 1e7), crosslink.silence_begin_s);
  read(section, "silence_duration_s", from_to(0.0, 1e7), crosslink.silence_duration_s);
  section.finish();
}

// Defaults: what the paper's Appendix A makes of each axis of an antenna (a vector of 5 mm of any direction, a ball of
// 3 mm).
void read_carrier_phase(const TableReader& section, vbar::carrier_configuration& carrier) {
  carrier.resolve_ambiguities = section.flag("resolve_ambiguities", true) ? 1 : 0;
  carrier.min_success_rate = section.number("success_rate_min", from_to(0.5, 1.0), 0.999);
  carrier.min_ratio = section.number("ratio_min", from_to(1.0, 1e3), 3.0);
  carrier.pair_wait_ns = section.span("pair_timeout_s", 1.0, from_to(0.1, 600.0), 12.0).ns;
  carrier.antenna_offset_sigma_m = 1e-3 * section.number("antenna_offset_sigma_mm", above_to(0.0, 1e3), 3.2);
  carrier.phase_centre_jitter_m = 1e-3 * section.number("phase_centre_jitter_mm", above_to(0.0, 100.0), 1.0);
  carrier.phase_wander_sigma_m = 1e-3 * section.number("phase_wander_sigma_mm", from_to(0.0, 100.0), 0.0);
  carrier.phase_wander_time_s = section.number("phase_wander_time_s", from_to(0.0, 1e6), 0.0);
  if (carrier.phase_wander_sigma_m > 0.0 && carrier.phase_wander_time_s == 0.0)
    section.refuse_value("phase_wander_time_s", "a number above 0 where phase_wander_sigma_mm is above 0");
  carrier.code_bias_sigma_m = section.number("code_bias_sigma_m", above_to(0.0, 100.0), 2.0);
  carrier.start_velocity_sigma = section.number("initial_velocity_sigma_mps", above_to(0.0, 100.0), 0.2);
  section.finish();
}

}  // namespace

std::shared_ptr<const mission::SharedSettings> read_gnss_shared(const TableReader& document,
                                                                const mission::Mission& mission) {
  auto shared = std::make_shared<GnssShared>();
  read_carrier_phase(document.table("navigation").table("carrier_phase"), shared->carrier);
  const TableReader constellation = document.table("constellation");
  shared->constellation.navigation_files = mission::data_files(constellation, "navigation_files", mission);
  read_constellation(constellation, shared->constellation);
  read_crosslink(document.table("links").table("crosslink"), *shared);
  return shared;
}

namespace {

using mission::find_settings;
using mission::Mission;
using mission::Sensor;
using mission::Spacecraft;

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

std::unique_ptr<twins::gnss::ReceiverBytes> make_recorded(const MakeContext& context, const Spacecraft& carrier) {
  auto receiver = std::make_unique<twins::gnss::RecordedReceiver>(find_settings<GnssSensor>(carrier)->recording,
                                                                  context.data_directory);
  context.data_notes.insert(context.data_notes.end(), receiver->notes().begin(), receiver->notes().end());
  return receiver;
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
  auto receiver = testbed != nullptr ? make_of_testbed(*testbed, context, carrier)
                  : source == kRinex ? make_recorded(context, carrier)
                                     : make_twin(context, carrier);
  sensor.period = receiver->call_period().value_or(
      fsw::nearest_duration(find_settings<GnssSensor>(carrier)->receiver.output.period_s));
  if (&carrier != &context.servicer) {
    // The partner's epochs are those of the servicer's receiver, whenever they begin. A device follows the motion from
    // the start, and is tracking when its data begin to be sent.
    const fsw::GpsTime from = mission.epoch + mission::shared_settings<GnssShared>(mission).crosslink_from;
    sensor.delivers_from = from;
    if (testbed == nullptr) sensor.start = twins::next_periodic_epoch(sensor.start, sensor.period, from);
  }
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
    // A recorded receiver may have a partner that is simulated, and the reverse.
    const std::string& carried = find_settings<GnssSensor>(carrier)->source;
    const std::string& own = source == kRinex || carried == kRinex ? carried : source;
    if (!packets) packets = make_receiver(context, own, carrier);
    sources.push_back({source_name(carrier, sensor), own, std::move(packets)});
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
