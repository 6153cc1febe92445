#include "fsw/control/plan.h"

#include <cstdint>

#include "fsw/math/math.h"
#include "fsw/orbit/gravity_field.h"

namespace vbar::fsw::control {
namespace {

constexpr double kMaxEccentricity = 0.9;
constexpr double kMinSinInclination = 1e-6;
constexpr Duration kMaxHorizon = duration_of_seconds(std::int64_t{30} * 86400);

}  // namespace

Status check_problem(const ControlProblem& problem) {
  const orbit::QnsElements& q = problem.servicer_mean;
  const double elements = q.a + q.ex + q.ey + q.i + q.raan + q.u;
  if (!math::is_finite(elements) || !math::is_finite(problem.pseudo_state.cwiseAbs().sum())) return Status::kNotFinite;

  const double e = math::hypot(q.ex, q.ey);
  const bool orbit_valid =
      e < kMaxEccentricity && q.a * (1.0 - e) > orbit::kEarthRadius && math::sin(q.i) > kMinSinInclination;
  const bool horizon_valid = problem.arrival >= problem.start && problem.arrival - kMaxHorizon <= problem.start;
  return orbit_valid && horizon_valid ? Status::kOk : Status::kOutOfRange;
}

}  // namespace vbar::fsw::control
