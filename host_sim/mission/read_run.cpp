#include <algorithm>
#include <stdexcept>

#include "host_sim/mission/names.h"
#include "host_sim/mission/read_sections.h"

namespace vbar::mission {
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

}  // namespace vbar::mission
