#include "hil_drivers/optical_stimulator/stimulator_report.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "hil_drivers/common/testbed_facts.h"
#include "host_sim/report/sections/sections.h"
#include "host_sim/report/statistics.h"

namespace vbar::optical_stimulator {
namespace {

using report::Mark;
using report::Plot;
using report::RunRecord;
using report::TestbedFigures;
using report::Unit;

constexpr const char* kName = "optical_stimulator";

/// The waits of an image, in the order in which they follow each other.
struct Wait {
  const char* name;
  const char* figure;  // key of the summary
  double StimulatorRow::*value_s;
};
constexpr std::array<Wait, 3> kWaits{{{"render", "render", &StimulatorRow::render_s},
                                      {"show", "show", &StimulatorRow::show_s},
                                      {"expose and receive", "receive", &StimulatorRow::receive_s}}};

std::vector<double> sorted_values(const std::vector<StimulatorRow>& rows, double StimulatorRow::*value) {
  std::vector<double> values;
  for (const StimulatorRow& row : rows) values.push_back(row.*value);
  std::ranges::sort(values);
  return values;
}

/// Wall clock by its parts: of an image, and of the whole run.
std::string wall_clock_table(const RunRecord& record) {
  const auto& rows = record.tables.rows<StimulatorRow>();
  const auto& share = record.summary.wall_share;
  std::vector<std::vector<std::string>> cells;
  for (const Wait& wait : kWaits) {
    const std::vector<double> values = sorted_values(rows, wait.value_s);
    cells.push_back({wait.name, fmt::format("{:.1f}", 1e3 * report::quantile(values, 0.5)),
                     fmt::format("{:.1f}", 1e3 * report::quantile(values, 0.95)),
                     fmt::format("{:.1f}", 1e3 * values.back()),
                     fmt::format("{:.1f}", std::accumulate(values.begin(), values.end(), 0.0))});
  }
  for (const auto& [name, total_s] : {std::pair{"flight software", share.flight_s}, std::pair{"truth", share.truth_s},
                                      std::pair{"whole run", record.summary.wall_s}})
    cells.push_back({name, "", "", "", fmt::format("{:.1f}", total_s)});
  return report::table({{"wall clock"}, {"median (ms)"}, {"95 % (ms)"}, {"longest (ms)"}, {"sum (s)"}}, cells);
}

Plot plot_of(const RunRecord& record, const report::View& view, const char* title, const char* quantity,
             double StimulatorRow::*value) {
  Plot plot = report::time_plot(view, title, quantity, Unit::kNone);
  plot.series = {{quantity, 0, Mark::kDots,
                  report::over_time(record.tables.rows<StimulatorRow>(), view,
                                    [&](const StimulatorRow& row) { return row.*value; })}};
  return plot;
}

}  // namespace

std::vector<report::TableKind> tables() {
  return {report::table_of_extension<StimulatorRow>("bench.csv")};
}

void add_figures(const RunFigures& run, RunRecord& record) {
  TestbedFigures& figures = record.summary.testbeds[kName];
  figures["bench"] = std::string(run.devices.is_emulated ? "emulated" : "hardware");
  figures["camera"] = run.devices.vendor + " " + run.devices.model;
  figures["camera_serial"] = run.devices.serial;
  figures["calibration"] = run.calibration_file.string();
  if (run.calibration != nullptr) {
    const StimulatorCalibration& calibration = *run.calibration;
    figures["calibration_date_utc"] = calibration.validity.date_utc;
    figures["calibration_residual_arcsec"] = calibration.held_out.region.mean_arcsec;
    figures["centroid_floor_px"] = calibration.centroid_floor_px;
  }
  if (auto digest = report::digest_of(run.calibration_file)) {
    figures["calibration_sha256"] = digest->sha256;
    record.summary.provenance.testbed.push_back(std::move(*digest));
  }
  if (run.self_check) {
    const SelfCheckFigures& check = *run.self_check;
    figures["self_check_arcsec"] = check.residual_arcsec;
    figures["self_check_brightness"] = check.brightness;
    figures["self_check_noise"] = check.noise;
    figures["self_check_offset"] = check.offset;
    figures["self_check_new_hot_pixels"] = static_cast<double>(check.new_hot_pixels);
    figures["day_shift_x_px"] = check.correction.shift_px.x();
    figures["day_shift_y_px"] = check.correction.shift_px.y();
    figures["day_rotation_mrad"] = 1e3 * check.correction.rotation_rad;
    figures["day_scale_ppm"] = 1e6 * (check.correction.scale - 1.0);
  }
  for (const auto& [kind, count] : run.faults) figures["faults_" + kind] = static_cast<double>(count);
  for (const report::FileDigest& file : run.bench_files) record.summary.provenance.testbed.push_back(file);
}

void summarise(const RunRecord& record, report::Summary& summary) {
  const auto& rows = record.tables.rows<StimulatorRow>();
  if (rows.empty()) return;
  TestbedFigures& figures = summary.testbeds[kName];
  double retried = 0.0, stale = 0.0, resent = 0.0, reconnects = 0.0, clipped = 0.0, wanted = 0.0;
  for (const StimulatorRow& row : rows) {
    retried += row.tries > 1 ? 1.0 : 0.0;
    stale += static_cast<double>(row.stale);
    resent += static_cast<double>(row.packets_resent);
    reconnects += static_cast<double>(row.reconnects);
    clipped += row.clipped_electrons;
    wanted += row.wanted_electrons;
  }
  figures["images"] = static_cast<double>(rows.size());
  figures["images_retried"] = retried;
  figures["stale_frames"] = stale;
  figures["packets_resent"] = resent;
  figures["camera_reconnects"] = reconnects;
  if (wanted > 0.0) figures["light_clipped"] = clipped / wanted;
  for (const Wait& wait : kWaits) {
    const std::vector<double> values = sorted_values(rows, wait.value_s);
    figures[fmt::format("{}_median_ms", wait.figure)] = 1e3 * report::quantile(values, 0.5);
    figures[fmt::format("{}_sum_s", wait.figure)] = std::accumulate(values.begin(), values.end(), 0.0);
  }
}

std::vector<report::Section> sections(const RunRecord& record) {
  const auto found = record.summary.testbeds.find(kName);
  if (found == record.summary.testbeds.end()) return {};
  const TestbedFigures& figures = found->second;
  const bool is_emulated = testbeds::text_of(figures, "bench") == "emulated";
  std::string content = fmt::format(
      "<p class=\"note\">{}</p>\n",
      is_emulated ? "Display, lenses and camera of this run were an emulated bench: another process that uses the wire "
                    "protocols of the hardware. No hardware was used."
                  : "The camera of this run does not name itself an emulator: display, lenses and camera are those at "
                    "the addresses of the mission.");
  content += report::fact_list(testbeds::facts_of(figures));
  if (!record.tables.rows<StimulatorRow>().empty()) {
    content += wall_clock_table(record);
    const report::View view = report::whole_run(record);
    content += report::plot_rows(
        2, {plot_of(record, view, "Brightness of the frame strip", "relative to the calibration",
                    &StimulatorRow::strip_brightness),
            plot_of(record, view, "From the trigger until the image is whole", "wait (s)", &StimulatorRow::receive_s)});
  }
  return {{"Optical Stimulator", content, {"bench.csv"}}};
}

}  // namespace vbar::optical_stimulator
