#include "host_sim/orbit_fit/record.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "host_sim/files/output_file.h"
#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/svg_plot.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::orbit_fit {

namespace {

using fsw::Vector3;

constexpr double kDay_s = 86400.0, kHour_s = 3600.0;

std::string utc(const FitRecord& record, double seconds, int decimals) {
  return truth::format_utc(record.positions.epoch + fsw::nearest_duration(seconds), decimals);
}

/// The sigma of an estimate by its name, 0 if there is none.
double sigma_of(const FittedOrbit& fitted, const std::string& name) {
  const auto found = std::ranges::find(fitted.estimates, name, &Estimate::name);
  return found == fitted.estimates.end() ? 0.0 : found->sigma;
}

std::string_view unit_of(const std::string& name) {
  if (name.starts_with("empirical")) return "nm/s^2";
  if (name.starts_with("start position")) return "m";
  if (name.starts_with("start velocity") || name.find(" dv ") != std::string::npos) return "mm/s";
  return name.starts_with("burn") ? "s" : "";
}

std::string burn_line(const FitRecord& record, std::size_t index) {
  const Burn& burn = record.fitted.parameters.burns[index];
  const auto sigma = [&](const char* what) {
    return sigma_of(record.fitted, fmt::format("burn {} {}", index + 1, what));
  };
  return fmt::format(
      "burn {}  {} +- {:.2f} s  R {:+.3f} +- {:.3f}  T {:+.3f} +- {:.3f}  N {:+.3f} +- {:.3f} mm/s  |dv| {:.3f} mm/s",
      index + 1, utc(record, burn.seconds, 3), sigma("time"), 1e3 * burn.dv_rtn[0], sigma("dv R"), 1e3 * burn.dv_rtn[1],
      sigma("dv T"), 1e3 * burn.dv_rtn[2], sigma("dv N"), 1e3 * burn.dv_rtn.norm());
}

std::string break_lines(const FitRecord& record) {
  if (!record.found_break) return {};
  std::string text =
      fmt::format("The arc does not fit as one: {} velocity change{} would leave {:.3f} m of its {:.3f} m.\n",
                  record.found_break->burns.size() == 1 ? "one" : "two",
                  record.found_break->burns.size() == 1 ? "" : "s", record.found_break->rms_m, record.fitted.rms_m);
  for (const Burn& burn : record.found_break->burns)
    text += fmt::format("  about {}  R {:+.2f}  T {:+.2f}  N {:+.2f} mm/s\n", utc(record, burn.seconds, 0),
                        1e3 * burn.dv_rtn[0], 1e3 * burn.dv_rtn[1], 1e3 * burn.dv_rtn[2]);
  return text + "  --find-burns estimates them.\n";
}

std::string residual_rows(const FitRecord& record) {
  std::string text = "time_s,utc,residual_r_m,residual_t_m,residual_n_m,use\n";
  for (std::size_t k = 0; k < record.residuals_rtn.size(); ++k) {
    const Vector3& residual = record.residuals_rtn[k];
    const bool is_fitted = k < record.fitted.used.size();
    fmt::format_to(std::back_inserter(text), "{},{},{:.4f},{:.4f},{:.4f},{}\n", record.positions.seconds[k],
                   utc(record, record.positions.seconds[k], 3), residual[0], residual[1], residual[2],
                   !is_fitted              ? "predicted"
                   : record.fitted.used[k] ? "fitted"
                                           : "edited");
  }
  return text;
}

report::Plot residual_plot(const FitRecord& record, bool predicted) {
  report::Plot plot;
  plot.title = predicted ? "Prediction less file" : "Residuals of the fit";
  plot.x = {"time", report::Unit::kHours};
  plot.y = {"file less fitted", report::Unit::kMetres};
  plot.width = 800.0;
  constexpr const char* kAxes[] = {"radial", "along track", "across track"};
  for (int axis = 0; axis < 3; ++axis) {
    report::Series& series = plot.series.emplace_back(report::Series{kAxes[axis], axis, report::Mark::kLine});
    const std::size_t begin = predicted ? record.fitted.used.size() : 0;
    const std::size_t end = predicted ? record.residuals_rtn.size() : record.fitted.used.size();
    for (std::size_t k = begin; k < end; ++k)
      if (predicted || record.fitted.used[k])
        series.points.push_back({record.positions.seconds[k] / kHour_s, record.residuals_rtn[k][axis]});
  }
  for (const Burn& burn : record.fitted.parameters.burns)
    if (!predicted) plot.moments.push_back({burn.seconds / kHour_s, "burn"});
  if (record.found_break && !predicted)
    for (const Burn& burn : record.found_break->burns) plot.moments.push_back({burn.seconds / kHour_s, "break"});
  return plot;
}

std::string page_of(const FitRecord& record) {
  std::vector<std::vector<std::string>> rows, days;
  for (const Estimate& one : record.fitted.estimates)
    rows.push_back(
        {one.name, fmt::format("{:.4f}", one.value), fmt::format("{:.4f}", one.sigma), std::string(unit_of(one.name))});
  for (const PredictedDay& day : predicted_days(record))
    days.push_back({std::to_string(day.day), fmt::format("{:.3f}", day.rms_m), fmt::format("{:.3f}", day.largest_m)});
  std::string body = fmt::format("<h1>Orbit of {} fitted to {}</h1>", report::escaped(record.positions.object),
                                 report::escaped(record.file));
  body += fmt::format("<pre>{}</pre>", report::escaped(fit_table(record)));
  body += report::section_html({"Residuals", report::plot_rows(1, {residual_plot(record, false)}), {"residuals.csv"}});
  if (!days.empty())
    body += report::section_html({"Prediction", report::plot_rows(1, {residual_plot(record, true)}) +
                                                    report::table({{"day"}, {"rms, m"}, {"largest, m"}}, days)});
  body += report::section_html(
      {"Estimates", report::table({{"value of", false}, {"estimate"}, {"1 sigma"}, {"unit", false}}, rows)});
  return report::html_page("Fitted orbit", body);
}

constexpr std::string_view word_of(truth::Shadow shadow) {
  switch (shadow) {
    case truth::Shadow::kNone:
      return "none";
    case truth::Shadow::kCylindrical:
      return "cylindrical";
    case truth::Shadow::kConical:
      return "conical";
  }
  return "";
}

/// What a mission cannot hold, as comments.
std::string left_out(const FitRecord& record) {
  std::string text;
  const OrbitParameters& parameters = record.fitted.parameters;
  if (record.ocean_tides) text += "# The ocean tides of the fit are not part of a mission's truth.\n";
  if (!parameters.empirical.values.empty()) text += "# The empirical accelerations of the fit are left out.\n";
  if (parameters.drag_scale.values.size() > 1) text += "# Of the drag scales of the fit it has the first one.\n";
  for (std::size_t k = 0; k < parameters.burns.size(); ++k)
    text += fmt::format("# It has no burns; fitted was {}\n", burn_line(record, k));
  return text;
}

}  // namespace

