#include <algorithm>

#include <fmt/format.h>

#include "host_sim/report/html_page.h"
#include "host_sim/report/mission_views.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/verdict.h"

namespace vbar::report {
namespace {

std::string badge(const char* style, std::string_view word, const std::string& text, const char* text_style = "") {
  return fmt::format("<p><span class=\"status {}\">{}</span> <span class=\"{}\">{}</span></p>\n", style, escaped(word),
                     text_style, escaped(text));
}

std::string status(const Summary& s) {
  if (!s.complete) return badge("bad", "incomplete", s.incomplete_reason, "bad");
  // An older version of this program left no verdict.
  if (s.verdict_reason.empty())
    return badge(s.never_navigated ? "bad" : "good", s.never_navigated ? "never navigated" : "complete", "");
  const Outcome outcome = outcome_of(s.verdict);
  if (!is_favourable(outcome)) return badge("bad", s.verdict, s.verdict_reason, "bad");
  return badge(outcome == Outcome::kAchieved ? "good" : "caution", s.verdict, s.verdict_reason);
}

std::string tile(std::string_view value, std::string_view meaning) {
  return fmt::format("<div class=\"tile\"><b>{}</b><span>{}</span></div>\n", escaped(value), escaped(meaning));
}

std::string tiles(const RunRecord& record) {
  const Summary& s = record.summary;
  std::string out = "<div class=\"tiles\">\n";
  out += tile(measure_text(s.dv_mps, "m/s"), fmt::format("delta-v in {} maneuvers", s.maneuvers));
  const std::vector<WaypointRow> reached = reached_waypoints(record);
  if (!reached.empty()) {
    const WaypointRow& last = reached.back();
    out += tile(measure_text(last.control_error_m, "m"), fmt::format("control error at waypoint {}", last.index));
    const auto worst = std::ranges::max_element(reached, {}, &WaypointRow::control_error_m);
    out += tile(measure_text(worst->control_error_m, "m"),
                fmt::format("largest control error (waypoint {})", worst->index));
  }
  if (s.navigation_error_m) out += tile(measure_text(s.navigation_error_m->mean, "m"), "mean navigation error");
  out += tile(duration_text(s.simulated_s), fmt::format("simulated in {}", duration_text(s.wall_s)));
  out += tile(fmt::format("{}×", grouped_nearest(s.speed_factor)), "real time");
  return out + "</div>\n";
}

std::string or_none(const std::string& text) {
  return text.empty() ? "none" : text;
}

/// Appends nothing for a folder of an older version, which has no provenance.
void append_provenance(const Provenance& provenance, std::vector<Fact>& facts) {
  if (provenance.vbar_version.empty()) return;
  facts.push_back({"vbar", fmt::format("{}, commit {}", provenance.vbar_version, or_none(provenance.commit))});
  facts.push_back({"build", fmt::format("{}, {}", provenance.compiler, provenance.build_type)});
  facts.push_back({"host", provenance.host});
  facts.push_back({"started, UTC", provenance.started_utc});
  facts.push_back({"mission epoch, UTC", provenance.epoch_utc});
  facts.push_back({"overrides", or_none(fmt::format("{}", fmt::join(provenance.overrides, ", ")))});
}

}  // namespace

std::string overview(const RunRecord& record) {
  const Summary& s = record.summary;
  std::string out = fmt::format("<h1>{}</h1>\n<p class=\"lead\">seed {}, flown on {}</p>\n", escaped(s.mission), s.seed,
                                escaped(s.flight_computer));
  out += status(s);
  out += tiles(record);
  std::vector<Fact> facts{{"flight computer", s.flight_computer},
                          {"flight software", s.flight_software},
                          {"navigation", or_none(s.navigation)},
                          {"camera", or_none(s.camera)},
                          {"GNSS", or_none(s.gnss)},
                          {"seed", std::to_string(s.seed)},
                          {"commands SHA-256", s.commands_sha256},
                          {"telemetry SHA-256", s.telemetry_sha256}};
  for (const std::string& note : s.data_notes) facts.push_back({"data", note, true});
  append_provenance(s.provenance, facts);
  for (const SourceFigures& source : s.sources)
    if (source.name == "truth")
      facts.push_back({"truth", fmt::format("of testbed {}, {} answers", source.kind, source.epochs)});
  for (const SourceFigures& source : s.sources)
    if (source.failures > 0)
      facts.push_back({"failures of " + source.name, fmt::format("{} of {} epochs; the last: {}", source.failures,
                                                                 source.epochs, source.last_failure)});
  for (const SourceFigures& source : s.sources)
    if (source.packets_rejected > 0)
      facts.push_back({"packets of " + source.name,
                       fmt::format("{} of impossible times or values were rejected", source.packets_rejected), true});
  return out + fact_list(facts) + "<p class=\"files\">Data: <a href=\"summary.json\">summary.json</a></p>\n";
}

}  // namespace vbar::report
