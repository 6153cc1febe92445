#include "hil_drivers/optical_stimulator/display_map/chebyshev_field.h"

#include <algorithm>
#include <array>

namespace vbar::optical_stimulator {
namespace {

using fsw::Vector2;

struct Polynomials {
  std::array<double, ChebyshevField::kDegreeMax + 1> value{}, slope{};  // T_n and dT_n by the display coordinate
};

/// T_0 to T_degree at a coordinate, constant beyond the domain.
Polynomials polynomials(double coordinate, double low, double high, int degree) {
  const double half = 0.5 * (high - low), raw = (coordinate - 0.5 * (low + high)) / half;
  const double u = std::clamp(raw, -1.0, 1.0), u_slope = raw == u ? 1.0 / half : 0.0;
  Polynomials p;
  p.value[0] = 1.0;
  if (degree < 1) return p;
  p.value[1] = u;
  p.slope[1] = u_slope;
  for (std::size_t n = 2; n <= static_cast<std::size_t>(degree); ++n) {
    p.value[n] = 2.0 * u * p.value[n - 1] - p.value[n - 2];
    p.slope[n] = 2.0 * (u_slope * p.value[n - 1] + u * p.slope[n - 1]) - p.slope[n - 2];
  }
  return p;
}

template <typename Visit>
void for_each_term(int degree, const Visit& visit) {
  std::size_t term = 0;
  for (int sum = 0; sum <= degree; ++sum)
    for (int j = 0; j <= sum; ++j) visit(term++, static_cast<std::size_t>(sum - j), static_cast<std::size_t>(j));
}

}  // namespace

ChebyshevTerms chebyshev_terms(const ChebyshevField& field, const Vector2& pixel) {
  const Polynomials x = polynomials(pixel.x(), field.low_px.x(), field.high_px.x(), field.degree);
  const Polynomials y = polynomials(pixel.y(), field.low_px.y(), field.high_px.y(), field.degree);
  const std::size_t count = ChebyshevField::term_count(field.degree);
  ChebyshevTerms terms{std::vector<double>(count), std::vector<double>(count), std::vector<double>(count)};
  for_each_term(field.degree, [&](std::size_t term, std::size_t i, std::size_t j) {
    terms.value[term] = x.value[i] * y.value[j];
    terms.by_x[term] = x.slope[i] * y.value[j];
    terms.by_y[term] = x.value[i] * y.slope[j];
  });
  return terms;
}

FieldValue value_of(const ChebyshevField& field, const Vector2& pixel) {
  FieldValue result;
  if (field.degree < 0) return result;
  const Polynomials x = polynomials(pixel.x(), field.low_px.x(), field.high_px.x(), field.degree);
  const Polynomials y = polynomials(pixel.y(), field.low_px.y(), field.high_px.y(), field.degree);
  for_each_term(field.degree, [&](std::size_t term, std::size_t i, std::size_t j) {
    const Vector2 coefficient(field.x_px[term], field.y_px[term]);
    result.offset_px += coefficient * (x.value[i] * y.value[j]);
    result.jacobian.col(0) += coefficient * (x.slope[i] * y.value[j]);
    result.jacobian.col(1) += coefficient * (x.value[i] * y.slope[j]);
  });
  return result;
}

}  // namespace vbar::optical_stimulator
