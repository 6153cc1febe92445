// A coarse map of the display, and the focus by the least width of its dots.

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "hil_drivers/optical_stimulator/calibrate/session.h"

namespace vbar::optical_stimulator::calibrate {
namespace {

using fsw::Vector2;

constexpr int kColumns = 6, kRows = 4;
constexpr int kMissing = 7;  // place without a dot: no mirroring or rotation of the grid has it there

/// Places of the coarse grid on the display.
std::vector<Vector2> coarse_places(const Session& session) {
  const double width = session.bench.screen.width(), height = session.bench.screen.height();
  std::vector<Vector2> places;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column)
      places.push_back({std::round((0.06 + 0.88 * column / (kColumns - 1)) * width),
                        std::round((0.08 + 0.84 * row / (kRows - 1)) * height)});
  return places;
}

void show_coarse(Session& session, int half_width) {
  Picture counts = Picture(session.bench.screen.width(), session.bench.screen.height());
  const auto places = coarse_places(session);
  for (std::size_t k = 0; k < places.size(); ++k)
    if (k != kMissing)
      draw_square(counts, static_cast<int>(places[k].x()), static_cast<int>(places[k].y()), half_width, 255,
                  session.response);
  session.bench.screen.show(counts);
}

std::optional<DotMeasurement> coarse_dot(const Session& session, const CameraPicture& picture, const Vector2& place,
                                         const DotWindow& window) {
  return measure_dot(picture, session.expected_px(place), window);
}

/// Mean squared width of the dots at a place of the display's axis, px^2.
double squared_width(Session& session, double display_mm, double& exposure_s, double window_sigma_px) {
  session.bench.rails.move_to(session.settings.lens_mm, display_mm);
  const CameraPicture picture = session.well_exposed(exposure_s, 1);
  DotWindow window;
  window.sigma_px = window_sigma_px;
  window.half_width_px = static_cast<int>(std::ceil(4.0 * window_sigma_px)) + 4;
  window.search_px = 12.0;
  std::vector<double> squares;
  const auto places = coarse_places(session);
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (k == kMissing) continue;
    if (const auto dot = coarse_dot(session, picture, places[k], window))
      squares.push_back(dot->sigma_px * dot->sigma_px);
  }
  if (squares.size() < 8)
    throw std::runtime_error(fmt::format("focus: {} of {} dots were found with the display's axis at {:.3f} mm",
                                         squares.size(), places.size() - 1, display_mm));
  std::sort(squares.begin(), squares.end());
  return squares[squares.size() / 2];
}

/// Vertex of the parabola through the squared widths: blur adds the square of the defocus.
double vertex_mm(const std::vector<std::pair<double, double>>& widths, double middle_mm) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const auto& [at_mm, square] : widths) {
    const double x = at_mm - middle_mm;
    const Eigen::Vector3d row(1.0, x, x * x);
    normal += row * row.transpose();
    right += row * square;
  }
  const Eigen::Vector3d fit = normal.ldlt().solve(right);
  if (!(fit(2) > 0.0)) throw std::runtime_error("focus: the width of the dots has no minimum");
  return middle_mm - 0.5 * fit(1) / fit(2);
}

/// The best of evenly spaced places.
double best_of_sweep(Session& session, double middle_mm, double range_mm, double& exposure_s) {
  const int steps = session.settings.focus_steps;
  double best_mm = middle_mm, best = 1e300;
  for (int step = 0; step < steps; ++step) {
    const double at_mm = middle_mm - range_mm + 2.0 * range_mm * step / (steps - 1);
    const double square = squared_width(session, at_mm, exposure_s, 5.0);
    if (square < best) best = square, best_mm = at_mm;
  }
  if (std::abs(best_mm - middle_mm) > 0.99 * range_mm)
    throw std::runtime_error(fmt::format("focus: the dots are narrowest at the end of the range, {:.3f} mm", best_mm));
  return best_mm;
}

}  // namespace

void find_display(Session& session) {
  show_coarse(session, 2);
  double exposure_s = 0.005;
  const CameraPicture picture = session.well_exposed(exposure_s, 2);
  DotWindow window;
  window.sigma_px = 4.0;
  window.half_width_px = std::clamp(session.bench.eye.height() / 30, 10, 18);
  window.search_px = 0.4 * 0.88 * session.bench.eye.width() / (kColumns - 1);
  const auto places = coarse_places(session);
  std::vector<Dot> dots;
  double light = 0.0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (k == kMissing) continue;
    const auto dot = coarse_dot(session, picture, places[k], window);
    if (dot) dots.push_back(session.dot_of(places[k], dot->centre_px)), light += dot->light_dn;
  }
  if (dots.size() < 15)
    throw std::runtime_error(
        fmt::format("the camera does not see the display: {} of {} dots were found", dots.size(), places.size() - 1));
  const auto absent = coarse_dot(session, picture, places[kMissing], window);
  if (absent && absent->light_dn > 0.3 * light / static_cast<double>(dots.size()))
    throw std::runtime_error("the display is mirrored or rotated: a dot is seen where none is shown");
  DisplayMapParameters map = session.map().parameters();
  map.field = {};
  map.lens = fit_lens(dots, map.lens, LensFreedom::kPose, 20.0).lens;
  map.lens = fit_lens(dots, map.lens, LensFreedom::kAll, 5.0).lens;
  session.set_map(map);
}

void focus(Session& session) {
  show_coarse(session, 1);
  double exposure_s = 0.005;
  const double coarse_mm =
      best_of_sweep(session, session.settings.display_mm, session.settings.focus_range_mm, exposure_s);
  show_coarse(session, 0);
  exposure_s = 0.005;
  std::vector<std::pair<double, double>> widths;
  const int steps = session.settings.fine_focus_steps;
  for (int step = 0; step < steps; ++step) {
    const double at_mm = coarse_mm + 0.12 * (2.0 * step / (steps - 1) - 1.0);
    widths.emplace_back(at_mm, squared_width(session, at_mm, exposure_s, 2.5));
  }
  const double focus_mm = vertex_mm(widths, coarse_mm);
  if (!(std::abs(focus_mm - coarse_mm) < 0.15)) throw std::runtime_error("focus: coarse and fine search disagree");
  const double square = squared_width(session, focus_mm, exposure_s, 2.5);
  session.result.validity.rail_lens_mm = session.settings.lens_mm;
  session.result.validity.rail_display_mm = focus_mm;
  session.report(fmt::format("focus at {:.4f} mm of the display's axis, width of a display pixel {:.3f} px", focus_mm,
                             std::sqrt(square)));
}

}  // namespace vbar::optical_stimulator::calibrate
