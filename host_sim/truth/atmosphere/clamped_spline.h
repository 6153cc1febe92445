#pragma once
// A cubic spline with given slopes at both ends, through a few points, and its integral.

#include <array>

namespace vbar::truth {

/// Spline through N points at ascending x.
template <int N>
class ClampedSpline {
 public:
  using Points = std::array<double, N>;

  ClampedSpline() = default;

  ClampedSpline(const Points& x, const Points& y, double first_slope, double last_slope) : x_(x), y_(y) {
    // Continuity of the slope at each point: a tridiagonal system for the second derivatives, by elimination.
    Points factor, right;
    double slope_before = first_slope;
    double pivot_before = 0.0, span_before = 0.0;
    for (int i = 0; i < N; ++i) {
      const bool last = i == N - 1;
      const double span = last ? 0.0 : x[i + 1] - x[i];
      const double slope = last ? last_slope : (y[i + 1] - y[i]) / span;
      const double eliminate = i == 0 ? 0.0 : span_before / pivot_before;
      const double pivot = 2.0 * (span_before + span) - eliminate * span_before;
      right[i] = 6.0 * (slope - slope_before) - (i == 0 ? 0.0 : eliminate * right[i - 1]);
      factor[i] = pivot;
      slope_before = slope;
      span_before = span;
      pivot_before = pivot;
    }
    bend_[N - 1] = right[N - 1] / factor[N - 1];
    for (int i = N - 2; i >= 0; --i) bend_[i] = (right[i] - (x[i + 1] - x[i]) * bend_[i + 1]) / factor[i];

    integral_[0] = 0.0;
    for (int i = 0; i + 1 < N; ++i) integral_[i + 1] = integral_[i] + integral_within(i, x[i + 1]);
  }

  double value(double x) const {
    const int i = interval(x);
    const double h = x_[i + 1] - x_[i];
    const double a = (x_[i + 1] - x) / h, b = (x - x_[i]) / h;
    return a * y_[i] + b * y_[i + 1] + ((a * a * a - a) * bend_[i] + (b * b * b - b) * bend_[i + 1]) * h * h / 6.0;
  }

  /// Returns the integral from the first point to x.
  double integral(double x) const {
    const int i = interval(x);
    return integral_[i] + integral_within(i, x);
  }

 private:
  int interval(double x) const {
    int i = N - 2;
    while (i > 0 && x < x_[i]) --i;
    return i;
  }

  double integral_within(int i, double x) const {
    const double h = x_[i + 1] - x_[i];
    const double a = (x_[i + 1] - x) / h, b = (x - x_[i]) / h;
    const double aa = a * a, bb = b * b;
    const double line = 0.5 * ((1.0 - aa) * y_[i] + bb * y_[i + 1]);
    const double curve = (0.5 * aa - 0.25 * (aa * aa + 1.0)) * bend_[i] + (0.25 * bb * bb - 0.5 * bb) * bend_[i + 1];
    return h * (line + curve * h * h / 6.0);
  }

  Points x_{}, y_{};
  Points bend_{};      // second derivatives
  Points integral_{};  // up to each point
};

}  // namespace vbar::truth
