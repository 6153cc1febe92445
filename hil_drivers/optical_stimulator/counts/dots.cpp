#include "hil_drivers/optical_stimulator/counts/dots.h"

#include <algorithm>
#include <cmath>

#include "hil_drivers/optical_stimulator/counts/match_counts.h"

namespace vbar::optical_stimulator {
namespace {

/// Returns the integral of a unit Gaussian over the pixel at that distance from its centre.
double pixel_integral(double distance, double sigma) {
  const double scale = 1.0 / (std::sqrt(2.0) * sigma);
  return 0.5 * (std::erf((distance + 0.5) * scale) - std::erf((distance - 0.5) * scale));
}

}  // namespace

bool draw_dot(const DisplayLight& light, const fsw::Vector2& centre, double sigma_px, double electrons,
              Picture& picture) {
  if (!centre.allFinite() || std::abs(centre.x()) > 1e6 || std::abs(centre.y()) > 1e6) return false;
  const int x = static_cast<int>(std::lround(centre.x())), y = static_cast<int>(std::lround(centre.y()));
  if (!picture.holds(x - kPatchReach, y - kPatchReach) || !picture.holds(x + kPatchReach, y + kPatchReach))
    return false;
  Patch<double> wanted;
  std::array<double, kPatchSide> columns, rows;
  for (int k = 0; k < kPatchSide; ++k) {
    columns[static_cast<std::size_t>(k)] = pixel_integral(x - kPatchReach + k - centre.x(), sigma_px);
    rows[static_cast<std::size_t>(k)] = pixel_integral(y - kPatchReach + k - centre.y(), sigma_px);
  }
  double across = 0.0, down = 0.0;  // all of the light is shown, the tails included
  for (const double part : columns) across += part;
  for (const double part : rows) down += part;
  for (std::size_t k = 0; k < wanted.size(); ++k)
    wanted[k] = electrons * columns[k % kPatchSide] * rows[k / kPatchSide] / (across * down);
  const auto counts = matched_counts(light, x, y, wanted);
  for (std::size_t k = 0; k < counts.size(); ++k)
    picture.at(x - kPatchReach + static_cast<int>(k % kPatchSide), y - kPatchReach + static_cast<int>(k / kPatchSide)) =
        counts[k];
  return true;
}

}  // namespace vbar::optical_stimulator
