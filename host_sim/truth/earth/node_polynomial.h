#pragma once
// Interpolation of a smooth quantity known at equally spaced nodes: the polynomial of degree five through the six nodes
// around an interval.

namespace vbar::truth {

inline constexpr int kNodePoints = 6;
inline constexpr int kFirstNode = -2;  ///< the interval is [0, 1]; its nodes lie at -2, -1, 0, 1, 2, 3

/// Computes the coefficients, lowest power first, of the polynomial in the fraction of the interval through the values
/// at the nodes.
void fit_node_polynomial(const double (&values)[kNodePoints], double (&coefficients)[kNodePoints]);

/// Returns the value of such a polynomial at `t`.
inline double node_polynomial(const double (&coefficients)[kNodePoints], double t) {
  double sum = coefficients[kNodePoints - 1];
  for (int power = kNodePoints - 2; power >= 0; --power) sum = sum * t + coefficients[power];
  return sum;
}

}  // namespace vbar::truth
