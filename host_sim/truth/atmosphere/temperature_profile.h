#pragma once
// The gravity model of NRLMSISE-00: surface value and effective radius for the decrease with altitude, by latitude
// (Lambert's formula, as in the U.S. Standard Atmosphere 1976).

#include <array>
#include <cmath>

namespace vbar::truth {

struct LatitudeGravity {
  double surface = 0.0;    ///< cm/s^2
  double radius_km = 0.0;  ///< effective radius of the Earth

  explicit LatitudeGravity(double sin_latitude) {
    const double c = 1.0 - 2.0 * sin_latitude * sin_latitude;  // cosine of twice the latitude
    surface = 980.616 * (1.0 - 0.0026373 * c);
    radius_km = 2.0 * surface / (3.085462e-6 + 2.27e-9 * c) * 1e-5;
  }

  /// Returns gravity, cm/s^2.
  double at(double altitude_km) const {
    const double ratio = 1.0 + altitude_km / radius_km;
    return surface / (ratio * ratio);
  }

  /// Returns the geopotential altitude above `reference_km`, in km of gravity at the reference.
  double geopotential_km(double altitude_km, double reference_km) const {
    return (altitude_km - reference_km) * (radius_km + reference_km) / (radius_km + altitude_km);
  }
};

/// Gas constant of the model, in g cm^2 s^-2 mol^-1 K^-1 with heights in km.
inline constexpr double kModelGasConstant = 831.4;

// A cubic spline with given slopes at both ends, through a few points, and its integral.

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

// Temperature below 123 km in NRLMSISE-00: the reciprocal of temperature is a cubic spline in geopotential altitude
// through a few nodes, with given gradients at both ends; so the weight of the air above is an exact integral.

struct SplineLevel {
  double temperature = 0.0;  ///< K
  double weight = 0.0;       ///< minus the integral of g dz / (R T) from the top node, mol/g
};

/// Profile through N nodes, altitudes (km) descending; temperatures K; gradients K/km at the highest and the lowest
/// node.
template <int N>
class InverseTemperature {
 public:
  using Nodes = std::array<double, N>;

  InverseTemperature() = default;

  InverseTemperature(const LatitudeGravity& gravity, const Nodes& altitude_km, const Nodes& temperature,
                     double top_gradient, double bottom_gradient)
      : top_km_(altitude_km[0]), depth_(gravity.geopotential_km(altitude_km[N - 1], top_km_)) {
    Nodes x, y;
    for (int i = 0; i < N; ++i) {
      x[i] = gravity.geopotential_km(altitude_km[i], top_km_) / depth_;
      y[i] = 1.0 / temperature[i];
    }
    const double radii = (gravity.radius_km + altitude_km[N - 1]) / (gravity.radius_km + top_km_);
    spline_ = ClampedSpline<N>(x, y, -top_gradient * y[0] * y[0] * depth_,
                               -bottom_gradient * y[N - 1] * y[N - 1] * depth_ * radii * radii);
    weight_ = gravity.at(top_km_) * depth_ / kModelGasConstant;
  }

  SplineLevel at(const LatitudeGravity& gravity, double altitude_km) const {
    const double x = gravity.geopotential_km(altitude_km, top_km_) / depth_;
    return {1.0 / spline_.value(x), -weight_ * spline_.integral(x)};
  }

 private:
  double top_km_ = 0.0;
  double depth_ = 0.0;   // geopotential km, negative
  double weight_ = 0.0;  // weight of the whole depth at 1 K
  ClampedSpline<N> spline_;
};

// The temperature profile of NRLMSISE-00 from 72.5 km up, with the quantities of diffusive equilibrium. Above 123 km it
// is Bates's: exponential in geopotential altitude, for which equilibrium has a closed form (Walker 1965); below, a
// spline.

/// Temperature profile T(z) = exospheric - (exospheric - boundary) exp(-shape * geopotential altitude above the
/// boundary).
struct BatesProfile {
  double exospheric = 0.0;   ///< K
  double boundary = 0.0;     ///< K, at boundary_km
  double shape = 0.0;        ///< 1/km
  double boundary_km = 0.0;  ///< 120 km
};

/// Nodes of the profile below the joint with Bates's.
struct LowerThermosphereNodes {
  std::array<double, 5> altitude_km{};  ///< the joint (123.4 km), 110, 100, 90, 72.5
  std::array<double, 4> temperature{};  ///< K, at the lower four
  double bottom_gradient = 0.0;         ///< K/km, at the lowest
};

/// Level of the profile. A species of molar mass M and thermal diffusion coefficient alpha in equilibrium has, relative
/// to the boundary,
///   ln n = (1 + alpha) log_cooling + M weight.
struct ThermosphereLevel {
  double temperature = 0.0;  ///< K
  double log_cooling = 0.0;  ///< ln(T at the boundary / T)
  double weight = 0.0;       ///< minus the integral of g dz / (R T) from the boundary, mol/g
};

/// Returns the level of Bates's profile at an altitude, the joint or above.
ThermosphereLevel bates_level(const LatitudeGravity& gravity, const BatesProfile& bates, double altitude_km);

class ThermosphereTemperature {
 public:
  ThermosphereTemperature(const LatitudeGravity& gravity, const BatesProfile& bates,
                          const LowerThermosphereNodes& nodes);

  /// Returns the level at 72.5 km or above.
  ThermosphereLevel at(double altitude_km) const;

 private:
  LatitudeGravity gravity_;
  BatesProfile bates_;
  double joint_km_;
  ThermosphereLevel joint_;
  InverseTemperature<5> below_;
};

}  // namespace vbar::truth
