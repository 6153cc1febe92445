// Noise and gain of the camera, counts to light, evenness of the field.

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "hil_drivers/optical_stimulator/calibrate/camera_noise.h"
#include "hil_drivers/optical_stimulator/calibrate/light_fit.h"
#include "hil_drivers/optical_stimulator/calibrate/session.h"

namespace vbar::optical_stimulator::calibrate {
namespace {

using fsw::Vector2;

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
