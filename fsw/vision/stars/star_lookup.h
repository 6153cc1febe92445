#pragma once
// Search for the star of the catalogue in a direction. For the code of this folder.

#include "fsw/vision/stars/catalogue.h"
#include "fsw/vision/stars/star_tables.h"

namespace vbar::fsw::stars {

/// Tolerance of observed magnitudes. Bright stars saturate a detector, so that an object may be fainter by any amount
/// than a star brighter than kSaturating.
struct MagnitudeGate {
  double offset = 0.0;  ///< median offset of observed magnitudes
  double width = 2.0;

  [[nodiscard]] bool admits(double observed, double catalogue) const {
    constexpr double kSaturating = 4.0;
    const double excess = observed - offset - catalogue;
    return excess >= -width && (excess <= width || catalogue < kSaturating);
  }
};

/// Returns false if there is no star within kCellMargin of a direction.
inline bool is_occupied(const Vector3& direction_eci) {
  const int cell = cell_of(direction_eci.x(), direction_eci.y(), direction_eci.z(), kOccupancyEdge);
  return (vbar_star_tables.occupied[static_cast<std::size_t>(cell / 32)] >> (cell % 32) & 1U) != 0;
}

struct Neighbour {
  int star = -1;  ///< -1: none
  double squared_distance = 0.0;
};

/// Returns the star nearest to a direction (unit vector, without aberration), not farther than `tolerance` (rad, at
/// most kCellMargin), whose magnitude the gate admits.
inline Neighbour nearest_star(const Vector3& direction_eci, double tolerance, double magnitude,
                              const MagnitudeGate& gate) {
  Neighbour nearest{-1, tolerance * tolerance};
  if (!is_occupied(direction_eci)) return nearest;
  const auto cell =
      static_cast<std::size_t>(cell_of(direction_eci.x(), direction_eci.y(), direction_eci.z(), kFineEdge));
  const std::uint32_t end = vbar_star_tables.first_of_cell[cell + 1];
  for (std::uint32_t entry = vbar_star_tables.first_of_cell[cell]; entry < end; ++entry) {
    const int star = vbar_star_tables.cell_star[entry];
    const double squared = (star_direction_eci(star) - direction_eci).squaredNorm();
    if (squared <= nearest.squared_distance && gate.admits(magnitude, star_magnitude(star))) nearest = {star, squared};
  }
  return nearest;
}

/// Returns the direction in which a star is seen by an observer moving at velocity / c (first order; 0.003 arcsec at
/// Earth's speed). The next function is its inverse.
inline Vector3 with_aberration(const Vector3& direction, const Vector3& velocity_over_c) {
  return (direction + velocity_over_c) * (1.0 - direction.dot(velocity_over_c));
}
inline Vector3 without_aberration(const Vector3& direction, const Vector3& velocity_over_c) {
  return (direction - velocity_over_c) * (1.0 + direction.dot(velocity_over_c));
}

}  // namespace vbar::fsw::stars
