#include "fsw/navigation/orbit_filter.h"

#include "fsw/estimation/unscented.h"
#include "fsw/navigation/dynamics.h"
#include "fsw/orbit/constants.h"

namespace vbar::fsw::navigation {
namespace {

using Transform = estimation::UnscentedTransform<6>;

// Accelerations not modelled by point mass and J2 at 700 km are near 5e-5 m/s^2 and vary over minutes: as white noise,
// their square times such a correlation time.
constexpr double kUnmodelledPsd = 5e-5 * 5e-5 * 100.0;  // m^2/s^3

constexpr double kGate = 25.0;            // 5 sigma, one degree of freedom
constexpr double kStartSpeedSigma = 5.0;  // m/s: two positions with errors of a few metres, seconds apart
// Minimum interval between the two positions that initialise the filter, s.
constexpr double kMinBaseline = 0.5;
constexpr double kMaxBaseline = 120.0;

orbit::CartesianState state_of(const Vector6& x) {
  return {.position_eci = x.head<3>(), .velocity_eci = x.tail<3>()};
}

}  // namespace

void OrbitFilter::take_position(GpsTime time, double early_s, const Vector3& position_eci, double sigma_m) {
  if (started_ && time - epoch_ > kLongestCoast) reset();
  if (!started_) {
    begin(time, early_s, position_eci, sigma_m);
    return;
  }
  if (time < epoch_) return;
  advance_to(time);
  if (!started_) return;
  const Vector3 position = position_eci + early_s * state().velocity_eci;
  bool fits = true;
  for (int axis = 0; axis < 3 && fits; ++axis) {
    const double residual = position(axis) - estimate_.mean(axis);
    fits = residual * residual <= kGate * (estimate_.variance(axis) + sigma_m * sigma_m);
  }
  if (!fits) {
    if (++refused_in_a_row_ >= kMaxRefused) {
      reset();
      begin(time, early_s, position_eci, sigma_m);
    }
    return;
  }
  refused_in_a_row_ = 0;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double kNoGate = 1e300;
    estimate_.update(Vector6::Unit(axis), position(axis) - estimate_.mean(axis), sigma_m * sigma_m, kNoGate);
  }
}

/// Velocity from two positions: the chord, corrected for the curvature due to the point mass.
void OrbitFilter::begin(GpsTime time, double early_s, const Vector3& position_eci, double sigma_m) {
  const double baseline = has_first_ ? seconds(time - epoch_) - early_s + first_early_s_ : 0.0;
  if (baseline < kMinBaseline || baseline > kMaxBaseline) {
    if (!has_first_ || baseline > kMaxBaseline || baseline < 0.0) {
      first_position_eci_ = position_eci;
      first_early_s_ = early_s;
      epoch_ = time;
      has_first_ = true;
    }
    return;
  }
  const Vector3 middle = 0.5 * (first_position_eci_ + position_eci);
  const double distance = middle.norm();
  const Vector3 gravity = -orbit::kMu / (distance * distance * distance) * middle;
  const Vector3 velocity = (position_eci - first_position_eci_) / baseline + 0.5 * baseline * gravity;
  const double speed_sigma = kStartSpeedSigma + 2.0 * sigma_m / baseline;
  const Vector3 position = position_eci + early_s * velocity;
  for (int axis = 0; axis < 3; ++axis) {
    estimate_.reset(axis, position(axis), sigma_m * sigma_m);
    estimate_.reset(3 + axis, velocity(axis), speed_sigma * speed_sigma);
  }
  epoch_ = time;
  started_ = true;
  refused_in_a_row_ = 0;
}

void OrbitFilter::advance_to(GpsTime time) {
  const double dt = seconds(time - epoch_);
  if (!started_ || dt <= 0.0) return;
  Transform transform;
  if (transform.start(estimate_.mean(), estimate_.head_covariance<6>()) != Status::kOk) {
    reset();
    return;
  }
  std::array<Vector6, Transform::kPoints> moved;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    const orbit::CartesianState later = propagate_accelerated(state_of(transform.point(k)), Vector3::Zero(), dt);
    moved[k] << later.position_eci, later.velocity_eci;
  }
  const auto regression = transform.regress<6>(moved);
  Matrix6 noise = regression.nonlinearity;
  add_acceleration_noise(noise, kUnmodelledPsd, dt);
  estimate_.transform_head<6>(regression.mean, regression.jacobian, noise);
  epoch_ = time;
  if (!estimate_.is_sound()) reset();
}

void OrbitFilter::add_impulse(const Vector3& dv_eci) {
  for (int axis = 0; axis < 3; ++axis) estimate_.shift(3 + axis, dv_eci(axis));
}

}  // namespace vbar::fsw::navigation
