#include "fsw/orbit/in_plane.h"

#include "fsw/math/math.h"

namespace vbar::fsw::orbit {
namespace {

// A Newton step of this size leaves an error of e/2 (1e-8)^2 / (1-e) < 1e-15 rad, and moves sine and cosine so little
// that two terms of their series replace another evaluation.
constexpr double kLastStep = 1e-8;
constexpr int kMaxIterations = 20;

// From F = u Newton's method converges while the equation is nearly linear. Beyond, it starts at u + e or u - e, past
// the root on the side where the equation is convex, from where the convergence is monotone.
constexpr double kNearlyCircular = 0.1;

}  // namespace

Result<EccentricLatitude> solve_kepler(double ex, double ey, double u) {
  if (!math::is_finite(ex) || !math::is_finite(ey) || !math::is_finite(u)) return Status::kNotFinite;
  const double e = math::hypot(ex, ey);
  if (e > kMaxEccentricity) return Status::kOutOfRange;

  double angle = u;
  if (e > kNearlyCircular) angle += ex * math::sin(u) - ey * math::cos(u) >= 0.0 ? e : -e;
  for (int k = 0; k < kMaxIterations; ++k) {
    const double s = math::sin(angle);
    const double c = math::cos(angle);
    const double step = (u - angle + ex * s - ey * c) / (1.0 - ex * c - ey * s);
    angle += step;
    if (math::abs(step) < kLastStep) return EccentricLatitude{.sin = s + c * step, .cos = c - s * step, .angle = angle};
  }
  return Status::kDidNotConverge;
}

Result<InPlane> in_plane(const QnsElements& q) {
  const Result<EccentricLatitude> kepler = solve_kepler(q.ex, q.ey, q.u);
  if (!kepler.ok()) return kepler.status();
  const auto [s, c, angle] = kepler.value();
  const double eta = math::sqrt(1.0 - q.ex * q.ex - q.ey * q.ey);
  const double b = 1.0 / (1.0 + eta);
  const double radius_over_a = 1.0 - q.ex * c - q.ey * s;
  return InPlane{.cos_theta = ((1.0 - b * q.ey * q.ey) * c + b * q.ex * q.ey * s - q.ex) / radius_over_a,
                 .sin_theta = ((1.0 - b * q.ex * q.ex) * s + b * q.ex * q.ey * c - q.ey) / radius_over_a,
                 .radius_over_a = radius_over_a,
                 .eta = eta};
}

}  // namespace vbar::fsw::orbit
