#include "fsw/gnc/navigation.h"

#include "fsw/math/math.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::gnc {
namespace {

// Relative acceleration that point mass + J2 misses between two spacecraft tens of kilometres apart: the next zonal and
// tesseral terms are 1e-3 of J2, whose own differential acceleration over 50 km is about 2e-4 m/s^2.
constexpr double kUnmodelledRelativeAcceleration = 2e-7;  // m/s^2, 1 sigma, constant over a coast

Vector3 vector(const double (&xyz)[3]) { return {xyz[0], xyz[1], xyz[2]}; }

}  // namespace

void Navigation::update(GpsTime now, Inbox& inbox) {
  const auto& measurements = inbox.ideal_navigation_states();
  const auto& maneuvers = inbox.executed_maneuvers();

  // Two lists in order of time become one; at the same instant a measurement speaks of the state before the impulse.
  std::size_t m = 0;
  std::size_t b = 0;
  while (m < measurements.size() || b < maneuvers.size()) {
    const bool measurement_first =
        b == maneuvers.size() ||
        (m < measurements.size() && measurements[m].tag.time <= maneuvers[b].tag.time);
    const GpsTime time = measurement_first ? measurements[m].tag.time : maneuvers[b].tag.time;
    const bool usable = time <= now && (!state_.valid || time >= state_.epoch);
    if (!usable) {
      inbox.count_unusable_time();
    } else if (measurement_first) {
      fold_in(time, measurements[m].value);
    } else if (state_.valid) {
      propagate_to(time);
      if (state_.valid) apply_own_maneuver(maneuvers[b].value);
    }
    (measurement_first ? m : b) += 1;
  }
  if (state_.valid) propagate_to(now);
}

void Navigation::fold_in(GpsTime time, const ideal_navigation& measurement) {
  state_.servicer = {vector(measurement.servicer_position_eci), vector(measurement.servicer_velocity_eci)};
  state_.target = {vector(measurement.target_position_eci), vector(measurement.target_velocity_eci)};
  state_.epoch = time;
  state_.last_measurement = time;
  state_.source = NavigationSource::kIdeal;
  state_.sigma_rtn.setZero();
  // A state no orbit model can hold is no state: wait for a better one.
  state_.valid = orbit::qns_from_cartesian(state_.servicer).ok() && orbit::qns_from_cartesian(state_.target).ok();
}

void Navigation::propagate_to(GpsTime time) {
  if (time <= state_.epoch) return;
  const double dt = seconds(time - state_.epoch);
  const Result<orbit::CartesianState> servicer = orbit::propagate_j2(state_.servicer, dt);
  const Result<orbit::CartesianState> target = orbit::propagate_j2(state_.target, dt);
  if (!servicer.ok() || !target.ok()) {
    state_.valid = false;  // too long a gap, or not an orbit: start again from the next measurement
    return;
  }
  state_.servicer = servicer.value();
  state_.target = target.value();
  state_.epoch = time;
  state_.source = NavigationSource::kPropagated;
  const double age = seconds(time - state_.last_measurement);
  state_.sigma_rtn.head<3>().setConstant(0.5 * kUnmodelledRelativeAcceleration * age * age);
  state_.sigma_rtn.tail<3>().setConstant(kUnmodelledRelativeAcceleration * age);
}

void Navigation::apply_own_maneuver(const executed_maneuver& maneuver) {
  if (maneuver.accepted == 0) return;
  state_.servicer = orbit::apply_impulse_rtn(state_.servicer, vector(maneuver.dv_rtn));
}

Vector6 Navigation::sigma_a_roe_m(const orbit::QnsElements& servicer_mean) const {
  Vector6 variance = Vector6::Zero();
  for (int k = 0; k < 6; ++k) {
    Vector6 one_sigma = Vector6::Zero();
    one_sigma(k) = state_.sigma_rtn(k);
    const Vector6 a_roe = servicer_mean.a * orbit::roe_from_rtn_linear(servicer_mean, one_sigma);
    variance += a_roe.cwiseProduct(a_roe);
  }
  Vector6 sigma;
  for (int k = 0; k < 6; ++k) sigma(k) = math::sqrt(variance(k));
  return sigma;
}

}  // namespace vbar::fsw::gnc
