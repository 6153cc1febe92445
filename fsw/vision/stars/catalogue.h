#pragma once
// The star catalogue on board: ESA's Hipparcos catalogue to V 8 (data/stars), propagated to one epoch at build time,
// with pairs closer than 70 arcsec merged. A star is its number, 0 to catalogue_size() - 1.

#include <cstddef>
#include <span>

#include "fsw/core/result.h"
#include "fsw/core/types.h"

namespace vbar::fsw::stars {

int catalogue_size();
/// Returns the Julian year of the positions.
double catalogue_epoch();

/// Returns the unit vector in GCRF (to 1e-9) as seen from the solar-system barycentre: without aberration. `star` must
/// be in range.
Vector3 star_direction_eci(int star);
/// Returns the magnitude in Johnson V.
double star_magnitude(int star);
/// Returns the Hipparcos number; 0 for the few stars without one.
int star_hipparcos(int star);

/// Writes the stars within `radius` (rad, at most 0.5) of a unit vector to `found` up to its size; returns their
/// number. kOutOfRange for a larger radius, kNotFinite.
Result<int> stars_in_cone(const Vector3& axis_eci, double radius, std::span<int> found);

}  // namespace vbar::fsw::stars
