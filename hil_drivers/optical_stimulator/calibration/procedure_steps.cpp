// A coarse map of the display, and the focus by the least width of its dots.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "hil_drivers/optical_stimulator/calibration/geometry_fit.h"
#include "hil_drivers/optical_stimulator/calibration/light_fit.h"
#include "hil_drivers/optical_stimulator/calibration/procedure.h"
#include "host_sim/engine/random_stream.h"

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

// The display map by a grid of dots, and its residuals on dots held out.

namespace {

constexpr double kDotSigma_px = 0.7;       // display pixels
constexpr double kRenderedSigma_px = 0.5;  // width of a star in a rendered picture
constexpr double kEdge_px = 8.0;           // border of the display, free of dots

struct MeasuredDots {
  std::vector<Dot> dots;
  std::vector<double> sigma_px;
};

/// Light of a dot whose peak is well below saturation at the flight's exposure, in full pixels.
double dot_full_pixels(const Session& session, const Vector2& display_px) {
  constexpr double kPeakShare = 0.45, kCameraSigma2_px2 = 0.9 * 0.9;
  const CameraFigures& camera = session.result.camera;
  const double peak = kPeakShare * (session.range_dn() - camera.offset_dn.value) / camera.gain_dn_per_electron.value;
  const double electrons = peak * 2.0 * std::numbers::pi * (kDotSigma_px * kDotSigma_px + kCameraSigma2_px2);
  return electrons / (session.result.full_pixel_electrons_per_s(display_px) * session.settings.camera.exposure_s);
}

/// Shows dots at the places and measures those that the detector sees.
void measure(Session& session, const std::vector<Vector2>& places, double search_px, MeasuredDots& measured) {
  Picture counts = Picture(session.bench.screen.width(), session.bench.screen.height());
  std::vector<DrawnDot> drawn;
  for (const Vector2& place : places)
    if (const auto dot = draw_dot(counts, place, kDotSigma_px, dot_full_pixels(session, place), session.response))
      drawn.push_back(*dot);
  session.bench.screen.show(counts);
  const CameraPicture picture = session.picture(session.settings.camera.exposure_s, session.settings.frames);
  DotWindow window;
  window.search_px = search_px;
  int visible = 0, found = 0;
  for (const DrawnDot& dot : drawn) {
    const Vector2 expected = session.expected_px(dot.centre_px);
    if (!session.is_on_detector(expected, window.half_width_px)) continue;
    ++visible;
    const auto seen = measure_dot(picture, expected, window);
    if (!seen || session.is_saturated(seen->peak_dn)) continue;
    ++found;
    measured.dots.push_back(session.dot_of(dot.centre_px, seen->centre_px));
    measured.sigma_px.push_back(seen->sigma_px);
  }
  if (found < 0.9 * visible)
    throw std::runtime_error(fmt::format("geometry: {} of {} dots were found", found, visible));
}

MeasuredDots measure_grid(Session& session) {
  const GridSize grid = session.settings.geometry_grid;
  const double width = session.bench.screen.width() - 1.0 - 2.0 * kEdge_px,
               height = session.bench.screen.height() - 1.0 - 2.0 * kEdge_px;
  MeasuredDots measured;
  for (int phase = 0; phase < 2; ++phase) {
    std::vector<Vector2> places;
    for (int row = 0; row < grid.rows; ++row)
      for (int column = (row + phase) % 2; column < grid.columns; column += 2)
        places.push_back({kEdge_px + width * column / (grid.columns - 1), kEdge_px + height * row / (grid.rows - 1)});
    measure(session, places, 8.0, measured);
  }
  return measured;
}

/// One dot at a random place in each cell of a grid, away from the cell's border.
MeasuredDots measure_held_out(Session& session) {
  const GridSize grid = session.settings.held_out_grid;
  const double width = session.bench.screen.width() - 1.0, height = session.bench.screen.height() - 1.0;
  engine::RandomStream random(session.settings.seed, "calibration/held_out");
  std::vector<Vector2> places;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const double u = 0.15 + 0.7 * random.uniform(), v = 0.15 + 0.7 * random.uniform();
      places.push_back({(column + u) * width / grid.columns, (row + v) * height / grid.rows});
    }
  MeasuredDots measured;
  measure(session, places, 4.0, measured);
  return measured;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Image of a rendered point from that of the measured dots; before the width of a camera pixel, as in OpticsSettings.
Figure point_spread(const Session& session, const std::vector<double>& widths_px) {
  const double pixels = session.settings.camera.focal_length_px() / session.map().focal_length_px();
  const double width = median(widths_px);
  const double drawn2 = (kDotSigma_px * kDotSigma_px - kRenderedSigma_px * kRenderedSigma_px) * pixels * pixels;
  const double sigma = std::sqrt(std::max(0.01, width * width - drawn2 - 1.0 / 12.0));
  std::vector<double> deviations;
  for (const double w : widths_px) deviations.push_back(std::abs(w - width));
  return {sigma, 1.4826 * median(deviations) / std::sqrt(static_cast<double>(widths_px.size()))};
}

/// rms an axis of the residuals in the region, camera pixels.
double centroid_floor(const Session& session, const std::vector<Residual>& residuals) {
  double sum = 0.0;
  for (const Residual& residual : residuals) sum += residual.error_arcsec.squaredNorm();
  const double rms_arcsec = std::sqrt(0.5 * sum / static_cast<double>(std::max<std::size_t>(1, residuals.size())));
  return rms_arcsec / kArcsecPerRad * session.settings.camera.focal_length_px();
}

}  // namespace

