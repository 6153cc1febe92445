#include "fsw/vision/stars/catalogue.h"

#include "fsw/math/math.h"
#include "fsw/vision/stars/star_tables.h"

namespace vbar::fsw::stars {

int catalogue_size() {
  return kTableStars;
}

double catalogue_epoch() {
  return kTableEpoch;
}

Vector3 star_direction_eci(int star) {
  const std::array<std::int32_t, 3>& d = vbar_star_tables.direction[static_cast<std::size_t>(star)];
  return {d[0] * kDirectionUnit, d[1] * kDirectionUnit, d[2] * kDirectionUnit};
}

double star_magnitude(int star) {
  return vbar_star_tables.millimagnitude[static_cast<std::size_t>(star)] * 1e-3;
}

int star_hipparcos(int star) {
  return vbar_star_tables.hipparcos[static_cast<std::size_t>(star)];
}

Result<int> stars_in_cone(const Vector3& axis_eci, double radius, std::span<int> found) {
  constexpr double kLargest = 0.5;
  if (!math::is_finite(axis_eci.sum()) || !math::is_finite(radius)) return Status::kNotFinite;
  if (radius < 0.0 || radius > kLargest) return Status::kOutOfRange;
  const double reach = 2.0 * math::sin(0.5 * radius);
  const double cell_reach = 2.0 * math::sin(0.5 * (radius + kCoarseRadius));
  std::size_t count = 0;
  for (int cell = 0; cell < kCoarseCells; ++cell) {
    const CellMiddle m = middle_of_cell(cell, kCoarseEdge);
    const Vector3 middle = Vector3(m.x, m.y, m.z).normalized();
    if ((middle - axis_eci).squaredNorm() > cell_reach * cell_reach) continue;
    const auto& first = vbar_star_tables.first_of_coarse_cell;
    const int end = first[static_cast<std::size_t>(cell) + 1];
    for (int star = first[static_cast<std::size_t>(cell)]; star < end; ++star) {
      if ((star_direction_eci(star) - axis_eci).squaredNorm() > reach * reach) continue;
      if (count == found.size()) return static_cast<int>(count);
      found[count++] = star;
    }
  }
  return static_cast<int>(count);
}

}  // namespace vbar::fsw::stars
