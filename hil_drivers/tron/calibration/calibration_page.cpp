#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <fmt/format.h>

#include "hil_drivers/tron/calibration/procedure.h"
#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/svg_plot.h"

namespace vbar::tron::calibrate {
namespace {

constexpr const char* kTitle = "Calibration of TRON";
constexpr double kDegrees = 180.0 / std::numbers::pi;

std::string spread(double mean, double sigma, double median, int digits) {
  return fmt::format("{:.{}f} ± {:.{}f} ({:.{}f})", mean, digits, sigma, digits, median, digits);
}

std::vector<std::string> row(const std::string& name, int poses, const ErrorFigures& f) {
  return {name, fmt::format("{}", poses),
          spread(f.translation_mean_mm, f.translation_sigma_mm, f.translation_median_mm, 2),
          spread(f.rotation_mean_deg, f.rotation_sigma_deg, f.rotation_median_deg, 3),
          spread(f.pixel_mean_px, f.pixel_sigma_px, f.pixel_median_px, 2)};
}

std::string figures_table(const Calibration& calibration) {
  std::vector<std::vector<std::string>> rows{{"Against the board's pose by the image"}};
  for (const StageFigures& stage : calibration.figures) rows.push_back(row(stage.stage, stage.poses, stage.board));
  // Park and others, the paper's table of calibration errors: its robots, motion capture and both.
  rows.push_back({"Paper: KUKA", "", "3.97 ± 4.30", "0.369 ± 0.584", "3.42 ± 1.78"});
  rows.push_back({"Paper: motion capture", "", "6.66 ± 8.27", "0.364 ± 0.557", "9.97 ± 6.61"});
  rows.push_back({"Paper: fused", "", "2.89 ± 3.13", "0.350 ± 0.566", "3.24 ± 1.80"});
  const bool is_truth_known =
      std::ranges::any_of(calibration.figures, [](const StageFigures& stage) { return stage.truth.has_value(); });
  if (is_truth_known) rows.push_back({"Against truth (emulated bench)"});
  for (const StageFigures& stage : calibration.figures)
    if (stage.truth) rows.push_back(row(stage.stage, stage.poses, *stage.truth));
  return report::table({{"Source", false}, {"Poses"}, {"Translation, mm"}, {"Rotation, deg"}, {"Corners, px"}}, rows) +
         "<p class=\"note\">Mean ± standard deviation (median) over postures that were not fitted.</p>\n";
}

/// The errors in translation of evaluated postures over a quantity of the bench.
using Abscissa = std::function<double(const EvaluatedPose&, const Measurement&)>;
report::Plot plot(const std::string& source, const std::vector<EvaluatedPose>& poses, const CalibrationData& data,
                  const report::Axis& x, const Abscissa& of) {
  report::Series dots{"", 0, report::Mark::kBroadDots};
  for (const EvaluatedPose& pose : poses)
    dots.points.push_back({of(pose, data.judged.at(pose.measurement)), 1e-3 * pose.board.translation_mm});
  report::Plot plot;
  plot.title = fmt::format("{} over {}", source, x.name);
  plot.x = x;
  plot.y = {.name = "translation error", .unit = report::Unit::kMetres, .min_span = 1e-5};
  plot.height = 220.0;
  plot.series.push_back(std::move(dots));
  return plot;
}

std::string plots(const TestbedFit& fit, const CalibrationData& data) {
  using report::Unit;
  std::vector<report::Plot> all;
  const auto add = [&](const char* source, const std::vector<EvaluatedPose>& poses, std::string name, Unit unit,
                       const Abscissa& of) {
    if (!poses.empty()) all.push_back(plot(source, poses, data, {.name = std::move(name), .unit = unit}, of));
  };
  const Abscissa range = [](const EvaluatedPose& pose, const Measurement&) { return pose.range_m; };
  add("Arms", fit.arms, "range", Unit::kMetres, range);
  add("Motion capture", fit.vicon, "range", Unit::kMetres, range);
  add("Fused", fit.fused, "range", Unit::kMetres, range);
  add("Fused", fit.fused, "carriage", Unit::kMetres,
      [](const EvaluatedPose&, const Measurement& m) { return m.posture.carriage_m; });
  for (Eigen::Index k = 0; k < 6; ++k) {
    add("Fused", fit.fused, fmt::format("A{} of the camera's arm", k + 1), Unit::kRadians,
        [k](const EvaluatedPose&, const Measurement& m) { return m.posture.camera_rad[k]; });
    add("Fused", fit.fused, fmt::format("A{} of the target's arm", k + 1), Unit::kRadians,
        [k](const EvaluatedPose&, const Measurement& m) { return m.posture.target_rad[k]; });
  }
  return "<p class=\"note\">Translation against the board's pose by the image, of postures that were not "
         "fitted.</p>\n" +
         report::plot_rows(2, std::move(all));
}

std::string numbers_of(const auto& values, double unit, int digits) {
  std::string text;
  for (const double value : values) text += fmt::format("{}{:.{}f}", text.empty() ? "" : ", ", value * unit, digits);
  return text;
}

std::string arm_facts(const ArmCalibration& arm) {
  std::vector<report::Fact> facts{{"Joint offsets, deg", numbers_of(arm.offset_rad, kDegrees, 4)},
                                  {"Flex of A2, A3, deg/m", numbers_of(arm.flex_rad_m, kDegrees, 4)},
                                  {"Mount: rotation, deg", numbers_of(arm.mount.rotation_rad, kDegrees, 3)},
                                  {"Mount: place, mm", numbers_of(arm.mount.translation_m, 1e3, 2)}};
  for (std::size_t k = 0; k < arm.link.size(); ++k) {
    const std::array rotation{arm.link[k][0], arm.link[k][1], arm.link[k][2]};
    const std::array place{arm.link[k][3], arm.link[k][4], arm.link[k][5]};
    facts.push_back({fmt::format("After A{}: deg; mm", k + 1),
                     numbers_of(rotation, kDegrees, 4) + "; " + numbers_of(place, 1e3, 3)});
  }
  return report::fact_list(facts);
}

std::string bench_facts(const Calibration& c) {
  const CalibrationValidity& v = c.validity;
  return report::fact_list(
      {{"Bench", v.bench + (v.emulated ? " (emulated)" : "")},
       {"Date", v.date_utc},
       {"Seed", fmt::format("{}", v.seed)},
       {"Camera", v.camera_model + ", serial number " + v.camera_serial},
       {"Focal length, px", fmt::format("{:.2f} {:.2f}", c.lens.fx_px, c.lens.fy_px)},
       {"Principal point, px", fmt::format("{:.2f} {:.2f}", c.lens.cx_px, c.lens.cy_px)},
       {"Distortion", numbers_of(c.lens.distortion, 1.0, 6)},
       {"Order of the angles of motion capture", c.vicon.rotation},
       {"Offset, noise of the camera, DN", fmt::format("{:.2f}, {:.2f}", c.camera.offset_dn, c.camera.read_noise_dn)},
       {"SHA-256 of the data", v.data_sha256}});
}

std::string covariance_table(const SourceCovariances& covariance) {
  const auto deviations = [](const std::string& name, const Matrix6& matrix) {
    std::vector<std::string> cells{name};
    for (int k = 0; k < 6; ++k) {
      const double sigma = std::sqrt(matrix(k, k));
      cells.push_back(k < 3 ? fmt::format("{:.4f}", sigma * kDegrees) : fmt::format("{:.3f}", sigma * 1e3));
    }
    return cells;
  };
  return report::table(
      {{"Source", false}, {"Rotation x, deg"}, {"y"}, {"z"}, {"Side x, mm a metre of range"}, {"Side y"}, {"Depth"}},
      {deviations("arms", covariance.arms), deviations("motion capture", covariance.vicon)});
}

std::string light_table(const std::vector<LightTable>& lights) {
  std::vector<std::vector<std::string>> rows;
  for (const LightTable& table : lights)
    rows.push_back({table.source, numbers_of(table.level, 1.0, 3), numbers_of(table.light, 1.0, 4)});
  return rows.empty() ? std::string()
                      : report::table({{"Source", false}, {"Level", false}, {"Light", false}}, rows) +
                            "<p class=\"note\">Light relative to full power as designed, of the lamp to its own.</p>\n";
}

}  // namespace

std::string calibration_page(const TestbedFit& fit, const CalibrationData& data) {
  const Calibration& c = fit.calibration;
  std::string body =
      fmt::format("<h1>{}</h1>\n<p class=\"lead\">{}, {}</p>\n", kTitle,
                  c.validity.emulated ? "emulated bench" : "hardware", report::escaped(c.validity.date_utc));
  body += report::section_html({"Bench", bench_facts(c)});
  body += report::section_html({"Errors", figures_table(c)});
  body += report::section_html({"Errors over the bench", plots(fit, data)});
  body += report::section_html({"Standard deviations for fusion", covariance_table(c.covariance)});
  body += report::section_html({"Camera's arm", arm_facts(c.camera_arm)});
  body += report::section_html({"Target's arm", arm_facts(c.target_arm)});
  body += report::section_html({"Light", light_table(c.lights)});
  return report::html_page(kTitle, body);
}

}  // namespace vbar::tron::calibrate