void measure_geometry(Session& session) {
  const MeasuredDots grid = measure_grid(session);
  StimulatorCalibration& result = session.result;
  const GeometryFit fit = fit_geometry(grid.dots, session.map().parameters());
  result.geometry = fit.map;
  result.lens_sigma = fit.lens_sigma;
  result.field_sigma_px = fit.field_sigma_px;
  session.set_map(fit.map);
  result.camera.point_spread_sigma_px = point_spread(session, grid.sigma_px);
  session.report(fmt::format("geometry: {} of {} dots, field of degree {}", fit.dots_used, grid.dots.size(),
                             fit.map.field.degree));

  const MeasuredDots held_out = measure_held_out(session);
  result.held_out = held_out_residuals(fit.map, held_out.dots, session.settings.camera.region);
  session.residuals = residuals_of(session.map(), held_out.dots);
  result.centroid_floor_px = centroid_floor(session, in_region(session.residuals, session.settings.camera.region));
  const HeldOutResiduals& held = result.held_out;
  session.report(
      fmt::format("held-out dots: region {:.2f} arcsec (95 % {:.2f}), detector {:.2f} (95 % {:.2f}); lens terms alone "
                  "{:.2f} and {:.2f} arcsec",
                  held.region.mean_arcsec, held.region.p95_arcsec, held.detector.mean_arcsec, held.detector.p95_arcsec,
                  held.region_lens_terms.mean_arcsec, held.detector_lens_terms.mean_arcsec));
}

// Noise and gain of the camera, counts to light, evenness of the field.

