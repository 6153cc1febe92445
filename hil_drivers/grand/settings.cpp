#include "hil_drivers/grand/settings.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "hil_drivers/grand/pps/edge_source.h"
#include "host_sim/mission/names.h"

namespace vbar::grand {
namespace {

using mission::from_to;
using mission::TableReader;

constexpr mission::Names<Pace, 2> kPaces{{{"lock_step", Pace::kLockStep}, {"real_time", Pace::kRealTime}}};

void read_generator(const TableReader& section, GrandSettings& settings) {
  const auto kinds = generator_kinds();
  std::vector<std::string_view> names;
  for (const GeneratorKind* const kind : kinds) names.push_back(kind->name);
  const std::string name = section.choice("generator", names, names.front());
  settings.generator = *std::ranges::find(kinds, name, &GeneratorKind::name);
  // Tables of the other generators may stand in the file: a mission is switched between them by one key.
  for (const GeneratorKind* const kind : kinds) {
    if (kind != settings.generator && !section.has(kind->name)) continue;
    auto read = kind->read(section.table(kind->name));
    if (kind == settings.generator) settings.generator_settings = std::move(read);
  }
}

void read_edges(const TableReader& section, GrandSettings& settings) {
  settings.pps = section.text("pps", "none");
  const bool is_of_bench = settings.pps == kEdgesOfBench && !settings.bench.empty();
  if (settings.pps != "none" && !is_of_bench && find_edge_source(settings.pps) == nullptr)
    section.refuse_value("pps", "none, " + edge_source_forms() + " or, with a bench, " + kEdgesOfBench);
  if (settings.pace == Pace::kLockStep && settings.pps != "none")
    section.refuse_value("pps", "none, as pace is lock_step: simulated time waits for the generator");
  settings.chrony = section.text("chrony", "");
  if (!settings.chrony.empty() && settings.pps == "none")
    section.refuse_value("chrony", "nothing, as pps is none: there are no edges to forward");
}

}  // namespace

std::shared_ptr<const mission::TestbedSettings> read_grand(const TableReader& section) {
  auto settings = std::make_shared<GrandSettings>();
  read_generator(section, *settings);
  settings->bench = section.text("bench", "");
  settings->host = section.text("host", settings->host);
  const bool is_required = settings->bench.empty();
  settings->control_port = static_cast<std::uint16_t>(
      section.integer("control_port", is_required ? 1 : 0, 65534, is_required ? std::nullopt : std::optional(0)));
  settings->hil_port = static_cast<std::uint16_t>(section.integer("hil_port", 0, 65535, 0));
  // Samples lie on whole milliseconds, and one lies on every second.
  constexpr std::array<std::int64_t, 8> kRates{1, 2, 4, 5, 10, 20, 25, 50};
  const std::int64_t rate_hz = section.integer("rate_hz", 1, 50, 10);
  if (std::ranges::find(kRates, rate_hz) == kRates.end())
    section.refuse_value("rate_hz", "1, 2, 4, 5, 10, 20, 25 or 50");
  settings->sample_period = fsw::Duration{fsw::kNanosecondsPerSecond / rate_hz};
  settings->pace = section.choice<Pace>("pace", kPaces, Pace::kLockStep);
  settings->lead = section.span("lead_ms", 1e-3, from_to(0.0, 1000.0), 0.0);
  if (settings->pace == Pace::kLockStep && settings->lead.ns != 0)
    section.refuse_value("lead_ms", "0, as pace is lock_step: the generator waits for its samples");
  settings->join = section.span("join_ms", 1e-3, from_to(0.0, 10000.0), 165.0);
  read_edges(section, *settings);
  settings->give_up = section.span("give_up_s", 1.0, from_to(1.0, 1e6), 300.0);
  settings->week_shift = section.flag("week_shift", false);
  section.finish();
  return settings;
}

}  // namespace vbar::grand
