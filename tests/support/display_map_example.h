#pragma once
// A display map with every term: lens terms of the size of a bench's, and a field of degree 16.

#include <cmath>

#include "hil_drivers/optical_stimulator/display_map/display_map.h"

namespace vbar::optical_stimulator {

inline DisplayMapParameters display_map_example() {
  DisplayMapParameters parameters;
  parameters.lens.centre_px = {973.1, 590.2};
  parameters.lens.scale_px = 5952.4;
  parameters.lens.rotation_rad = 2.5e-3;
  parameters.lens.tilt_rad = {4e-3, -6e-3};
  parameters.lens.distortion = {0.9, -0.6, -1e-3, 7e-4, 2.0};
  ChebyshevField& field = parameters.field;
  field.degree = ChebyshevField::kDegreeMax;
  field.low_px = {6.0, 4.0};
  field.high_px = {1911.0, 1193.0};
  for (std::size_t k = 0; k < ChebyshevField::term_count(field.degree); ++k) {
    field.x_px.push_back(0.1 * std::sin(3.0 * static_cast<double>(k) + 1.0));
    field.y_px.push_back(0.1 * std::cos(5.0 * static_cast<double>(k)));
  }
  return parameters;
}

}  // namespace vbar::optical_stimulator
