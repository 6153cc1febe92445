#pragma once
// Effect of a burn of the servicer on a filter on the target's ROE: the frame of the elements changes.

#include <array>

#include "fsw/core/types.h"
#include "fsw/estimation/estimate.h"
#include "fsw/estimation/unscented.h"
#include "fsw/orbit/elements.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::navigation {

/// The first six components of `estimate` are ROE (dimensionless) with respect to the servicer, at `servicer` before it
/// burns `dv_eci` (m/s), known to `sigma` (m/s, per axis). False, with nothing changed, if the orbit is invalid or the
/// covariance is not positive definite.
template <int N>
[[nodiscard]] bool move_frame_of_roe(estimation::Estimate<N>& estimate, const orbit::CartesianState& servicer,
                                     const Vector3& dv_eci, double sigma) {
  using Transform = estimation::UnscentedTransform<6>;
  Transform transform;
  const auto before = orbit::qns_from_cartesian(servicer);
  const auto after = orbit::qns_from_cartesian({servicer.position_eci, servicer.velocity_eci + dv_eci});
  if (!before.ok() || !after.ok()) return false;
  const Vector6 roe = estimate.mean().template head<6>();
  if (transform.start(roe, estimate.template head_covariance<6>()) != Status::kOk) return false;
  std::array<Vector6, Transform::kPoints> moved;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    moved[k] = orbit::roe_from_qns(after.value(), orbit::qns_from_roe(before.value(), transform.point(k)));
  }
  const auto regression = transform.regress<6>(moved);
  const Matrix63 gamma = orbit::roe_control_matrix(before.value());
  const Matrix6 noise = regression.nonlinearity + (sigma * sigma * gamma).lazyProduct(gamma.transpose());
  estimate.template transform_head<6>(regression.mean, regression.jacobian, noise);
  return true;
}

}  // namespace vbar::fsw::navigation