namespace {

constexpr int kSquareHalf = 2;
constexpr std::array<int, 24> kLevels{255, 225, 200, 175, 150, 130, 110, 95, 80, 68, 57, 48,
                                      40,  34,  29,  25,  21,  18,  15,  13, 11, 9,  8,  7};

FramePair pair_of(Session& session, double exposure_s) {
  return {session.bench.eye.take(exposure_s), session.bench.eye.take(exposure_s)};
}

MeanVariance mean_variance_of(Session& session, double exposure_s) {
  return mean_variance(pair_of(session, exposure_s), session.bench.eye.width(), session.bench.eye.height());
}

/// Standard deviation of a dot's light, electrons.
double light_sigma(const Session& session, double electrons, double exposure_s, int frames, const DotWindow& window) {
  const CameraFigures& camera = session.result.camera;
  const double pixels = std::pow(2.0 * window.half_width_px + 1.0, 2.0);
  const double noise =
      std::pow(camera.read_noise_electrons.value, 2.0) + camera.background_electrons_per_s.value * exposure_s;
  return std::sqrt((pixels * noise + std::max(electrons, 0.0)) / frames);
}

/// Grey where the noise is measured, and around it as far as the display may be displaced.
Picture grey_middle(int width, int height, std::uint8_t count) {
  constexpr double kShare = kNoiseShare + 0.1;
  Picture picture(width, height);
  for (int y = static_cast<int>(0.5 * (1.0 - kShare) * height); y < 0.5 * (1.0 + kShare) * height; ++y)
    for (int x = static_cast<int>(0.5 * (1.0 - kShare) * width); x < 0.5 * (1.0 + kShare) * width; ++x)
      picture.at(x, y) = count;
  return picture;
}

/// Squares of the places at one level, and their light. `exposure_s` starts near and returns the one used.
void measure_level(Session& session, const std::vector<Vector2>& places, int level, double& exposure_s,
                   std::vector<SquareLight>& squares) {
  Picture counts = Picture(session.bench.screen.width(), session.bench.screen.height());
  for (const Vector2& place : places)
    draw_square(counts, static_cast<int>(place.x()), static_cast<int>(place.y()), kSquareHalf,
                static_cast<std::uint8_t>(level), session.response);
  session.bench.screen.show(counts);
  const int frames = level < 30 ? 4 : 2;
  const CameraPicture picture = session.well_exposed(exposure_s, frames);
  DotWindow window;
  window.search_px = 5.0;
  window.sigma_px = 2.5;
  window.peak_min_dn = 3.0;
  constexpr double kPixels = (2 * kSquareHalf + 1) * (2 * kSquareHalf + 1);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto dot = measure_dot(picture, session.expected_px(places[k]), window);
    if (!dot || session.is_saturated(dot->peak_dn)) continue;
    const double electrons = dot->light_dn / session.result.camera.gain_dn_per_electron.value;
    const double sigma = light_sigma(session, electrons, exposure_s, frames, window);
    squares.push_back({static_cast<int>(k), static_cast<double>(level), electrons / exposure_s / kPixels,
                       sigma / exposure_s / kPixels});
  }
}

void measure_response(Session& session) {
  const double width = session.bench.screen.width(), height = session.bench.screen.height();
  std::vector<Vector2> places;
  for (const double y : {0.2, 0.5, 0.8})
    for (const double x : {0.2, 0.5, 0.8}) places.push_back({std::round(x * width), std::round(y * height)});
  std::vector<SquareLight> squares;
  double exposure_s = 0.002;
  int last = kLevels.front();
  for (std::size_t k = 0; k < kLevels.size(); k += static_cast<std::size_t>(session.settings.count_level_step)) {
    const int level = kLevels[k];
    exposure_s *= session.response.luminance(last) / std::max(1e-6, session.response.luminance(level));
    exposure_s = std::clamp(exposure_s, session.settings.exposure_min_s, session.settings.exposure_max_s);
    measure_level(session, places, level, exposure_s, squares);
    last = level;
  }
  const ResponseFit fit = fit_response(squares, static_cast<int>(places.size()));
  CountsToLight& light = session.result.light;
  light.gamma = fit.gamma;
  light.first_count = fit.first_count;
  light.residual = fit.residual;
  session.response = {fit.gamma.value, fit.first_count.value};
  session.report(fmt::format("counts to light: gamma {:.4f} +- {:.4f}, first count {:.3f} +- {:.3f}, residual {:.2f} %",
                             fit.gamma.value, fit.gamma.sigma, fit.first_count.value, fit.first_count.sigma,
                             100.0 * fit.residual));
}

void add_uniformity_places(Session& session, double offset, std::vector<PlaceLight>& places) {
  const GridSize grid = session.settings.uniformity_grid;
  const double width = session.bench.screen.width(), height = session.bench.screen.height();
  Picture counts = Picture(session.bench.screen.width(), session.bench.screen.height());
  std::vector<DrawnDot> drawn;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const int x = static_cast<int>((column + offset) / grid.columns * width),
                y = static_cast<int>((row + offset) / grid.rows * height);
      drawn.push_back(draw_square(counts, x, y, kSquareHalf, 120, session.response));
    }
  session.bench.screen.show(counts);
  double exposure_s = 0.005;
  const CameraPicture picture = session.well_exposed(exposure_s, 2);
  DotWindow window;
  window.search_px = 5.0;
  window.sigma_px = 2.5;
  for (const DrawnDot& square : drawn) {
    const auto dot = measure_dot(picture, session.expected_px(square.centre_px), window);
    if (!dot || session.is_saturated(dot->peak_dn)) continue;
    const double electrons = dot->light_dn / session.result.camera.gain_dn_per_electron.value;
    places.push_back({square.centre_px, electrons / exposure_s / square.full_pixels});
  }
}

