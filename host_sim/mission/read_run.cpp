#include <algorithm>

#include "host_sim/mission/names.h"
#include "host_sim/mission/read_gnss.h"
#include "host_sim/mission/read_sections.h"

namespace vbar::mission {
namespace {

using engine::LatencyDistribution;
using engine::LatencyKind;

// Longest simulated latency, s: a link slower than an hour is an error of the file.
constexpr double kLongestLatency_s = 3600.0;

LatencyDistribution read_latency(const TableReader& section) {
  LatencyDistribution latency;
  latency.kind = section.choice<LatencyKind>("distribution", kLatencyKinds, LatencyKind::kConstant);
  const auto read_limits = [&] {
    latency.minimum_s = section.number("minimum_s", from_to(0.0, kLongestLatency_s), 0.0);
    latency.maximum_s = section.number("maximum_s", above_to(0.0, kLongestLatency_s));
    if (latency.maximum_s <= latency.minimum_s) section.refuse_value("maximum_s", "a number above minimum_s");
  };
  switch (latency.kind) {
    case LatencyKind::kConstant:
      section.accept_only({"distribution", "latency_s"});
      latency.mean_s = section.number("latency_s", from_to(0.0, kLongestLatency_s), 0.0);
      break;
    case LatencyKind::kUniform:
      section.accept_only({"distribution", "minimum_s", "maximum_s"});
      read_limits();
      break;
    case LatencyKind::kNormal:
      section.accept_only({"distribution", "mean_s", "standard_deviation_s", "minimum_s", "maximum_s"});
      latency.mean_s = section.number("mean_s", from_to(0.0, kLongestLatency_s));
      latency.standard_deviation_s = section.number("standard_deviation_s", above_to(0.0, kLongestLatency_s));
      read_limits();
      break;
    case LatencyKind::kExponential:
      section.accept_only({"distribution", "mean_s", "minimum_s"});
      latency.mean_s = section.number("mean_s", above_to(0.0, kLongestLatency_s));
      latency.minimum_s = section.number("minimum_s", from_to(0.0, kLongestLatency_s), 0.0);
      if (latency.minimum_s >= latency.mean_s) section.refuse_value("minimum_s", "a number below mean_s");
      break;
  }
  return latency;
}

}  // namespace

void read_clock(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("clock");
  section.accept_only({"mode", "speed_factor", "compute_budget_s", "link_budget_s", "wake_tolerance_ms"});
  engine::ClockSettings& clock = mission.clock;
  clock.mode = section.choice<engine::ClockMode>("mode", kClockModes, engine::ClockMode::kLockStep);
  clock.speed_factor = section.number("speed_factor", from_to(1e-3, 1e6), 1.0);
  // What the run assumes: outputs take effect after the compute latency, and a step is over before the next one.
  clock.compute_budget = section.span("compute_budget_s", 1.0, above_to(0.0, 3600.0),
                                      std::max(1e-3, fsw::seconds(mission.guidance.compute_latency)));
  clock.link_budget = section.span("link_budget_s", 1.0, above_to(0.0, 3600.0), fsw::seconds(mission.step));
  const double tolerance_ms = section.number("wake_tolerance_ms", from_to(0.0, 1e4), 2.0);
  clock.wake_tolerance = engine::WallClock::Span(static_cast<std::int64_t>(tolerance_ms * 1e6));
}

void read_links(const TableReader& document, Mission& mission) {
  const TableReader links = document.table("links");
  links.accept_only({"board", "crosslink"});
  const TableReader board = links.table("board");
  board.accept_only({"latency", "loss_probability"});
  mission.board_link.latency = read_latency(board.table("latency"));
  mission.board_link.loss_probability = board.number("loss_probability", from_to(0.0, 1.0), 0.0);
  const TableReader crosslink = links.table("crosslink");
  crosslink.accept_only({"latency", "loss_probability", "silence_begin_s", "silence_duration_s"});
  if (crosslink.has("latency")) mission.crosslink.link.latency = read_latency(crosslink.table("latency"));
  mission.crosslink.link.loss_probability =
      crosslink.number("loss_probability", from_to(0.0, 1.0), mission.crosslink.link.loss_probability);
  read_crosslink_silence(crosslink, mission);
}

void read_lcm(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("lcm");
  section.accept_only({"mirror", "url"});
  mission.lcm.mirror = section.flag("mirror", false);
  // Time to live 0: the packets do not leave this computer.
  mission.lcm.url = section.text("url", "udpm://239.255.76.67:7667?ttl=0");
  if (mission.lcm.url.find("://") == std::string::npos)
    section.refuse_value("url", "an LCM provider, e.g. udpm://239.255.76.67:7667?ttl=0");
}

void read_record(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("record");
  section.accept_only({"images"});
  mission.record.images = section.choice<ImagesInLog>("images", kImagesInLog, ImagesInLog::kRecipes);
}

}  // namespace vbar::mission
