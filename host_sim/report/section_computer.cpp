#include <fmt/format.h>

#include "host_sim/report/html_page.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/section_parts.h"

namespace vbar::report {
namespace {

std::string step_cost(const RunRecord& record) {
  const Summary::FlightStep& step = record.summary.flight_step;
  if (step.unit == "none" || step.max == 0) {
    return fmt::format("<p>{} flight steps; this flight computer cannot count what a step costs.</p>\n",
                       grouped(step.count));
  }
  const View whole = whole_run(record);
  Plot plot;
  plot.title = fmt::format("{} of each flight step", step.unit);
  plot.x = time_axis(whole);
  plot.y = {.name = step.unit};
  plot.y.range = Range{0.0, 1.05 * static_cast<double>(step.max)};
  plot.width = 1190.0;
  plot.height = 240.0;
  plot.moments = waypoint_moments(whole);
  plot.series = {{step.unit, 0, Mark::kDots, over_time(record.estimates, whole, [](const EstimateRow& r) {
                    return static_cast<double>(r.step_cost);
                  })}};
  return fmt::format("<p>{} flight steps: at most {}, on average {} {}; at most {} bytes of stack.</p>\n",
                     grouped(step.count), grouped(step.max), grouped_nearest(step.mean), step.unit,
                     grouped(step.stack_bytes_max)) +
         figures(1, {svg(plot)});
}

std::string share_of_step(const Summary::Link& link) {
  if (link.baud == 0) return "–";
  return fmt::format("at most {} %, on average {} % at {} baud", fixed(100.0 * link.step_share_max, 2),
                     fixed(100.0 * link.step_share_mean, 2), grouped(static_cast<std::uint64_t>(link.baud)));
}

std::string share(double seconds, double wall_s) {
  return wall_s > 0.0 ? fmt::format("{} s ({} %)", fixed(seconds, 2), fixed(100.0 * seconds / wall_s, 1))
                      : fixed(seconds, 2) + " s";
}

}  // namespace

std::string computer_section(const RunRecord& record) {
  const Summary& s = record.summary;
  std::vector<Fact> facts{
      {"bytes on the link", grouped(s.link.bytes)},
      {"share of a step on the line", share_of_step(s.link)},
      {"frames sent again", grouped(s.link.frames_resent)},
      {"frames rejected", grouped(s.link.frames_rejected)},
      {"frames duplicated", grouped(s.link.frames_duplicated)},
      {"strangers ignored", grouped(s.link.strangers_ignored)},
      {"steps late", grouped(s.deadlines.compute_overruns)},
      {"wake-ups late", grouped(s.deadlines.wakeups_late)},
      {"link late", grouped(s.deadlines.link_late)},
      {"simulation late", grouped(s.deadlines.simulation_late)},
      {"wall clock: truth", share(s.wall_share.truth_s, s.wall_s)},
      {"wall clock: flight computer", share(s.wall_share.flight_s, s.wall_s)},
      {"wall clock: link", share(s.wall_share.link_s, s.wall_s)},
      {"wall clock: elsewhere", share(s.wall_share.other_s, s.wall_s)},
  };
  if (!s.camera.empty()) {
    facts.push_back({"camera's own thread: rendering", share(s.wall_share.render_s, s.wall_s)});
    facts.push_back({"camera's own thread: detector", share(s.wall_share.detector_s, s.wall_s)});
    facts.push_back({"camera's own thread: packing", share(s.wall_share.packing_s, s.wall_s)});
  }
  return section("Flight computer, link and time", step_cost(record) + fact_list(facts));
}

}  // namespace vbar::report
