#pragma once
// Smooth vector field on a rectangle of the display: the part of the testbed's geometry that no lens model represents.

#include <cstddef>
#include <vector>

#include "fsw/core/types.h"

namespace vbar::optical_stimulator {

/// Sums products T_i(u) T_j(v) of Chebyshev polynomials with i + j <= degree, one sum for each axis; u and v run
/// from -1 to 1 over the domain. Outside the domain the field has the value of the nearest point of its edge:
/// polynomials diverge where no dot was measured.
struct ChebyshevField {
  static constexpr int kDegreeMax = 16;

  int degree = -1;                ///< -1: no field
  fsw::Vector2 low_px{0.0, 0.0};  ///< domain, display pixels
  fsw::Vector2 high_px{1.0, 1.0};
  std::vector<double> x_px, y_px;  ///< coefficients in the order of chebyshev_terms()

  [[nodiscard]] static std::size_t term_count(int degree) {
    return degree < 0 ? 0 : static_cast<std::size_t>((degree + 1) * (degree + 2) / 2);
  }
};

/// Holds values of the products at a display point and their derivatives by its coordinates, 1/px.
struct ChebyshevTerms {
  std::vector<double> value, by_x, by_y;
};

/// Returns the terms in the order (0,0), (1,0), (0,1), (2,0), (1,1), (0,2), ...: by i + j, then by j.
[[nodiscard]] ChebyshevTerms chebyshev_terms(const ChebyshevField& field, const fsw::Vector2& pixel);

struct FieldValue {
  fsw::Vector2 offset_px = fsw::Vector2::Zero();
  fsw::Matrix2 jacobian = fsw::Matrix2::Zero();  ///< derivative of the offset by the display point
};

[[nodiscard]] FieldValue value_of(const ChebyshevField& field, const fsw::Vector2& pixel);

}  // namespace vbar::optical_stimulator
