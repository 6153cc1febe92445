#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <stdexcept>
#include <string_view>

#include "host_sim/mission/data_file.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/mission_document.h"
#include "host_sim/mission/read_sections.h"
#include "host_sim/mission/sensor_reader.h"
#include "host_sim/mission/toml_file.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::mission {

namespace {

fsw::GpsTime read_epoch(const TableReader& section) {
  // Default: the paper's initial epoch.
  const std::string text = section.text("epoch_utc", "2011-07-18T01:00:00Z");
  try {
    return truth::gps_from_utc(text);
  } catch (const std::invalid_argument&) {
    section.refuse_value("epoch_utc", "a UTC time like 2011-07-18T01:00:00Z, from 1980-01-06 to the year 2200");
  }
}

}  // namespace

void read_general(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("mission");
  mission.name = section.name("name", name_of_file(mission.file));
  mission.description = section.text("description", "");
  mission.epoch = read_epoch(section);
  mission.start = section.span("start_h", kHour_s, from_to(0.0, kLongestMission_h), 0.0);
  mission.duration = section.span("duration_h", kHour_s, above_to(0.0, kLongestMission_h));
  mission.step = read_cadence(section, "step_s", from_to(1e-3, 3600.0), mission, fsw::duration_of_seconds(60));
  if (mission.step.parts().front().from > mission.start_time())
    section.refuse_value("step_s", "a first period that holds from the start of the mission on");
  constexpr std::int64_t kLargestSeed = std::numeric_limits<std::int64_t>::max();
  mission.seed = static_cast<std::uint64_t>(section.integer("seed", 0, kLargestSeed, 1));
  section.finish();
}

namespace {

/// A force that acts if its key is true; the default is the truth model of the paper.
truth::ForceModel read_forces(const TableReader& section) {
  truth::ForceModel forces;
  forces.drag = section.flag("drag", forces.drag);
  forces.geomagnetic_index =
      section.choice<truth::GeomagneticIndex>("geomagnetic_index", kGeomagneticIndices, forces.geomagnetic_index);
  forces.radiation_pressure = section.flag("radiation_pressure", forces.radiation_pressure);
  forces.shadow = section.choice<truth::Shadow>("shadow", kShadows, forces.shadow);
  forces.sun = section.flag("sun", forces.sun);
  forces.moon = section.flag("moon", forces.moon);
  forces.solid_tides = section.flag("solid_tides", forces.solid_tides);
  forces.relativity = section.flag("relativity", forces.relativity);
  return forces;
}

/// The truth model, or a testbed of the mission that supplies the truth.
std::string read_truth_source(const TableReader& section, const TableReader& document,
                              const Installation& installation) {
  std::vector<std::string_view> accepted{kTruthModel};
  for (const TestbedReader* const testbed : installation.testbeds)
    if (testbed->supplies_truth) accepted.push_back(testbed->name);
  const std::string source = section.choice("source", accepted, kTruthModel);
  if (source != kTruthModel && !document.table("testbed").has(source))
    section.refuse_value("source", "model, as the mission has no [testbed." + source + "]");
  return source;
}

}  // namespace

void read_truth(const TableReader& document, Mission& mission, const Installation& installation) {
  const TableReader section = document.table("truth");
  mission.truth_source = read_truth_source(section, document, installation);
  truth::TruthSettings& truth = mission.truth;
  truth.epoch = mission.epoch;
  truth.end = mission.end_time();
  // The degree of the gravity file is checked when it is read; 2190 is the degree of the largest ever published.
  truth.gravity_degree = static_cast<int>(section.integer("gravity_degree", 0, 2190, truth.gravity_degree));
  const int order = std::min(truth.gravity_order, truth.gravity_degree);
  truth.gravity_order = static_cast<int>(section.integer("gravity_order", 0, truth.gravity_degree, order));
  truth.forces = read_forces(section);
  truth.permanent_tide = section.flag("permanent_tide", truth.permanent_tide);
  if (truth.forces.solid_tides && !truth.permanent_tide)
    section.refuse_value("permanent_tide", "true, as truth.solid_tides contains the permanent tide");
  truth.tolerance = section.number(
      "relative_tolerance", from_to(truth::TruthSettings::kSmallestTolerance, truth::TruthSettings::kLargestTolerance),
      truth.tolerance);
  truth.threads = static_cast<int>(section.integer("threads", 1, 256, truth.threads));
  using Settings = truth::TruthSettings;
  constexpr std::array<std::string_view, 2> kOrientationWords{Settings::kBundled, Settings::kNone};
  constexpr std::array<std::string_view, 2> kWeatherWords{Settings::kBundled, Settings::kConstant};
  truth.gravity_file = data_file(section, "gravity_file", truth.gravity_file, mission);
  truth.earth_orientation_file =
      data_file(section, "earth_orientation_file", truth.earth_orientation_file, mission, kOrientationWords);
  truth.space_weather_file = data_file(section, "space_weather_file", truth.space_weather_file, mission, kWeatherWords);
  truth.constant_f107 = section.number("constant_f107", from_to(50.0, 400.0), truth.constant_f107);
  truth.constant_ap = section.number("constant_ap", from_to(0.0, 400.0), truth.constant_ap);
  truth.accept_predictions = section.flag("accept_predictions", truth.accept_predictions);
  section.finish();
}