void measure_uniformity(Session& session) {
  std::vector<PlaceLight> places;
  for (const double offset : {0.3, 0.7}) add_uniformity_places(session, offset, places);
  const UniformityFit fit = fit_uniformity(places, session.bench.screen.width(), session.bench.screen.height(), 4);
  session.result.uniformity = fit.grid;
  CountsToLight& light = session.result.light;
  light.full_pixel_electrons_per_s = {fit.mean_electrons_per_s, fit.mean_electrons_per_s * fit.grid.sigma};
  const auto [low, high] = std::minmax_element(fit.grid.values.begin(), fit.grid.values.end());
  session.report(fmt::format("full pixel: {:.4e} electrons/s on average, {:.3f} to {:.3f} over the display",
                             fit.mean_electrons_per_s, *low, *high));
}

/// The camera file's dark current is the only light that a black display does not explain.
void estimate_black_pixel(Session& session) {
  const Figure& background = session.result.camera.background_electrons_per_s;
  const double pixels = session.settings.camera.focal_length_px() / session.map().focal_length_px();
  const double area = pixels * pixels;  // size of a display pixel, in camera pixels
  session.result.light.black_pixel_electrons_per_s = {
      area * (background.value - session.settings.camera.detector.dark_electrons_per_s), area * background.sigma};
}

}  // namespace

void measure_noise(Session& session) {
  constexpr int kFrames = 4;
  session.bench.screen.show(Picture(session.bench.screen.width(), session.bench.screen.height()));
  const double long_s = session.settings.camera.exposure_s, short_s = 0.05 * long_s;
  const MeanVariance noise = mean_variance_of(session, short_s);
  session.camera_noise_dn = std::sqrt(std::max(noise.variance_dn2, 1e-6));
  const CameraPicture short_exposure = session.picture(short_s, kFrames),
                      long_exposure = session.picture(long_s, kFrames);
  const BlackFit fit =
      fit_black(short_exposure, short_s, long_exposure, long_s, session.camera_noise_dn * std::sqrt(2.0 / kFrames));
  CameraFigures& camera = session.result.camera;
  camera.bits = session.bench.eye.bits();
  camera.offset_dn = fit.offset_dn;
  camera.background_electrons_per_s = fit.background_dn_per_s;  // in DN until the gain is known
  camera.hot_pixels = fit.hot_pixels;
  session.report(fmt::format("offset {:.2f} DN, {} hot pixels", fit.offset_dn.value, fit.hot_pixels.size()));
}

void measure_gain(Session& session) {
  const int width = session.bench.screen.width(), height = session.bench.screen.height();
  session.bench.screen.show(Picture(width, height));
  const MeanVariance black = mean_variance_of(session, 0.05 * session.settings.camera.exposure_s);
  session.bench.screen.show(grey_middle(width, height, 30));
  double exposure_s = 0.02;
  static_cast<void>(session.well_exposed(exposure_s, 1));
  std::vector<MeanVariance> grey;
  const int levels = session.settings.grey_levels;
  for (int level = 1; level <= levels; ++level) grey.push_back(mean_variance_of(session, exposure_s * level / levels));
  const GainFit fit = fit_gain(black, grey);
  CameraFigures& camera = session.result.camera;
  camera.gain_dn_per_electron = fit.gain_dn_per_electron;
  camera.read_noise_electrons = fit.read_noise_electrons;
  const double gain = fit.gain_dn_per_electron.value;
  camera.background_electrons_per_s.value /= gain;
  camera.background_electrons_per_s.sigma /= gain;
  for (HotPixel& hot : camera.hot_pixels) hot.electrons_per_s /= gain;
  session.report(fmt::format(
      "gain {:.5f} +- {:.5f} DN/electron, read noise {:.2f} electrons, background {:.1f} electrons/s", gain,
      fit.gain_dn_per_electron.sigma, fit.read_noise_electrons.value, camera.background_electrons_per_s.value));
}

void measure_light(Session& session) {
  measure_response(session);
  measure_uniformity(session);
  estimate_black_pixel(session);
}

}  // namespace vbar::optical_stimulator::calibrate
