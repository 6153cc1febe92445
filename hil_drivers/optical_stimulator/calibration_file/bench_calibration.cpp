#include "hil_drivers/optical_stimulator/calibration_file/bench_calibration.h"

#include <algorithm>
#include <cmath>

namespace vbar::optical_stimulator {
namespace {

struct Cell {
  std::size_t index;
  double share;  ///< share of the next node
};

Cell cell_of(double coordinate, double first, double step, int nodes) {
  const double place = std::clamp((coordinate - first) / step, 0.0, nodes - 1.0);
  const double index = std::min(std::floor(place), std::max(nodes - 2.0, 0.0));
  return {static_cast<std::size_t>(index), place - index};
}

}  // namespace

double UniformityGrid::at(const fsw::Vector2& display_px) const {
  if (values.empty()) return 1.0;
  const Cell x = cell_of(display_px.x(), first_px.x(), step_px.x(), columns);
  const Cell y = cell_of(display_px.y(), first_px.y(), step_px.y(), rows);
  const auto width = static_cast<std::size_t>(columns);
  const std::size_t corner = y.index * width + x.index;
  const std::size_t right = columns > 1 ? 1 : 0, below = rows > 1 ? width : 0;
  const double upper = (1.0 - x.share) * values[corner] + x.share * values[corner + right];
  const double lower = (1.0 - x.share) * values[corner + below] + x.share * values[corner + below + right];
  return (1.0 - y.share) * upper + y.share * lower;
}

double CountsToLight::electrons_per_s(double count) const {
  if (!(count > first_count.value)) return 0.0;
  return full_pixel_electrons_per_s.value *
         std::pow((count - first_count.value) / (255.0 - first_count.value), gamma.value);
}

}  // namespace vbar::optical_stimulator
