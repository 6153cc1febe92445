#pragma once
// Gauss-Legendre quadrature with 32 points: exact for polynomials of degree 63, and for the smooth integrands of flight
// code as good as rounding allows.

#include <array>

namespace vbar::fsw::math {

/// Positive node of the symmetric rule on [-1, 1], and its weight.
struct QuadratureNode {
  double x, weight;
};

/// Abramowitz & Stegun 25.4.30, n = 32; recomputed to 40 digits.
inline constexpr std::array<QuadratureNode, 16> kGaussLegendre32{{
    {0.04830766568773832, 0.0965400885147278},
    {0.1444719615827965, 0.09563872007927486},
    {0.23928736225213706, 0.09384439908080457},
    {0.33186860228212767, 0.09117387869576389},
    {0.42135127613063533, 0.08765209300440381},
    {0.5068999089322294, 0.08331192422694675},
    {0.5877157572407623, 0.07819389578707031},
    {0.6630442669302152, 0.0723457941088485},
    {0.7321821187402897, 0.06582222277636185},
    {0.7944837959679424, 0.058684093478535544},
    {0.84936761373257, 0.050998059262376175},
    {0.8963211557660521, 0.04283589802222668},
    {0.9349060759377397, 0.03427386291302143},
    {0.9647622555875064, 0.02539206530926206},
    {0.9856115115452684, 0.01627439473090567},
    {0.9972638618494816, 0.007018610009470096},
}};

/// Returns the integral of f over [a, b].
template <class F>
double integrate(const F& f, double a, double b) {
  const double middle = 0.5 * (a + b);
  const double half = 0.5 * (b - a);
  double sum = 0.0;
  for (const QuadratureNode& node : kGaussLegendre32) {
    sum += node.weight * (f(middle - half * node.x) + f(middle + half * node.x));
  }
  return half * sum;
}

}  // namespace vbar::fsw::math
