#include "fsw/control/correction.h"

#include "fsw/math/math.h"
#include "fsw/math/symmetric_eigen.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::control {
namespace {

// The effect of a transverse burn on dlambda is 3 m/s times the time to go, ten and more times that on the others; its
// row is scaled to theirs by a fixed factor. (Scaling by the largest effect, which changes from decision to decision,
// diverges.)
Vector6 row_scale() {
  return {1.0, 0.1, 1.0, 1.0, 1.0, 1.0};
}

}  // namespace

Result<Correction> least_norm_correction(std::span<const Matrix63> effects, const Vector6& residual,
                                         const CorrectionSettings& settings) {
  if (effects.empty() || effects.size() > kMaxBurns) return Status::kInvalidArgument;
  if (!math::is_finite(residual.sum())) return Status::kNotFinite;
  const Vector6 rows = row_scale();
  const Vector3 columns(1.0 / settings.radial_price, 1.0, 1.0);

  // With A = [scaled effects], A A' = U S^2 U' gives the truncated least-norm solution A' U S^-2 U' r without the wide
  // A.
  Matrix6 gram = Matrix6::Zero();
  for (const Matrix63& effect : effects) {
    const Matrix63 scaled = rows.asDiagonal() * effect * columns.asDiagonal();
    gram += scaled * scaled.transpose();
  }
  const Result<math::SymmetricEigen<6>> eigen = math::symmetric_eigen<6>(gram);
  if (!eigen.ok()) return eigen.status();
  const double strongest = eigen.value().values[5];
  if (strongest <= 0.0) return Status::kSingular;

  Vector6 multipliers = Vector6::Zero();
  const Vector6 scaled_residual = rows.cwiseProduct(residual);
  for (int k = 0; k < 6; ++k) {
    const double gain_squared = eigen.value().values[k];
    if (gain_squared < settings.min_gain * settings.min_gain * strongest) continue;
    const Vector6 direction = eigen.value().vectors.col(k);
    multipliers += direction * (direction.dot(scaled_residual) / gain_squared);
  }

  Correction correction;
  for (const Matrix63& effect : effects) {
    const Vector3 along = effect.transpose() * rows.cwiseProduct(multipliers);
    correction.dv[correction.count++] = columns.cwiseProduct(columns).cwiseProduct(along);
  }
  return correction;
}

Result<Plan> correct_plan(const MeanOrbits& orbits, const Plan& committed, const Plan& plan, const Waypoint& waypoint,
                          const CorrectionSettings& settings) {
  if (plan.count == 0) return Status::kInvalidArgument;
  // The linear effects are accurate to about 1e-2 of the total change, mainly because of the servicer's own burns: each
  // iteration leaves that share of the error, from tens of metres after planning at 75 km down to millimetres.
  constexpr int kRounds = 3;
  std::array<Matrix63, kMaxBurns> effects;
  for (std::size_t k = 0; k < plan.count; ++k) {
    effects[k] = arrival_effect(orbits.servicer, orbits.epoch, plan.burns[k].time, waypoint.time);
  }
  const Result<MeanOrbits> at_first = fly(orbits, committed.all(), plan.burns[0].time);
  if (!at_first.ok()) return at_first.status();
  Plan corrected = plan;
  for (int round = 0; round < kRounds; ++round) {
    const Result<Vector6> error = arrival_error(at_first.value(), corrected.all(), waypoint);
    if (!error.ok()) return error.status();
    const Result<Correction> correction = least_norm_correction({effects.data(), plan.count}, error.value(), settings);
    if (!correction.ok()) return correction.status();
    // Effects are those of the deputy.
    for (std::size_t k = 0; k < plan.count; ++k) corrected.burns[k].dv_rtn -= correction.value().dv[k];
  }
  return corrected;
}

Result<double> arrival_distance(const MeanOrbits& orbits, const Waypoint& waypoint, const Vector6& roe_error) {
  const orbit::QnsElements servicer = orbit::propagate_secular(orbits.servicer, seconds(waypoint.time - orbits.epoch));
  const double distance = orbit::rtn_from_roe_linear(servicer, roe_error).head<3>().norm();
  if (!math::is_finite(distance)) return Status::kNotFinite;
  return distance;
}

}  // namespace vbar::fsw::control
