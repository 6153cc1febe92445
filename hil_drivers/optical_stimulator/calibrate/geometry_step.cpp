// The display map by a grid of dots, and its residuals on dots held out.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "hil_drivers/optical_stimulator/calibrate/geometry_fit.h"
#include "hil_drivers/optical_stimulator/calibrate/goals.h"
#include "hil_drivers/optical_stimulator/calibrate/session.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::optical_stimulator::calibrate {
namespace {

using fsw::Vector2;

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
  BenchCalibration& result = session.result;
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

}  // namespace vbar::optical_stimulator::calibrate