namespace {

using engine::LatencyDistribution;
using engine::LatencyKind;

// Longest simulated latency, s: a higher latency is an error in the file.
constexpr double kLongestLatency_s = 3600.0;

}  // namespace

LatencyDistribution read_latency(const TableReader& section) {
  LatencyDistribution latency;
  latency.kind = section.choice<LatencyKind>("distribution", kLatencyKinds, LatencyKind::kConstant);
  const auto read_limits = [&] {
    latency.minimum_s = section.number("min_s", from_to(0.0, kLongestLatency_s), 0.0);
    latency.maximum_s = section.number("max_s", above_to(0.0, kLongestLatency_s));
    if (latency.maximum_s <= latency.minimum_s) section.refuse_value("max_s", "a number above min_s");
  };
  switch (latency.kind) {
    case LatencyKind::kConstant:
      latency.mean_s = section.number("latency_s", from_to(0.0, kLongestLatency_s), 0.0);
      break;
    case LatencyKind::kUniform:
      read_limits();
      break;
    case LatencyKind::kNormal:
      latency.mean_s = section.number("mean_s", from_to(0.0, kLongestLatency_s));
      latency.standard_deviation_s = section.number("sigma_s", above_to(0.0, kLongestLatency_s));
      read_limits();
      break;
    case LatencyKind::kExponential:
      latency.mean_s = section.number("mean_s", above_to(0.0, kLongestLatency_s));
      latency.minimum_s = section.number("min_s", from_to(0.0, kLongestLatency_s), 0.0);
      if (latency.minimum_s >= latency.mean_s) section.refuse_value("min_s", "a number below mean_s");
      break;
  }
  section.finish();
  return latency;
}

namespace {

const engine::WallClockSource* find_clock(std::string_view source, const Installation& installation) {
  const std::string_view name = source.substr(0, source.find(':'));
  const auto found = std::ranges::find_if(installation.clocks,
                                          [&](const engine::WallClockSource* clock) { return clock->name == name; });
  return found == installation.clocks.end() ? nullptr : *found;
}

}  // namespace

std::unique_ptr<engine::WallClock> make_wall_clock(const Mission& mission, const Installation& installation) {
  const std::string_view source = mission.clock_source;
  const std::size_t colon = source.find(':');
  const engine::WallClockSource* const clock = find_clock(source, installation);
  if (clock == nullptr) throw std::logic_error("clock source \"" + mission.clock_source + "\" is not registered");
  return clock->make(colon == std::string_view::npos ? std::string_view() : source.substr(colon + 1));
}

namespace {

struct RequiredClock {
  std::string testbed;
  engine::ClockMode mode;
};

/// What the testbeds of the mission require of its clock; the last one prevails, and the others are in conflict with
/// it.
std::vector<RequiredClock> clocks_required(const Mission& mission, const Installation& installation) {
  std::vector<RequiredClock> required;
  for (const Testbed& testbed : mission.testbeds) {
    const auto reader = std::ranges::find(installation.testbeds, testbed.name, &TestbedReader::name);
    if (reader == installation.testbeds.end() || (*reader)->clock_mode == nullptr) continue;
    if (const auto mode = (*reader)->clock_mode(*testbed.settings)) required.push_back({testbed.name, *mode});
  }
  return required;
}

std::string quoted_name(engine::ClockMode mode) {
  const auto found = std::ranges::find(kClockModes, mode, [](const auto& entry) { return entry.second; });
  return "\"" + std::string(found->first) + "\"";
}

/// The clock of a run with testbeds is theirs.
void check_clock(const TableReader& section, const engine::ClockSettings& clock,
                 const std::vector<RequiredClock>& required) {
  for (const RequiredClock& testbed : required) {
    if (clock.mode != testbed.mode)
      section.refuse("mode", quoted_name(clock.mode),
                     quoted_name(testbed.mode) + ", as testbed." + testbed.testbed + ".pace");
    if (clock.mode == engine::ClockMode::kRealTime && clock.speed_factor != 1.0)
      section.refuse_value("speed_factor", "1, as testbed." + testbed.testbed + " runs in real time");
  }
}

}  // namespace

