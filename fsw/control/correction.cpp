#include "fsw/control/correction.h"

#include "fsw/math/symmetric_eigen.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/secular.h"

namespace vbar::fsw::control {
namespace {

constexpr double kRadialWeight = 1.0 / 3.0;  // a radial burn turns de at twice the price of a tangential one
constexpr double kTruncation = 0.02;         // singular values below this part of the largest are not used

/// committed, then planned.
Plan joined(const Plan& committed, const Plan& plan) {
  Plan all = committed;
  for (std::size_t k = 0; k < plan.count && all.count < kMaxBurns; ++k) all.burns[all.count++] = plan.burns[k];
  return all;
}

std::span<const Burn> burns_of(const Plan& plan) { return {plan.burns.data(), plan.count}; }

/// Columns of a burn's effect, weighted.
Matrix63 weighted_effect(const MeanOrbits& orbits, const Burn& burn, const Waypoint& waypoint) {
  Matrix63 effect = arrival_effect(orbits.servicer, orbits.epoch, burn.time, waypoint.time);
  effect.col(0) *= kRadialWeight;
  return effect;
}

/// One least-norm step that takes `error` out, through the eigenvectors of the 6x6 Gram matrix of the weighted effects.
Status correct_once(const MeanOrbits& orbits, const Waypoint& waypoint, const Vector6& error, Plan& plan) {
  Matrix6 gram = Matrix6::Zero();
  for (const Burn& burn : burns_of(plan)) {
    const Matrix63 effect = weighted_effect(orbits, burn, waypoint);
    gram += effect * effect.transpose();
  }
  const Result<math::SymmetricEigen<6>> eigen = math::symmetric_eigen<6>(gram);
  if (!eigen.ok()) return eigen.status();
  const double least = kTruncation * kTruncation * eigen.value().values(5);
  Vector6 multiplier = Vector6::Zero();
  for (int k = 0; k < 6; ++k) {
    const double value = eigen.value().values(k);
    if (value <= least) continue;
    const Vector6 direction = eigen.value().vectors.col(k);
    multiplier += direction * (direction.dot(error) / value);
  }
  for (std::size_t k = 0; k < plan.count; ++k) {
    Vector3 deputy_dv = weighted_effect(orbits, plan.burns[k], waypoint).transpose() * multiplier;
    deputy_dv(0) *= kRadialWeight;
    plan.burns[k].dv_rtn -= deputy_dv;
  }
  return Status::kOk;
}

}  // namespace

Result<double> arrival_distance(const MeanOrbits& orbits, const Waypoint& waypoint, const Vector6& roe_error) {
  const Vector6 rtn = orbit::rtn_from_roe_linear(
      orbit::propagate_secular(orbits.servicer, seconds(waypoint.time - orbits.epoch)), roe_error);
  const double distance = rtn.head<3>().norm();
  if (!math::is_finite(distance)) return Status::kNotFinite;
  return distance;
}

Result<Plan> correct_plan(const MeanOrbits& orbits, const Plan& committed, const Plan& plan, const Waypoint& waypoint) {
  if (plan.count == 0) return Status::kNotReady;
  constexpr int kRounds = 3;  // the linear effects are good to 1e-2: three rounds leave 1e-6 of the error
  Plan corrected = plan;
  for (int round = 0; round < kRounds; ++round) {
    const Plan all = joined(committed, corrected);
    const Result<Vector6> error = arrival_error(orbits, burns_of(all), waypoint);
    if (!error.ok()) return error.status();
    const Status status = correct_once(orbits, waypoint, error.value(), corrected);
    if (status != Status::kOk) return status;
  }
  return corrected;
}

}  // namespace vbar::fsw::control
