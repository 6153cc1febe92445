#pragma once
// Block of the relative orbit: osculating ROE of the target with respect to the servicer, with the differential
// accelerations that change them.
//
// Elements instead of a position because all but one of their uncertainties are constant, and because the servicer's
// orbit then only defines the frame: an improved estimate of that orbit shifts the target along and leaves the relative
// orbit unchanged. Both orbits are propagated in gravity of degree 20 by the same integrator, so that neglected terms
// cancel.

#include "fsw/filter/adaptive_noise.h"
#include "fsw/filter/burn.h"
#include "fsw/filter/propagation.h"
#include "fsw/filter/state.h"
#include "fsw/orbit/elements.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::filter {

struct RelativeOrbitSettings {
  filter::AdaptiveNoiseSettings acceleration;  ///< noise of all other effects, m^2/s^3, while `empirical` is inactive
  GaussMarkov drag{.sigma = 1e-9, .time_s = 6000.0};       ///< m/s^2, differential drag
  GaussMarkov from_sun{.sigma = 3e-8, .time_s = 86400.0};  ///< m/s^2, differential radiation pressure in sunlight
  GaussMarkov empirical{.sigma = 3e-8, .time_s = 1500.0};  ///< m/s^2, per axis, while active

  bool operator==(const RelativeOrbitSettings&) const = default;
};

/// Both spacecraft at the start of a propagation.
struct OrbitStep {
  const filter::Propagation& propagation;
  orbit::CartesianState servicer;
  double dt = 0.0;          ///< s
  filter::Thrust thrust{};  ///< of the servicer, on all of the step
};

/// Propagation of the sampled states at the head of the estimate: x <- mean + jacobian (x - old mean) + noise.
struct HeadMotion {
  Eigen::Matrix<double, kHeadSize, 1> mean;
  Eigen::Matrix<double, kHeadSize, kHeadSize> jacobian = Eigen::Matrix<double, kHeadSize, kHeadSize>::Identity();
  Eigen::Matrix<double, kHeadSize, kHeadSize> noise = Eigen::Matrix<double, kHeadSize, kHeadSize>::Zero();
};

class RelativeOrbit {
 public:
  /// Replaces the settings; the estimate and the adapted process noise stay if the noise settings do.
  void configure(const RelativeOrbitSettings& settings);

  /// Initialises with ROE (dimensionless) and their covariance; correlations with all other blocks end.
  void initialize(Estimate& estimate, const Vector6& roe, const Matrix6& covariance);
  void deactivate(Estimate& estimate) const;
  /// Activates the empirical acceleration if it is inactive.
  void activate_empirical(Estimate& estimate) const;

  /// Propagates by sigma points through both orbits; false if an orbit is invalid.
  [[nodiscard]] bool advance(const Estimate& estimate, const OrbitStep& step, HeadMotion& motion) const;

  /// Applies a burn of the servicer (m/s, known to `sigma` per axis), `servicer` before it: the frame of the elements
  /// changes. Returns false, with nothing changed, if the orbit is invalid or the covariance is not positive definite.
  [[nodiscard]] bool impulse(Estimate& estimate, const orbit::CartesianState& servicer, const Vector3& dv_eci,
                             double sigma);

  /// Inflates the covariance after contradicting measurements: as after an unknown burn of `velocity_sigma` (m/s, per
  /// axis), with the given sigma of the mean longitude.
  void inflate(Estimate& estimate, const orbit::CartesianState& servicer, double velocity_sigma,
               double longitude_sigma);

  /// Inflates the covariance as after a burn of `velocity_sigma` (m/s, per axis) at an unknown time of the last `dt` s;
  /// `servicer` now.
  void inflate_by_burn(Estimate& estimate, const orbit::CartesianState& servicer, double velocity_sigma, double dt);

  [[nodiscard]] filter::AdaptiveNoise& noise() { return noise_; }
  [[nodiscard]] const filter::AdaptiveNoise& noise() const { return noise_; }

 private:
  RelativeOrbitSettings settings_;
  filter::AdaptiveNoise noise_;
};

/// Adds to the covariance of the ROE that of a white acceleration in RTN (power spectral density m^2/s^3, per axis)
/// over the next `dt` s, or of changes of velocity at random times with a variance of psd * dt in all: by three-point
/// Gauss quadrature in the interval. Gamma maps an impulse to the elements, and only the mean longitude drifts.
void add_velocity_noise(const orbit::QnsElements& servicer, double psd, double dt, Matrix6& noise);

/// Covariance of the target's state in the servicer's RTN (velocity as seen in the rotating frame), m and m/s, of ROE
/// and their covariance: by the Jacobian of the exact map, from finite differences. Zero if the orbit is invalid.
Matrix6 covariance_rtn(const Vector6& roe, const Matrix6& covariance, const orbit::CartesianState& servicer);
Matrix6 covariance_rtn(const Estimate& estimate, const orbit::CartesianState& servicer);

}  // namespace vbar::fsw::filter
