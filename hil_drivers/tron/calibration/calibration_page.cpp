#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <fmt/format.h>

#include "hil_drivers/tron/calibration/procedure.h"
#include "host_sim/report/plots/html_page.h"

namespace vbar::tron::calibrate {
namespace {

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
         "<p>Mean ± standard deviation (median) over postures that were not fitted.</p>";
}

struct Point {
  double x = 0.0, y = 0.0;
};

/// Points over an axis from the lowest to the highest value.
std::string plot(const std::string& title, const std::string& x_name, const std::string& y_name,
                 const std::vector<Point>& points) {
  if (points.empty()) return {};
  double left = 1e300, right = -1e300, high = 1e-9;
  for (const Point& point : points) {
    left = std::min(left, point.x);
    right = std::max(right, point.x);
    high = std::max(high, point.y);
  }
  right = std::max(right, left + 1e-9);
  constexpr double kWidth = 420.0, kHeight = 200.0, kEdge = 40.0;
  std::string svg =
      fmt::format(R"(<figure><svg viewBox="0 0 {:.0f} {:.0f}" role="img" style="width:100%"><title>{}</title>)"
                  R"(<rect x="{:.0f}" y="10" width="{:.0f}" height="{:.0f}" fill="none" stroke="currentColor"/>)",
                  kWidth + 2.0 * kEdge, kHeight + 60.0, report::escaped(title), kEdge, kWidth, kHeight);
  for (const Point& point : points)
    svg += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="3" fill="currentColor" fill-opacity="0.6"/>)",
                       kEdge + kWidth * (point.x - left) / (right - left), 10.0 + kHeight * (1.0 - point.y / high));
  const auto label = [&](double x, double y, const char* anchor, const std::string& text) {
    svg += fmt::format(R"(<text x="{:.0f}" y="{:.0f}" text-anchor="{}" font-size="12" fill="currentColor">{}</text>)",
                       x, y, anchor, report::escaped(text));
  };
  label(kEdge, kHeight + 26.0, "start", fmt::format("{:.3g}", left));
  label(kEdge + kWidth, kHeight + 26.0, "end", fmt::format("{:.3g}", right));
  label(kEdge + kWidth / 2.0, kHeight + 42.0, "middle", x_name);
  label(kEdge - 4.0, 20.0, "end", fmt::format("{:.3g}", high));
  label(kEdge + 6.0, 24.0, "start", y_name);
  return svg + "</svg></figure>";
}

std::string plots(const TestbedFit& fit, const CalibrationData& data) {
  using Ordinate = std::function<double(const EvaluatedPose&, const Measurement&)>;
  std::vector<std::string> all;
  const auto add = [&](const std::string& name, const std::vector<EvaluatedPose>& poses, const std::string& x_name,
                       const Ordinate& x) {
    std::vector<Point> points;
    for (const EvaluatedPose& pose : poses)
      points.push_back({x(pose, data.judged.at(pose.measurement)), pose.board.translation_mm});
    all.push_back(plot(name, x_name, name + ", mm", points));
  };
  const Ordinate range = [](const EvaluatedPose& pose, const Measurement&) { return pose.range_m; };
  const Ordinate track = [](const EvaluatedPose&, const Measurement& m) { return m.posture.carriage_m; };
  add("arms", fit.arms, "range, m", range);
  add("motion capture", fit.vicon, "range, m", range);
  add("fused", fit.fused, "range, m", range);
  add("fused", fit.fused, "carriage, m", track);
  for (Eigen::Index k = 0; k < 6; ++k) {
    add("fused", fit.fused, fmt::format("camera's arm A{}, deg", k + 1),
        [k](const EvaluatedPose&, const Measurement& m) { return m.posture.camera_rad[k] * kDegrees; });
    add("fused", fit.fused, fmt::format("target's arm A{}, deg", k + 1),
        [k](const EvaluatedPose&, const Measurement& m) { return m.posture.target_rad[k] * kDegrees; });
  }
  return report::figures(2, all) + "<p>Translation against the board's pose by the image.</p>";
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
                            "<p>Light relative to full power as designed, of the lamp to its own.</p>";
}

}  // namespace

std::string calibration_page(const TestbedFit& fit, const CalibrationData& data) {
  const Calibration& c = fit.calibration;
  std::string body;
  body += report::section_html({"Bench", bench_facts(c)});
  body += report::section_html({"Errors", figures_table(c)});
  body += report::section_html({"Errors over the bench", plots(fit, data)});
  body += report::section_html({"Standard deviations for fusion", covariance_table(c.covariance)});
  body += report::section_html({"Camera's arm", arm_facts(c.camera_arm)});
  body += report::section_html({"Target's arm", arm_facts(c.target_arm)});
  body += report::section_html({"Light", light_table(c.lights)});
  return report::html_page("Calibration of TRON", body);
}

}  // namespace vbar::tron::calibrate