std::vector<PredictedDay> predicted_days(const FitRecord& record) {
  std::vector<PredictedDay> days;
  std::size_t count = 0;
  const auto close = [&] {
    if (days.empty()) return;
    days.back().rms_m = std::sqrt(days.back().rms_m / static_cast<double>(count));
    days.back().rms_rtn = (days.back().rms_rtn / static_cast<double>(count)).cwiseSqrt();
  };
  for (std::size_t k = record.fitted.used.size(); k < record.residuals_rtn.size(); ++k) {
    const int day = static_cast<int>(std::ceil((record.positions.seconds[k] - record.arc_s) / kDay_s - 1e-9));
    if (days.empty() || days.back().day != day) {
      close();
      days.push_back({day});
      count = 0;
    }
    const Vector3& residual = record.residuals_rtn[k];
    days.back().rms_m += residual.squaredNorm();
    days.back().rms_rtn += residual.cwiseAbs2();
    days.back().largest_m = std::max(days.back().largest_m, residual.norm());
    ++count;
  }
  close();
  return days;
}

std::string fit_table(const FitRecord& record) {
  const FittedOrbit& fitted = record.fitted;
  std::string text = fmt::format(
      "{} from {}, {:.2f} h: {} positions, {} edited\nresiduals  rms {:.4f} m  R {:.4f}  T {:.4f}  N {:.4f} m\n\n",
      record.positions.object, utc(record, 0.0, 3), record.arc_s / kHour_s, fitted.used.size(), fitted.edited,
      fitted.rms_m, fitted.rms_rtn[0], fitted.rms_rtn[1], fitted.rms_rtn[2]);
  for (const Estimate& one : fitted.estimates)
    if (!one.name.starts_with("burn"))
      text += fmt::format("{:24} {:12.4f} +- {:.4f} {}\n", one.name, one.value, one.sigma, unit_of(one.name));
  for (std::size_t k = 0; k < fitted.parameters.burns.size(); ++k) text += burn_line(record, k) + "\n";
  text += fmt::format("1 sigma, with {:.0f} successive positions counted as one, as their residuals are alike\n",
                      fitted.correlated);
  text += break_lines(record);
  const auto days = predicted_days(record);
  if (!days.empty()) text += "\npredicted    rms, m  largest, m       R       T       N\n";
  for (const PredictedDay& day : days)
    text += fmt::format("day {:3} {:12.3f} {:11.3f} {:7.3f} {:7.3f} {:7.3f}\n", day.day, day.rms_m, day.largest_m,
                        day.rms_rtn[0], day.rms_rtn[1], day.rms_rtn[2]);
  return text;
}

