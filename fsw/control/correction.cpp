#include "fsw/control/correction.h"

#include <Eigen/Eigenvalues>

#include "fsw/math/math.h"

namespace vbar::fsw::control {
namespace {

// dlambda answers a transverse burn with 3 m/s times the time to go, ten and more times what the other elements do; its
// row is scaled to theirs by a fixed number. (Scaling by the largest effect, which changes from decision to decision,
// diverges.)
Vector6 row_scale() {
  return {1.0, 0.1, 1.0, 1.0, 1.0, 1.0};
}

}  // namespace

Result<Correction> least_norm_correction(std::span<const Matrix63> effects, const Vector6& residual,
                                         const CorrectionSettings& settings) {
  if (effects.empty() || effects.size() > kMaxBurns) return Status::kInvalidArgument;
  const Vector6 rows = row_scale();
  const Vector3 columns(1.0 / settings.radial_price, 1.0, 1.0);

  // With A = [scaled effects], A A' = U S^2 U' gives the truncated least-norm solution A' U S^-2 U' r without the
  // (wide) A.
  Matrix6 gram = Matrix6::Zero();
  for (const Matrix63& effect : effects) {
    const Matrix63 scaled = rows.asDiagonal() * effect * columns.asDiagonal();
    gram += scaled * scaled.transpose();
  }
  if (!math::is_finite(gram.sum()) || !math::is_finite(residual.sum())) return Status::kNotFinite;
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(gram);
  if (eigen.info() != Eigen::Success) return Status::kDidNotConverge;
  const double strongest = eigen.eigenvalues()[5];
  if (strongest <= 0.0) return Status::kSingular;

  Vector6 multipliers = Vector6::Zero();
  const Vector6 scaled_residual = rows.cwiseProduct(residual);
  for (int k = 0; k < 6; ++k) {
    const double gain_squared = eigen.eigenvalues()[k];
    if (gain_squared < settings.least_gain * settings.least_gain * strongest) continue;
    const Vector6 direction = eigen.eigenvectors().col(k);
    multipliers += direction * (direction.dot(scaled_residual) / gain_squared);
  }

  Correction correction;
  for (const Matrix63& effect : effects) {
    const Vector3 along = effect.transpose() * rows.cwiseProduct(multipliers);
    correction.dv[correction.count++] = columns.cwiseProduct(columns).cwiseProduct(along);
  }
  return correction;
}

}  // namespace vbar::fsw::control
