#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "hil_drivers/optical_stimulator/calibration/procedure.h"
#include "host_sim/report/plots/html_page.h"

namespace vbar::optical_stimulator::calibrate {
namespace {

using fsw::Vector2;

constexpr const char* kTitle = "Calibration of the Optical Stimulator";

std::string with_sigma(const Figure& figure) {
  return fmt::format("{:.6g} ± {:.2g}", figure.value, figure.sigma);
}

std::vector<std::string> residual_row(const std::string& name, const ResidualFigures& with,
                                      const ResidualFigures& lens_terms, double mean_goal, double p95_goal) {
  return {name,
          fmt::format("{:.2f}", with.mean_arcsec),
          fmt::format("{:.1f}", mean_goal),
          fmt::format("{:.2f}", with.p95_arcsec),
          fmt::format("{:.1f}", p95_goal),
          fmt::format("{:.2f}", lens_terms.mean_arcsec),
          fmt::format("{:.2f}", lens_terms.p95_arcsec),
          fmt::format("{}", with.dots)};
}

std::string residual_table(const HeldOutResiduals& held_out) {
  return report::table({{"Held-out dots", false},
                        {"Mean, arcsec"},
                        {"Goal"},
                        {"95 %, arcsec"},
                        {"Goal"},
                        {"Lens terms alone: mean"},
                        {"95 %"},
                        {"Dots"}},
                       {residual_row("Region", held_out.region, held_out.region_lens_terms, kRegionMeanGoal_arcsec,
                                     kRegionP95Goal_arcsec),
                        residual_row("Whole detector", held_out.detector, held_out.detector_lens_terms,
                                     kDetectorMeanGoal_arcsec, kDetectorP95Goal_arcsec)});
}

/// From blue (none) by yellow to red (5 arcsec and more).
std::string colour_of(double arcsec) {
  const double hue = 220.0 * (1.0 - std::clamp(arcsec / kDetectorP95Goal_arcsec, 0.0, 1.0));
  return fmt::format("hsl({:.0f},75%,48%)", hue);
}

/// A disc and an arrow for each dot, at its place on the detector.
std::string residual_map(const ProcedureResult& result, int width, int height) {
  constexpr double kArrow_px_per_arcsec = 12.0;
  std::string svg =
      fmt::format(R"(<svg viewBox="-20 -20 {} {}" role="img" style="width:100%">)", width + 40, height + 40);
  const auto rectangle = [&](int x, int y, int w, int h) {
    svg += fmt::format(
        R"(<rect x="{}" y="{}" width="{}" height="{}" fill="none" stroke="currentColor" stroke-width="2"/>)", x, y, w,
        h);
  };
  rectangle(0, 0, width, height);
  const auto& region = result.calibration.validity.region;
  rectangle(region.x, region.y, region.width, region.height);
  for (const Residual& residual : result.residuals) {
    const Vector2 tip = residual.camera_px + kArrow_px_per_arcsec * residual.error_arcsec;
    const double arcsec = residual.error_arcsec.norm();
    svg += fmt::format(
        R"(<g stroke="{0}" fill="{0}"><title>{1:.2f} arcsec</title><circle cx="{2:.1f}" cy="{3:.1f}" r="9"/><line x1="{2:.1f}" y1="{3:.1f}" x2="{4:.1f}" y2="{5:.1f}" stroke-width="4"/></g>)",
        colour_of(arcsec), arcsec, residual.camera_px.x(), residual.camera_px.y(), tip.x(), tip.y());
  }
  return svg +
         "</svg><p class=\"note\">Blue: none; red: 5 arcsec and more. An arrow of 12 pixels is 1 arcsec. The inner "
         "rectangle is the "
         "region that flight reads.</p>";
}

std::string bench_facts(const StimulatorCalibration& c) {
  const Validity& validity = c.validity;
  return report::fact_list(
      {{"Bench", validity.emulated ? "emulated bench" : "hardware"},
       {"Date", validity.date_utc},
       {"Camera", validity.camera_vendor + " " + validity.camera_model + ", serial number " + validity.camera_serial},
       {"Display", fmt::format("{} x {} pixels, {} Hz", validity.display_width_px, validity.display_height_px,
                               validity.display_rate_hz)},
       {"Rails", fmt::format("lens {:.4f} mm, display {:.4f} mm", validity.rail_lens_mm, validity.rail_display_mm)},
       {"Geometry", c.held_out.goal_reached ? "reaches its goal" : "does not reach its goal",
        !c.held_out.goal_reached}});
}

std::string light_facts(const StimulatorCalibration& c) {
  return report::fact_list(
      {{"Gamma", with_sigma(c.light.gamma)},
       {"First count", with_sigma(c.light.first_count)},
       {"Full pixel, electrons/s", with_sigma(c.light.full_pixel_electrons_per_s)},
       {"Black pixel, electrons/s", with_sigma(c.light.black_pixel_electrons_per_s)},
       {"Difference of the dots from the curve", fmt::format("{:.2f} %", 100.0 * c.light.residual)},
       {"Uniformity, lowest and highest",
        fmt::format("{:.3f} {:.3f}", *std::min_element(c.uniformity.values.begin(), c.uniformity.values.end()),
                    *std::max_element(c.uniformity.values.begin(), c.uniformity.values.end()))}});
}

std::string camera_facts(const StimulatorCalibration& c) {
  return report::fact_list({{"Offset, DN", with_sigma(c.camera.offset_dn)},
                            {"Gain, DN/electron", with_sigma(c.camera.gain_dn_per_electron)},
                            {"Read noise, electrons", with_sigma(c.camera.read_noise_electrons)},
                            {"Background, electrons/s", with_sigma(c.camera.background_electrons_per_s)},
                            {"Point spread, px", with_sigma(c.camera.point_spread_sigma_px)},
                            {"Hot pixels", fmt::format("{}", c.camera.hot_pixels.size())},
                            {"Centroid floor, px", fmt::format("{:.4f}", c.centroid_floor_px)}});
}

std::string lens_facts(const StimulatorCalibration& c) {
  const auto values = c.geometry.lens.values(), sigmas = c.lens_sigma.values();
  constexpr std::array kNames{"Centre x, px", "Centre y, px", "Scale, px", "Rotation, rad",
                              "Tilt x, rad",  "Tilt y, rad",  "k1",        "k2",
                              "p1",           "p2",           "k3"};
  static_assert(kNames.size() == LensTerms::kCount);
  std::vector<report::Fact> facts;
  for (std::size_t k = 0; k < kNames.size(); ++k) facts.push_back({kNames[k], with_sigma({values[k], sigmas[k]})});
  facts.push_back({"Field, degree", fmt::format("{}", c.geometry.field.degree)});
  facts.push_back({"Field, standard deviation, px", fmt::format("{:.4f}", c.field_sigma_px)});
  return report::fact_list(facts);
}

}  // namespace

std::string calibration_page(const ProcedureResult& result) {
  const StimulatorCalibration& c = result.calibration;
  double right = 0.0, lower = 0.0;
  for (const Residual& residual : result.residuals)
    right = std::max(right, residual.camera_px.x()), lower = std::max(lower, residual.camera_px.y());
  std::string body = fmt::format(
      "<h1>{}</h1>\n<p class=\"lead\">{}, {}</p>\n<p><span class=\"status {}\">{}</span> The mean residual of held-out "
      "dots in the region that flight reads is {:.2f} arcsec.</p>\n",
      kTitle, c.validity.emulated ? "emulated bench" : "hardware", report::escaped(c.validity.date_utc),
      c.held_out.goal_reached ? "good" : "bad",
      c.held_out.goal_reached ? "reaches its goal" : "does not reach its goal", c.held_out.region.mean_arcsec);
  body += report::section_html({"Bench", bench_facts(c)});
  body +=
      report::section_html({"Residuals", residual_table(c.held_out) + residual_map(result, static_cast<int>(right) + 20,
                                                                                   static_cast<int>(lower) + 20)});
  body += report::section_html({"Light", light_facts(c)});
  body += report::section_html({"Camera", camera_facts(c)});
  body += report::section_html({"Display map", lens_facts(c)});
  return report::html_page(kTitle, body);
}

}  // namespace vbar::optical_stimulator::calibrate
