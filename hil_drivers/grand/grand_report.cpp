#include "hil_drivers/grand/grand_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hil_drivers/common/testbed_facts.h"
#include "host_sim/report/sections/sections.h"
#include "host_sim/report/statistics.h"

namespace vbar::grand {
namespace {

using report::Mark;
using report::Plot;
using report::RunRecord;
using report::TestbedFigures;
using report::Unit;

constexpr const char* kName = "grand";

void add_latency(std::vector<double> latencies_s, TestbedFigures& figures) {
  if (latencies_s.empty()) return;
  std::ranges::sort(latencies_s);
  figures["latency_median_s"] = report::quantile(latencies_s, 0.5);
  figures["latency_95_percent_s"] = report::quantile(latencies_s, 0.95);
  figures["latency_worst_s"] = latencies_s.back();
}

void add_receiver(const std::string& spacecraft, const LinkStatistics& link, TestbedFigures& figures) {
  const auto set = [&](const char* name, double value) { figures[spacecraft + "_" + name] = value; };
  set("bytes", static_cast<double>(link.bytes));
  set("epochs", static_cast<double>(link.epochs));
  set("losses", static_cast<double>(link.losses));
  set("reconnects", static_cast<double>(link.reconnects));
  set("lost_s", link.lost_s);
  set("messages", static_cast<double>(link.stream.messages));
  set("bytes_outside_messages",
      static_cast<double>(link.stream.bytes) - static_cast<double>(link.stream.message_bytes));
  set("bad_checksums", static_cast<double>(link.stream.bad_checksum));
  set("week_shift_weeks", link.week_shift);
}

void add_edges(const EdgeStatistics& edges, TestbedFigures& figures) {
  figures["edges"] = static_cast<double>(edges.edges);
  figures["edges_used"] = static_cast<double>(edges.used);
  figures["edges_doubled"] = static_cast<double>(edges.doubled);
  figures["edges_rejected"] = static_cast<double>(edges.rejected);
  figures["edges_missing"] = static_cast<double>(edges.missing);
  figures["edge_jumps"] = static_cast<double>(edges.jumps);
  figures["pps_jitter_ms"] = 1e3 * edges.jitter_s;
  std::vector<double> apart_s;
  for (const double s : edges.host_minus_edge_s) apart_s.push_back(std::abs(s));
  if (apart_s.empty()) return;
  std::ranges::sort(apart_s);
  figures["host_minus_edge_95_percent_ms"] = 1e3 * report::quantile(apart_s, 0.95);
  figures["host_minus_edge_worst_ms"] = 1e3 * apart_s.back();
}

Plot plot_of(const RunRecord& record, const report::View& view, const char* title, const char* quantity,
             std::optional<double> ReceiverSecond::*value) {
  Plot plot = report::time_plot(view, title, quantity, Unit::kNone);
  const auto& rows = record.tables.rows<GrandRow>();
  const auto points = [&](ReceiverSecond GrandRow::*receiver) {
    std::vector<report::Point> all;
    for (const GrandRow& row : rows)
      if (view.holds(row.time_s) && (row.*receiver.*value))
        all.push_back({report::hours(row.time_s), *(row.*receiver.*value)});
    return all;
  };
  plot.series = {{"servicer", 0, Mark::kDots, points(&GrandRow::servicer)},
                 {"target", 1, Mark::kDots, points(&GrandRow::target)}};
  return plot;
}

Plot signal_plot(const RunRecord& record, const report::View& view) {
  Plot plot = report::time_plot(view, "Signals tracked at the last epoch", "signals", Unit::kNone);
  const auto& rows = record.tables.rows<GrandRow>();
  const auto points = [&](ReceiverSecond GrandRow::*receiver) {
    return report::over_time(rows, view,
                             [&](const GrandRow& row) { return static_cast<double>((row.*receiver).tracked_signals); });
  };
  plot.series = {{"servicer", 0, Mark::kLine, points(&GrandRow::servicer)},
                 {"target", 1, Mark::kLine, points(&GrandRow::target)}};
  return plot;
}

Plot lead_plot(const RunRecord& record, const report::View& view) {
  Plot plot = report::time_plot(view, "Lead of the samples, and host minus edges", "time (ms)", Unit::kNone);
  const auto& rows = record.tables.rows<GrandRow>();
  const auto points = [&](std::optional<double> GrandRow::*value) {
    return report::over_time(rows, view, [&](const GrandRow& row) { return (row.*value).value_or(std::nan("")); });
  };
  plot.series = {{"minimum lead in a second", 0, Mark::kDots, points(&GrandRow::sample_lead_min_ms)},
                 {"host minus edge", 1, Mark::kDots, points(&GrandRow::host_minus_edge_ms)}};
  return plot;
}

}  // namespace

std::vector<report::TableKind> tables() {
  return {report::table_of_extension<GrandRow>("grand.csv")};
}

void add_figures(const RunFigures& run, RunRecord& record) {
  TestbedFigures& figures = record.summary.testbeds[kName];
  figures["pace"] = std::string(run.pace == Pace::kLockStep ? "lock_step" : "real_time");
  figures["bench"] = std::string(run.is_emulated ? "emulated" : "hardware");
  figures["generator"] = std::string(run.generator);
  std::vector<double> latencies_s;
  double reconnects = 0.0, losses = 0.0;
  for (const auto& [spacecraft, link] : run.receivers) {
    add_receiver(spacecraft, link, figures);
    latencies_s.insert(latencies_s.end(), link.latencies_s.begin(), link.latencies_s.end());
    reconnects += static_cast<double>(link.reconnects);
    losses += static_cast<double>(link.losses);
  }
  figures["reconnects"] = reconnects;
  figures["losses"] = losses;
  add_latency(std::move(latencies_s), figures);
  for (const auto& [kind, count] : run.faults) figures["faults_" + kind] = static_cast<double>(count);
  for (const auto& [name, value] : run.generator_counters) figures["generator_" + name] = value;
  if (run.edges) add_edges(*run.edges, figures);
  for (const report::FileDigest& file : run.bench_files) record.summary.provenance.testbed.push_back(file);
}

void summarise(const RunRecord& record, report::Summary& summary) {
  const auto& rows = record.tables.rows<GrandRow>();
  if (rows.empty()) return;
  TestbedFigures& figures = summary.testbeds[kName];
  double samples = 0.0, late = 0.0, missing = 0.0, snaps = 0.0, not_deterministic = 0.0;
  std::optional<double> lead_min_ms;
  for (const GrandRow& row : rows) {
    samples += static_cast<double>(row.samples);
    late += static_cast<double>(row.samples_late);
    missing += static_cast<double>(row.samples_missing);
    snaps += row.extrapolation == static_cast<double>(Extrapolation::kSnap) ? 1.0 : 0.0;
    not_deterministic += row.extrapolation == static_cast<double>(Extrapolation::kNonDeterministic) ? 1.0 : 0.0;
    if (row.sample_lead_min_ms)
      lead_min_ms = std::min(lead_min_ms.value_or(*row.sample_lead_min_ms), *row.sample_lead_min_ms);
  }
  figures["samples"] = samples;
  figures["samples_late"] = late;
  figures["samples_missing"] = missing;
  figures["seconds_with_snap"] = snaps;
  figures["seconds_extrapolated"] = not_deterministic;
  if (lead_min_ms) figures["sample_lead_min_ms"] = *lead_min_ms;
}

std::vector<report::Section> sections(const RunRecord& record) {
  const auto found = record.summary.testbeds.find(kName);
  if (found == record.summary.testbeds.end()) return {};
  const TestbedFigures& figures = found->second;
  const bool is_emulated = testbeds::text_of(figures, "bench") == "emulated";
  std::string content = fmt::format(
      "<p class=\"note\">{}</p>\n",
      is_emulated ? "The receivers and the RF generator of this run were an emulated bench: another process that uses "
                    "the wire protocols of the hardware. No hardware was used."
                  : "No bench process was started by this run: generator and receivers are those at the addresses of "
                    "the mission.");
  content += report::fact_list(testbeds::facts_of(figures));
  if (!record.tables.rows<GrandRow>().empty()) {
    const report::View view = report::whole_run(record);
    content += report::plot_rows(
        2, {signal_plot(record, view),
            plot_of(record, view, "From an epoch to its last byte", "latency (s)", &ReceiverSecond::latency_s),
            lead_plot(record, view)});
  }
  return {{"GNSS testbed", content, {"grand.csv"}}};
}

}  // namespace vbar::grand
