#include "fsw/control/impulse_effect.h"

#include "fsw/math/math.h"
#include "fsw/orbit/constants.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/secular.h"

namespace vbar::fsw::control {
namespace {

constexpr double kMaxEccentricity = 0.9;
constexpr double kMinSinInclination = 1e-6;
constexpr double kMaxHorizon = 30.0 * 86400.0;  ///< s

}  // namespace

Status check_horizon(const orbit::QnsElements& chief_mean, double horizon) {
  const orbit::QnsElements& q = chief_mean;
  if (!math::is_finite(q.a + q.ex + q.ey + q.i + q.raan + q.u + horizon)) return Status::kNotFinite;
  const double e = math::hypot(q.ex, q.ey);
  const bool valid = e < kMaxEccentricity && q.a * (1.0 - e) > orbit::kEarthRadius &&
                     math::sin(q.i) > kMinSinInclination && horizon >= 0.0 && horizon <= kMaxHorizon;
  return valid ? Status::kOk : Status::kOutOfRange;
}

Matrix63 impulse_effect(const orbit::QnsElements& chief_mean, double t, double horizon) {
  const orbit::QnsElements chief = orbit::propagate_secular(chief_mean, t);
  return orbit::roe_transition_j2(chief, horizon - t) * orbit::roe_control_matrix(chief);
}

}  // namespace vbar::fsw::control
