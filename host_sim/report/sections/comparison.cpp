#include "host_sim/report/sections/comparison.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "host_sim/report/extension.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/published_figures.h"
#include "host_sim/report/run_series.h"
#include "host_sim/report/words.h"

namespace vbar::report {

std::string plus_minus(const std::optional<MeanAndDeviation>& value, int decimals, double scale) {
  if (!value) return fixed(std::nullopt, decimals);
  return fmt::format("{} ± {}", fixed(scale * value->mean, decimals), fixed(scale * value->std, decimals));
}

namespace {

using Runs = std::span<const ComparedRun>;

using Papers = std::vector<PaperColumn>;
constexpr const char* kNone = "–";

template <class Cell>
ComparisonRow row_of(std::string name, Runs runs, const Cell& cell) {
  ComparisonRow row{std::move(name), {}};
  for (const ComparedRun& run : runs) row.cells.push_back(cell(run.record));
  return row;
}

/// The same, with what the paper says of it.
template <class Cell, class PaperCell>
ComparisonRow row_of(std::string name, Runs runs, const Papers& papers, const Cell& cell,
                     const PaperCell& papers_cell) {
  ComparisonRow row = row_of(std::move(name), runs, cell);
  for (const PaperColumn& paper : papers) row.cells.push_back(papers_cell(paper));
  return row;
}

/// Lengths of navigation by carrier phases are millimetres.
struct LengthUnit {
  double scale = 1.0;
  const char* name = "m";
  int decimals = 4;
};
constexpr int kVelocityDecimals = 4;
LengthUnit navigation_unit(Runs runs) {
  const bool has_fix =
      std::ranges::any_of(runs, [](const ComparedRun& run) { return run.record.summary.first_fix_s.has_value(); });
  return has_fix ? LengthUnit{1e3, "mm", 3} : LengthUnit{};
}

/// Index and time of every waypoint that any run reached.
std::map<int, double> waypoint_times(Runs runs) {
  std::map<int, double> times;
  for (const ComparedRun& run : runs) {
    for (const WaypointRow& waypoint : reached_waypoints(run.record)) times.emplace(waypoint.index, waypoint.time_s);
  }
  return times;
}

const WaypointRow* find_waypoint(const RunRecord& record, int index) {
  const auto found = std::ranges::find(record.waypoints, index, &WaypointRow::index);
  return found == record.waypoints.end() ? nullptr : &*found;
}

/// A value of each waypoint, a row a waypoint under a heading. Nothing if no run has any.
struct WaypointValue {
  std::string heading;
  std::function<std::optional<double>(const WaypointRow&)> value;
  std::optional<double> PaperColumn::AtWaypoint::*papers_value = nullptr;
  double scale = 1.0;
  int decimals = 4;
};
void append_by_waypoint(std::vector<ComparisonRow>& rows, Runs runs, const Papers& papers, const WaypointValue& of) {
  bool any = false;
  const auto text = [&](const std::optional<double>& value) {
    return fixed(value ? std::optional(of.scale * *value) : std::nullopt, of.decimals);
  };
  std::vector<ComparisonRow> values;
  for (const auto& [index, time_s] : waypoint_times(runs)) {
    const WaypointRow* met = nullptr;
    for (const ComparedRun& run : runs)
      if (met == nullptr) met = find_waypoint(run.record, index);
    const auto cell = [&, wanted = index](const RunRecord& record) {
      const WaypointRow* waypoint = find_waypoint(record, wanted);
      const std::optional<double> found = waypoint != nullptr ? of.value(*waypoint) : std::nullopt;
      any = any || found.has_value();
      return text(found);
    };
    const auto papers_cell = [&](const PaperColumn& paper) {
      return of.papers_value == nullptr ? std::string(kNone) : text(paper.at(*met).*of.papers_value);
    };
    values.push_back(
        row_of(fmt::format("  waypoint {}, {:.2f} h", index, time_s / 3600.0), runs, papers, cell, papers_cell));
  }
  if (!any) return;
  rows.push_back({of.heading, {}});
  rows.insert(rows.end(), values.begin(), values.end());
}

std::optional<double> largest_difference(const RunRecord& a, const RunRecord& b) {
  std::optional<double> largest;
  for (const WaypointRow& waypoint : a.waypoints) {
    const WaypointRow* other = find_waypoint(b, waypoint.index);
    if (other == nullptr) continue;
    largest = std::max(largest.value_or(0.0), std::abs(waypoint.control_error_m - other->control_error_m));
  }
  return largest;
}

std::string mean_and_deviation(const std::optional<MeanAndDeviation>& value, const LengthUnit& unit) {
  return plus_minus(value, unit.decimals, unit.scale);
}

/// Different outputs are set off only where they should be the same.
std::string same_as_first(const RunRecord& run, const RunRecord& first, std::string Summary::*hash) {
  const std::string &own = run.summary.*hash, &expected = first.summary.*hash;
  if (own.empty() || expected.empty()) return kNone;
  if (own == expected) return "same bits";
  return expect_same_outputs(run.summary, first.summary) ? "DIFFERENT" : "other mission, seed or settings";
}

std::string cost(const Summary::FlightStep& step) {
  return step.max == 0 ? kNone : fmt::format("{} {}", grouped(step.max), step.unit);
}

void append_setting(std::vector<ComparisonRow>& rows, Runs runs) {
  rows.push_back(row_of("in the loop", runs, [](const RunRecord& r) { return loop_name(r.summary); }));
  rows.push_back(row_of("mission", runs, [](const RunRecord& r) { return r.summary.mission; }));
  rows.push_back(row_of("seed", runs, [](const RunRecord& r) { return std::to_string(r.summary.seed); }));
  rows.push_back(row_of("flight computer", runs, [](const RunRecord& r) { return r.summary.flight_computer; }));
  rows.push_back(row_of("outcome", runs, [](const RunRecord& r) {
    return r.summary.complete ? std::string("complete") : "INCOMPLETE: " + r.summary.incomplete_reason;
  }));
}

/// Appends nothing if the consistency of no run is known.
void append_consistency(std::vector<ComparisonRow>& rows, Runs runs) {
  const auto nees = [](const RunRecord& r) { return r.summary.navigation_nees; };
  if (std::ranges::none_of(runs, [&](const ComparedRun& run) { return nees(run.record).has_value(); })) return;
  rows.push_back(row_of("  mean NEES of the relative state (6 if consistent)", runs,
                        [&](const RunRecord& r) { return fixed(nees(r), 2); }));
}

/// Appends nothing if no run estimates the target's attitude.
void append_attitude(std::vector<ComparisonRow>& rows, Runs runs, const Papers& papers) {
  const auto has_attitude = [](const ComparedRun& run) { return run.record.summary.attitude_error_deg.has_value(); };
  if (std::ranges::none_of(runs, has_attitude)) return;
  const auto text = [](const std::optional<MeanAndDeviation>& error_deg) { return plus_minus(error_deg, 2); };
  rows.push_back(row_of(
      "  attitude error of the target, deg (mean ± std)", runs, papers,
      [&](const RunRecord& r) { return text(r.summary.attitude_error_deg); },
      [&](const PaperColumn& p) { return text(p.attitude_error_deg); }));
}

void append_totals(std::vector<ComparisonRow>& rows, Runs runs, const Papers& papers) {
  const LengthUnit unit = navigation_unit(runs);
  rows.push_back({"whole run", {}});
  rows.push_back(row_of(
      fmt::format("  delta-v, {}/s", unit.name), runs, papers,
      [&](const RunRecord& r) { return fixed(unit.scale * r.summary.dv_mps, unit.scale == 1.0 ? 6 : 3); },
      [&](const PaperColumn& p) { return significant(unit.scale * p.dv_mps, 5); }));
  rows.push_back(row_of(
      "  maneuvers", runs, papers, [](const RunRecord& r) { return std::to_string(r.summary.maneuvers); },
      [](const PaperColumn& p) { return std::to_string(p.maneuvers); }));
  rows.push_back(row_of(
      fmt::format("  navigation error, {} (mean ± std)", unit.name), runs, papers,
      [&](const RunRecord& r) { return mean_and_deviation(r.summary.navigation_error_m, unit); },
      [&](const PaperColumn& p) { return mean_and_deviation(p.navigation_error_m, unit); }));
  if (unit.scale != 1.0)
    rows.push_back(row_of(
        fmt::format("  navigation velocity error, {}/s (mean ± std)", unit.name), runs, papers,
        [&](const RunRecord& r) {
          return plus_minus(r.summary.navigation_velocity_error_mps, kVelocityDecimals, unit.scale);
        },
        [&](const PaperColumn& p) {
          return plus_minus(p.navigation_velocity_error_mps, kVelocityDecimals, unit.scale);
        }));
  append_attitude(rows, runs, papers);
  append_consistency(rows, runs);
  rows.push_back(row_of("  longest flight step", runs, [](const RunRecord& r) { return cost(r.summary.flight_step); }));
  rows.push_back(row_of("  most stack, bytes", runs, [](const RunRecord& r) {
    const auto bytes = r.summary.flight_step.stack_bytes_max;
    return bytes == 0 ? std::string(kNone) : grouped(bytes);
  }));
  rows.push_back(row_of("  wall-clock time", runs, [](const RunRecord& r) { return duration_text(r.summary.wall_s); }));
}

/// A figure of the summary that navigation by images alone has.
struct ImageFigure {
  const char* name;
  std::function<std::optional<std::string>(const Summary&)> text;
};

const std::vector<ImageFigure> kImageFigures{
    {"  bias of the bearings, arcsec",
     [](const Summary& s) {
       return s.bearing_error_arcsec ? std::optional(fixed(s.bearing_error_arcsec->bias, 2)) : std::nullopt;
     }},
    {"  noise of the bearings per axis, arcsec",
     [](const Summary& s) {
       return s.bearing_error_arcsec ? std::optional(fixed(s.bearing_error_arcsec->std, 2)) : std::nullopt;
     }},
    {"  boresight error of the star attitude, arcsec (mean ± std)", [](const Summary& s) {
       return s.star_attitude_error_arcsec ? std::optional(plus_minus(s.star_attitude_error_arcsec, 2)) : std::nullopt;
     }}};

/// "81.2 % of 2159"; nothing without images.
std::optional<std::string> share_of_images(const Summary& summary, const char* figure) {
  const auto images = summary.sensor_figures.find("images");
  if (images == summary.sensor_figures.end()) return std::nullopt;
  const auto all = images->second.find("images"), some = images->second.find(figure);
  if (all == images->second.end() || some == images->second.end() || !(all->second > 0.0)) return std::nullopt;
  return fmt::format("{:.1f} % of {:.0f}", 100.0 * some->second / all->second, all->second);
}

/// Appends nothing if no run navigates by the bearings of images.
void append_images(std::vector<ComparisonRow>& rows, Runs runs) {
  std::vector<ImageFigure> figures{
      {"  images with a bearing", [](const Summary& s) { return share_of_images(s, "with_bearing"); }},
      {"  images with stars identified", [](const Summary& s) { return share_of_images(s, "with_stars"); }}};
  figures.insert(figures.end(), kImageFigures.begin(), kImageFigures.end());
  const auto has_images = [&](const ComparedRun& run) { return figures.front().text(run.record.summary).has_value(); };
  if (std::ranges::none_of(runs, has_images)) return;
  rows.push_back({"images", {}});
  for (const ImageFigure& figure : figures)
    rows.push_back(
        row_of(figure.name, runs, [&](const RunRecord& r) { return figure.text(r.summary).value_or(kNone); }));
}

/// The figures of each sensor that at least one run has.
void append_sensor_figures(std::vector<ComparisonRow>& rows, Runs runs) {
  std::map<std::string, std::set<std::string>> sensors;
  for (const ComparedRun& run : runs)
    for (const auto& [sensor, figures] : run.record.summary.sensor_figures)
      for (const auto& [name, value] : figures) sensors[sensor].insert(name);
  for (const auto& [sensor, names] : sensors) {
    rows.push_back({"sensors." + sensor, {}});
    for (const std::string& name : names)
      rows.push_back(row_of("  " + name, runs, [&, &of = sensor](const RunRecord& r) {
        const auto figures = r.summary.sensor_figures.find(of);
        if (figures == r.summary.sensor_figures.end()) return std::string(kNone);
        const auto found = figures->second.find(name);
        if (found == figures->second.end()) return std::string(kNone);
        const bool is_count = found->second >= 1000.0 && std::trunc(found->second) == found->second;
        return is_count ? grouped_nearest(found->second) : significant(found->second, 3);
      }));
  }
}

void append_differences(std::vector<ComparisonRow>& rows, Runs runs) {
  const RunRecord& first = runs.front().record;
  rows.push_back({"against " + runs.front().name, {}});
  rows.push_back(row_of("  largest difference of control error, m", runs, [&](const RunRecord& r) {
    const auto difference = largest_difference(first, r);
    return difference ? significant(*difference, 3) : std::string(kNone);
  }));
  rows.push_back(row_of("  maneuver commands", runs,
                        [&](const RunRecord& r) { return same_as_first(r, first, &Summary::commands_sha256); }));
  rows.push_back(row_of("  telemetry", runs,
                        [&](const RunRecord& r) { return same_as_first(r, first, &Summary::telemetry_sha256); }));
}

/// Characters, not bytes: names and units may hold more than ASCII.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

bool same_outputs(const Summary& a, const Summary& b) {
  return !a.commands_sha256.empty() && a.commands_sha256 == b.commands_sha256 && !a.telemetry_sha256.empty() &&
         a.telemetry_sha256 == b.telemetry_sha256;
}

bool expect_same_outputs(const Summary& a, const Summary& b) {
  // Where the flight software runs must not matter.
  const auto settings_of = [](const Summary& summary) {
    std::vector<std::string> settings = summary.provenance.overrides;
    std::erase_if(settings, [](const std::string& one) { return one.find("flight_computer.") != std::string::npos; });
    std::ranges::sort(settings);
    return settings;
  };
  return a.mission == b.mission && a.seed == b.seed && settings_of(a) == settings_of(b);
}

std::vector<std::string> run_names(const std::vector<std::filesystem::path>& folders) {
  std::vector<std::filesystem::path> names, rest;
  for (const std::filesystem::path& folder : folders) {
    const std::filesystem::path canonical = std::filesystem::weakly_canonical(folder);
    const bool ends_in_slash = !canonical.has_filename();
    rest.push_back(ends_in_slash ? canonical.parent_path() : canonical);
    names.push_back(rest.back().filename());
  }
  const auto extend = [&](std::size_t k) {
    rest[k] = rest[k].parent_path();
    names[k] = rest[k].filename() / names[k];
  };
  const auto is_twin = [&](std::size_t k) {
    return std::ranges::count(names, names[k]) > 1 && rest[k].has_relative_path();
  };
  for (bool changed = true; changed;) {
    std::vector<std::size_t> twins;
    for (std::size_t k = 0; k < names.size(); ++k)
      if (is_twin(k)) twins.push_back(k);
    std::ranges::for_each(twins, extend);
    changed = !twins.empty();
  }
  return {names.begin(), names.end()};
}

std::vector<PaperColumn> paper_columns(Runs runs) {
  for (const ComparedRun& run : runs) {
    for (const Extension* extension : run.record.extensions) {
      if (extension->paper_columns == nullptr) continue;
      if (std::vector<PaperColumn> papers = extension->paper_columns(run.record); !papers.empty()) return papers;
    }
  }
  return {};
}

std::vector<std::string> column_names(Runs runs) {
  std::vector<std::string> names;
  for (const ComparedRun& run : runs) names.push_back(run.name);
  for (const PaperColumn& paper : paper_columns(runs)) names.push_back(paper.name);
  return names;
}

std::vector<ComparisonRow> comparison_rows(Runs runs) {
  std::vector<ComparisonRow> rows;
  if (runs.empty()) return rows;
  using AtWaypoint = PaperColumn::AtWaypoint;
  const Papers papers = paper_columns(runs);
  const LengthUnit unit = navigation_unit(runs);
  append_setting(rows, runs);
  append_by_waypoint(
      rows, runs, papers,
      {"control error, m", [](const WaypointRow& w) { return w.control_error_m; }, &AtWaypoint::control_error_m});
  append_by_waypoint(
      rows, runs, papers,
      {fmt::format("navigation error, {}", unit.name), [](const WaypointRow& w) { return w.navigation_error_m; },
       &AtWaypoint::navigation_error_m, unit.scale, unit.decimals});
  if (unit.scale != 1.0)
    append_by_waypoint(rows, runs, papers,
                       {fmt::format("navigation velocity error, {}/s", unit.name),
                        [](const WaypointRow& w) { return w.navigation_velocity_error_mps; },
                        &AtWaypoint::navigation_velocity_error_mps, unit.scale, kVelocityDecimals});
  append_by_waypoint(
      rows, runs, papers,
      {fmt::format("cumulative delta-v, {}/s", unit.name), [](const WaypointRow& w) { return w.cumulative_dv_mps; },
       nullptr, unit.scale, unit.scale == 1.0 ? 6 : 3});
  append_totals(rows, runs, papers);
  append_images(rows, runs);
  append_sensor_figures(rows, runs);
  if (runs.size() > 1) append_differences(rows, runs);
  // What the paper does not say.
  for (ComparisonRow& row : rows)
    if (!row.cells.empty()) row.cells.resize(runs.size() + papers.size(), kNone);
  return rows;
}

std::string comparison_table(Runs runs) {
  const std::vector<ComparisonRow> rows = comparison_rows(runs);
  const std::vector<std::string> names = column_names(runs);
  std::size_t name_width = 0;
  for (const ComparisonRow& row : rows) name_width = std::max(name_width, width_of(row.name));
  std::vector<std::size_t> widths;
  for (std::size_t k = 0; k < names.size(); ++k) {
    widths.push_back(width_of(names[k]));
    for (const ComparisonRow& row : rows) {
      if (!row.cells.empty()) widths[k] = std::max(widths[k], width_of(row.cells[k]));
    }
  }
  std::string text(name_width, ' ');
  for (std::size_t k = 0; k < names.size(); ++k) text += fmt::format("  {:>{}}", names[k], widths[k]);
  text += '\n';
  for (const ComparisonRow& row : rows) {
    if (row.cells.empty()) {
      text += row.name + '\n';
      continue;
    }
    text += fmt::format("{:<{}}", row.name, name_width);
    for (std::size_t k = 0; k < row.cells.size(); ++k) text += fmt::format("  {:>{}}", row.cells[k], widths[k]);
    text += '\n';
  }
  return text;
}

}  // namespace vbar::report
