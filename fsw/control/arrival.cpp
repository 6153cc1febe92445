#include "fsw/control/arrival.h"

#include "fsw/math/math.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::control {
namespace {

using orbit::QnsElements;

// Difference of angles, mapped to (-pi, pi].
double angle_step(double to, double from) {
  return math::wrap_to_pi(to - from);
}

// elements + (to - from)
QnsElements shifted(const QnsElements& elements, const QnsElements& from, const QnsElements& to) {
  QnsElements result = elements;
  result.a += to.a - from.a;
  result.ex += to.ex - from.ex;
  result.ey += to.ey - from.ey;
  result.i += to.i - from.i;
  result.raan += angle_step(to.raan, from.raan);
  result.u += angle_step(to.u, from.u);
  return result;
}

// Relative size of the difference of two sets of elements.
double distance(const QnsElements& p, const QnsElements& q) {
  return math::abs(p.a - q.a) / q.a + math::abs(p.ex - q.ex) + math::abs(p.ey - q.ey) + math::abs(p.i - q.i) +
         math::abs(angle_step(p.raan, q.raan)) + math::abs(angle_step(p.u, q.u));
}

}  // namespace

Result<QnsElements> mean_after_impulse(const QnsElements& mean, const Vector3& dv_rtn) {
  const Result<QnsElements> osculating = orbit::osculating_from_mean(mean);
  if (!osculating.ok()) return osculating.status();
  const Result<orbit::CartesianState> before = orbit::cartesian_from_qns(osculating.value());
  if (!before.ok()) return before.status();
  const Result<QnsElements> wanted = orbit::qns_from_cartesian(orbit::apply_impulse_rtn(before.value(), dv_rtn));
  if (!wanted.ok()) return wanted.status();

  // The mean elements before the impulse are known, so that the fixed point for those after it starts close to its end:
  // each iteration divides the error by 1/J2, about 1e3; a conversion from scratch would need three times as many.
  constexpr int kMaxRounds = 6;
  constexpr double kConverged = 1e-13;
  QnsElements after = mean;
  QnsElements image = osculating.value();
  for (int round = 0; round < kMaxRounds; ++round) {
    after = shifted(after, image, wanted.value());
    if (distance(image, wanted.value()) < kConverged) return after;
    const Result<QnsElements> next = orbit::osculating_from_mean(after);
    if (!next.ok()) return next.status();
    image = next.value();
  }
  return distance(image, wanted.value()) < 1e-12 ? Result<QnsElements>(after)
                                                 : Result<QnsElements>(Status::kOutOfRange);
}

Result<MeanOrbits> fly(const MeanOrbits& orbits, std::span<const Burn> burns, GpsTime until) {
  QnsElements servicer = orbits.servicer;
  GpsTime time = orbits.epoch;
  for (const Burn& burn : burns) {
    if (burn.time < time || burn.time > until) return Status::kInvalidArgument;
    const Result<QnsElements> after =
        mean_after_impulse(orbit::propagate_secular(servicer, seconds(burn.time - time)), burn.dv_rtn);
    if (!after.ok()) return after.status();
    servicer = after.value();
    time = burn.time;
  }
  if (until < time) return Status::kInvalidArgument;
  return MeanOrbits{until, orbit::propagate_secular(servicer, seconds(until - time)),
                    orbit::propagate_secular(orbits.target, seconds(until - orbits.epoch))};
}

Result<Vector6> arrival_error(const MeanOrbits& orbits, std::span<const Burn> burns, const Waypoint& waypoint) {
  const Result<MeanOrbits> arrival = fly(orbits, burns, waypoint.time);
  if (!arrival.ok()) return arrival.status();
  const Vector6 error = waypoint.roe - orbit::roe_from_qns(arrival.value().servicer, arrival.value().target);
  if (!math::is_finite(error.sum())) return Status::kNotFinite;
  return error;
}

Result<ControlProblem> remaining_problem(const MeanOrbits& orbits, std::span<const Burn> committed, GpsTime start,
                                         const Waypoint& waypoint) {
  if (waypoint.time <= start) return Status::kInvalidArgument;
  const Result<MeanOrbits> at_start = fly(orbits, committed, start);
  if (!at_start.ok()) return at_start.status();
  const Result<Vector6> error = arrival_error(at_start.value(), {}, waypoint);
  if (!error.ok()) return error.status();
  return ControlProblem{start, waypoint.time, at_start.value().servicer, error.value()};
}

Matrix63 arrival_effect(const QnsElements& servicer_mean, GpsTime epoch, GpsTime burn, GpsTime arrival) {
  const QnsElements at_burn = orbit::propagate_secular(servicer_mean, seconds(burn - epoch));
  return orbit::roe_transition_j2(at_burn, seconds(arrival - burn)) * orbit::roe_control_matrix(at_burn);
}

}  // namespace vbar::fsw::control
