#include "fsw/control/near_circular.h"

#include "fsw/math/math.h"
#include "fsw/orbit/propagate.h"

namespace vbar::fsw::control {

NearCircularOrbit near_circular_orbit(const orbit::QnsElements& mean) {
  const orbit::SecularRates rates = orbit::secular_rates(mean);
  const double eta = math::sqrt(1.0 - mean.ex * mean.ex - mean.ey * mean.ey);
  const double cos_i = math::cos(mean.i);
  const double sin_i = math::sin(mean.i);
  NearCircularOrbit orbit;
  orbit.a = mean.a;
  orbit.n = rates.mean_motion;
  orbit.u = mean.u;
  orbit.latitude_rate = rates.mean_argument_of_latitude();
  orbit.perigee_rate = rates.perigee;
  orbit.drift_rate = 1.5 * orbit.n + 3.5 * rates.kappa * (1.0 + eta) * (3.0 * cos_i * cos_i - 1.0);
  orbit.node_drift_rate = 2.0 * rates.kappa * sin_i * sin_i;
  return orbit;
}

TangentialTask tangential_task(const NearCircularOrbit& orbit, const Vector6& pseudo_state, double window) {
  const double half_speed = 0.5 * orbit.n * orbit.a;
  TangentialTask task;
  task.window = window;
  task.sum = half_speed * pseudo_state[0];
  task.moment = -half_speed * pseudo_state[1] / orbit.drift_rate;
  task.e_cos = half_speed * pseudo_state[2];
  task.e_sin = half_speed * pseudo_state[3];
  return task;
}

double eccentricity_phase(const NearCircularOrbit& orbit, double window, double offset) {
  return orbit.u + orbit.latitude_rate * offset + orbit.perigee_rate * (window - offset);
}

double ReachableBounds::in_plane() const {
  const double larger = da > dlambda ? da : dlambda;
  return larger > de ? larger : de;
}

ReachableBounds reachable_bounds(const NearCircularOrbit& orbit, const Vector6& pseudo_state, double window) {
  const TangentialTask task = tangential_task(orbit, pseudo_state, window);
  ReachableBounds bounds;
  bounds.da = math::abs(task.sum);
  bounds.dlambda = math::abs(task.sum - 2.0 * task.moment / window);
  bounds.de = math::hypot(task.e_cos, task.e_sin);
  bounds.di = orbit.n * orbit.a * math::hypot(pseudo_state[4], pseudo_state[5]);
  return bounds;
}

}  // namespace vbar::fsw::control