std::string fitted_mission(const FitRecord& record, const FittedDynamics& dynamics) {
  const truth::TruthSettings& truth = dynamics.settings();
  const truth::ForceModel& forces = truth.forces;
  const truth::SurfaceProperties& surface = dynamics.surface();
  const OrbitParameters& parameters = record.fitted.parameters;
  const double drag_scale = parameters.drag_scale.values.front();
  if (drag_scale < 0.0 || parameters.radiation_scale < 0.0)
    throw std::domain_error(
        fmt::format("no mission is written: the fitted scale of {} is below 0, which no area has; --fix keeps it at 1",
                    drag_scale < 0.0 ? "drag" : "radiation"));
  const auto elements = fsw::orbit::qns_from_cartesian(parameters.start);
  if (!elements.ok()) throw std::domain_error("no mission is written: the fitted orbit has no elements (equatorial)");
  const fsw::orbit::QnsElements& q = elements.value();
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const int decimals = record.positions.epoch.ns % fsw::kNanosecondsPerSecond == 0 ? 0 : 9;
  std::string text =
      fmt::format("# Orbit of {} fitted to {}: {} positions over {:.2f} h, residuals {:.3f} m rms.\n{}\n",
                  record.positions.object, std::filesystem::path(record.file).filename().string(),
                  record.fitted.used.size(), record.arc_s / kHour_s, record.fitted.rms_m, left_out(record));
  text += fmt::format(
      "[mission]\ndescription = \"Fitted orbit of {}\"\nepoch_utc = \"{}\"\nduration_h = {:.6f}\nstep_s = 60.0\n\n",
      record.spacecraft, utc(record, 0.0, decimals), record.arc_s / kHour_s);
  text += fmt::format(
      "[truth]\ngravity_degree = {}\ngravity_order = {}\ngravity_file = \"{}\"\nearth_orientation_file = \"{}\"\n"
      "space_weather_file = \"{}\"\nconstant_f107 = {:.3f}\nconstant_ap = {:.3f}\n",
      truth.gravity_degree, truth.gravity_order, truth.gravity_file.string(), truth.earth_orientation_file.string(),
      truth.space_weather_file.string(), truth.constant_f107, truth.constant_ap);
  text += fmt::format(
      "drag = {}\ngeomagnetic_index = \"{}\"\nradiation_pressure = {}\nshadow = \"{}\"\nsun = {}\nmoon = {}\n"
      "solid_tides = {}\nrelativity = {}\nrelative_tolerance = {}\n\n",
      forces.drag, forces.geomagnetic_index == truth::GeomagneticIndex::kDaily ? "daily" : "three_hourly",
      forces.radiation_pressure, word_of(forces.shadow), forces.sun, forces.moon, forces.solid_tides, forces.relativity,
      truth.tolerance);
  text += fmt::format(
      "[[spacecraft]]\nname = \"{}\"\nmass_kg = {:.6f}\ndrag_area_m2 = {:.9f}\ndrag_coefficient = {:.6f}\n"
      "radiation_area_m2 = {:.9f}\nradiation_coefficient = {:.6f}\n\n",
      record.spacecraft, surface.mass_kg, surface.drag_area_m2 * drag_scale, surface.drag_coefficient,
      surface.radiation_area_m2 * parameters.radiation_scale, surface.radiation_coefficient);
  text += fmt::format(
      "[spacecraft.elements]\nkind = \"osculating\"\nsemi_major_axis_km = {:.12f}\nex = {:.15f}\ney = {:.15f}\n"
      "inclination_deg = {:.13f}\nraan_deg = {:.13f}\nmean_argument_of_latitude_deg = {:.13f}\n",
      1e-3 * q.a, q.ex, q.ey, kDegrees * q.i, kDegrees * q.raan, kDegrees * q.u);
  return text;
}

std::string write_fit(const std::filesystem::path& folder, const FitRecord& record, const FittedDynamics& dynamics) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  files::replace_text_file(folder / "residuals.csv", residual_rows(record));
  files::replace_text_file(folder / "fit.html", page_of(record));
  const std::filesystem::path mission = folder / (record.spacecraft + ".toml");
  std::filesystem::remove(mission, error);  // of an earlier fit
  try {
    files::replace_text_file(mission, fitted_mission(record, dynamics));
  } catch (const std::domain_error& reason) {
    return reason.what();
  }
  return {};
}

}  // namespace vbar::orbit_fit
