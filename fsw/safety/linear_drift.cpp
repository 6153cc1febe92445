#include "fsw/safety/linear_drift.h"

#include "fsw/math/math.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::safety {

Result<LinearDrift> LinearDrift::make(const orbit::QnsElements& servicer_mean, double horizon) {
  const orbit::QnsElements& s = servicer_mean;
  if (!math::is_finite(s.a + s.ex + s.ey + s.i + s.raan + s.u + horizon)) return Status::kNotFinite;
  if (s.a <= 0.0 || s.ex * s.ex + s.ey * s.ey >= 1.0 || horizon <= 0.0) return Status::kOutOfRange;
  const orbit::SecularRates rates = orbit::secular_rates(s);
  const double u_rate = rates.mean_argument_of_latitude();
  const double revolutions = horizon * u_rate / math::kTwoPi;
  if (!(revolutions > 0.0 && revolutions <= kMaxRevolutions)) return Status::kOutOfRange;

  LinearDrift drift;
  drift.mean_motion_ = rates.mean_motion;
  drift.rate_ = (orbit::roe_transition_j2(s, horizon) - Matrix6::Identity()) / horizon;
  drift.step_s_ = math::kTwoPi / (u_rate * kSamplesPerRevolution);
  drift.samples_ = static_cast<int>(horizon / drift.step_s_) + 2;  // the last one at or after the horizon
  for (std::size_t k = 0; k < kSamplesPerRevolution; ++k) {
    const double u = s.u + math::kTwoPi * static_cast<double>(k) / kSamplesPerRevolution;
    drift.cos_u_[k] = math::cos(u);
    drift.sin_u_[k] = math::sin(u);
  }
  return drift;
}

PositionMap LinearDrift::map_at(int sample) const {
  const auto k = static_cast<std::size_t>(sample % kSamplesPerRevolution);
  PositionMap map = PositionMap::Zero();
  map(0, 0) = 1.0;
  map(0, 2) = -cos_u_[k];
  map(0, 3) = -sin_u_[k];
  map(1, 1) = 1.0;
  map(1, 2) = 2.0 * sin_u_[k];
  map(1, 3) = -2.0 * cos_u_[k];
  map(2, 4) = sin_u_[k];
  map(2, 5) = -cos_u_[k];
  return map + time_s(sample) * (map * rate_);
}

double LinearDrift::min_distance(const Vector6& a_roe_m, const DriftError& error, double enough_m) const {
  // A constant acceleration d raises the target's semi-major axis by 2 d t / n and delays it by 3/2 d t^2.
  const double da_rate = 2.0 * error.differential_drag / mean_motion_;
  const double before_s = error.acted_for;
  Vector6 roe = a_roe_m;
  roe += before_s * error.a_da_m * rate_.col(0);
  roe(0) += error.a_da_m + da_rate * before_s;
  roe(1) -= 1.5 * error.differential_drag * before_s * before_s;
  const Vector6 change = step_s_ * (rate_ * roe);
  const double da_change = da_rate * step_s_;
  const double dl_change = -1.5 * error.differential_drag * step_s_ * step_s_;
  const double enough_squared = enough_m * enough_m;
  double least = 0.0;
  double before = 0.0;
  double previous = 0.0;
  std::size_t k = 0;
  for (int sample = 0; sample < samples_; ++sample) {
    const double c = cos_u_[k];
    const double s = sin_u_[k];
    if (++k == kSamplesPerRevolution) k = 0;
    const double steps = sample;
    const double radial = roe(0) + da_change * steps - roe(2) * c - roe(3) * s;
    const double along = roe(1) + dl_change * steps * steps + 2.0 * (roe(2) * s - roe(3) * c);
    const double normal = roe(4) * s - roe(5) * c;
    const double squared = radial * radial + along * along + normal * normal;
    if (sample == 0 || squared < least) least = squared;
    // Between the samples: the vertex of the parabola through the last three.
    const double curvature = before - 2.0 * previous + squared;
    if (sample >= 2 && previous <= before && previous <= squared && curvature > 0.0) {
      const double slope = 0.5 * (squared - before);
      const double vertex = previous - 0.5 * slope * slope / curvature;
      if (vertex < least) least = vertex > 0.0 ? vertex : 0.0;
    }
    if (least < enough_squared) break;
    before = previous;
    previous = squared;
    roe += change;
  }
  return math::sqrt(least);
}

}  // namespace vbar::fsw::safety