void read_clock(const TableReader& document, Mission& mission, const Installation& installation) {
  const TableReader section = document.table("clock");
  engine::ClockSettings& clock = mission.clock;
  const std::vector<RequiredClock> required = clocks_required(mission, installation);
  clock.mode = section.choice<engine::ClockMode>(
      "mode", kClockModes, required.empty() ? engine::ClockMode::kLockStep : required.front().mode);
  clock.speed_factor = section.number("speed_factor", from_to(1e-3, 1e6), 1.0);
  check_clock(section, clock, required);
  // Assumptions of the run: outputs take effect after the compute latency, and a step is over before the next one.
  clock.compute_budget =
      section.span("compute_budget_s", 1.0, above_to(0.0, 3600.0),
                   std::max(1e-3, 1e-9 * static_cast<double>(mission.guidance.configuration.compute_latency_ns)));
  clock.link_budget =
      section.span("link_budget_s", 1.0, above_to(0.0, 3600.0), fsw::seconds(mission.step.shortest_period()));
  const double tolerance_ms = section.number("wake_tolerance_ms", from_to(0.0, 1e4), 2.0);
  if (installation.clocks.empty()) throw std::logic_error("the program has no clock source");
  mission.clock_source = section.text("source", std::string(installation.clocks.front()->name));
  if (find_clock(mission.clock_source, installation) == nullptr) {
    std::vector<std::string_view> names;
    for (const engine::WallClockSource* const source : installation.clocks) names.push_back(source->name);
    section.refuse_value("source", listing_of(names) + ", the clock sources that this program has");
  }
  section.finish();
  clock.wake_tolerance = engine::WallClock::Span(static_cast<std::int64_t>(tolerance_ms * 1e6));
}

void read_links(const TableReader& document, Mission& mission) {
  const TableReader links = document.table("links");
  const TableReader board = links.table("board");
  mission.board_link.latency = read_latency(board.table("latency"));
  mission.board_link.loss_probability = board.number("loss_probability", from_to(0.0, 1.0), 0.0);
  board.finish();
}

void read_lcm(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("lcm");
  mission.lcm.mirror = section.flag("mirror", false);
  // Time to live 0: the packets do not leave this computer.
  mission.lcm.url = section.text("url", "udpm://239.255.76.67:7667?ttl=0");
  if (mission.lcm.url.find("://") == std::string::npos)
    section.refuse_value("url", "an LCM provider, e.g. udpm://239.255.76.67:7667?ttl=0");
  section.finish();
}

void read_telemetry(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("telemetry");
  mission.telemetry.udp = read_udp_address(section, "udp");
  section.finish();
}

namespace {

constexpr std::size_t kMaxSamples = 1000;

void read_samples(const TableReader& section, Mission& mission) {
  if (!section.has("samples_h")) return;
  constexpr double kHour_s = 3600.0;
  std::vector<double> hours = section.numbers("samples_h", 0, kMaxSamples, from_to(0.0, kLongestMission_h));
  double previous_h = -1.0;
  for (const double hour : hours) {
    const fsw::GpsTime time = mission.epoch + fsw::nearest_duration(kHour_s * hour);
    if (hour <= previous_h || time < mission.start_time() || time > mission.end_time())
      section.refuse_value("samples_h", "times of the run, in hours after the epoch, ascending");
    previous_h = hour;
  }
  mission.record.samples_h = std::move(hours);
}

}  // namespace

void read_record(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("record");
  mission.record.images = section.choice<ImagesInLog>("images", kImagesInLog, ImagesInLog::kRecipes);
  mission.record.packets = section.flag("packets", true);
  mission.record.tables = section.flag("tables", true);
  read_samples(section, mission);
  section.finish();
}

namespace {

constexpr double kLargest = 1e300;

std::vector<Limit> limits_of(const TableReader& document) {
  std::vector<Limit> limits;
  std::set<std::string> keys;
  for (const TableReader& section : document.tables("limit")) {
    limits.push_back(read_limit(section));
    if (!keys.insert(limits.back().key).second)
      section.refuse_value("key", "a key that no other limit has: one limit holds both most and least");
  }
  return limits;
}

}  // namespace

Limit read_limit(const TableReader& section) {
  Limit limit;
  limit.key = section.text("key");
  if (section.has("most")) limit.most = section.number("most", from_to(-kLargest, kLargest));
  if (section.has("least")) limit.least = section.number("least", from_to(-kLargest, kLargest));
  if (!limit.most && !limit.least) section.refuse("", "neither most nor least", "at least one of them");
  section.finish();
  if (limit.most && limit.least && *limit.least > *limit.most)
    section.refuse_value("least", "a number that is not above most");
  return limit;
}

void read_limits(const TableReader& document, Mission& mission) {
  mission.limits = limits_of(document);
}

std::vector<Limit> load_limits(const std::filesystem::path& file, std::span<const std::string> overrides) {
  toml::table table = parse_toml(read_text_file(file, "a mission file (TOML)"), file.string());
  put_over_extended(table, file);
  for (const std::string& assignment : overrides) apply_override(table, assignment);
  return limits_of(TableReader(table, file.string()));
}

}  // namespace vbar::mission
