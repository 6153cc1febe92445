#include "fsw/orbit/elements.h"

#include <Eigen/Geometry>

#include "fsw/math/math.h"
#include "fsw/orbit/gravity_field.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::orbit {
namespace {

// Below this sine of the inclination the node is known to less than 1e-8 rad in double precision.
constexpr double kMinSinInclination = 1e-8;

bool all_finite(const QnsElements& q) {
  return math::is_finite(q.a) && math::is_finite(q.ex) && math::is_finite(q.ey) && math::is_finite(q.i) &&
         math::is_finite(q.raan) && math::is_finite(q.u);
}

bool all_finite(const Vector3& v) {
  return math::is_finite(v.x()) && math::is_finite(v.y()) && math::is_finite(v.z());
}

}  // namespace

double mean_motion(double a) {
  return math::sqrt(kMu / a) / a;
}

double true_argument_of_latitude(const QnsElements& elements) {
  const Result<InPlane> point = in_plane(elements);
  if (!point.ok()) return __builtin_nan("");
  return math::atan2(point.value().sin_theta, point.value().cos_theta);
}

Result<CartesianState> cartesian_from_qns(const QnsElements& q) {
  if (!all_finite(q)) return Status::kNotFinite;
  if (q.a <= 0.0) return Status::kOutOfRange;
  const Result<InPlane> solved = in_plane(q);
  if (!solved.ok()) return solved.status();
  const InPlane& point = solved.value();

  const double radius = q.a * point.radius_over_a;
  const double speed = math::sqrt(kMu / q.a) / point.eta;  // mu / h
  const double x_rate = -speed * (point.sin_theta + q.ey);
  const double y_rate = speed * (point.cos_theta + q.ex);

  const double cos_raan = math::cos(q.raan);
  const double sin_raan = math::sin(q.raan);
  const double cos_i = math::cos(q.i);
  const Vector3 node(cos_raan, sin_raan, 0.0);
  const Vector3 ahead(-sin_raan * cos_i, cos_raan * cos_i, math::sin(q.i));
  return CartesianState{.position_eci = radius * (point.cos_theta * node + point.sin_theta * ahead),
                        .velocity_eci = x_rate * node + y_rate * ahead};
}

Result<QnsElements> qns_from_cartesian(const CartesianState& state) {
  const Vector3& r = state.position_eci;
  const Vector3& v = state.velocity_eci;
  if (!all_finite(r) || !all_finite(v)) return Status::kNotFinite;

  const double radius = math::sqrt(r.squaredNorm());
  if (radius <= 0.0) return Status::kOutOfRange;
  const double inverse_a = 2.0 / radius - v.squaredNorm() / kMu;
  if (inverse_a <= 0.0) return Status::kOutOfRange;
  const Vector3 h = r.cross(v);
  const double h_norm = math::sqrt(h.squaredNorm());
  const double h_node = math::hypot(h.x(), h.y());
  if (h_node <= kMinSinInclination * h_norm) return Status::kOutOfRange;  // equatorial or rectilinear

  QnsElements q;
  q.a = 1.0 / inverse_a;
  q.i = math::atan2(h_node, h.z());
  q.raan = math::atan2(h.x(), -h.y());

  const Vector3 node(-h.y() / h_node, h.x() / h_node, 0.0);
  const Vector3 ahead = h.cross(node) / h_norm;
  const Vector3 eccentricity = v.cross(h) / kMu - r / radius;
  q.ex = eccentricity.dot(node);
  q.ey = eccentricity.dot(ahead);
  const double e_squared = q.ex * q.ex + q.ey * q.ey;
  if (e_squared > kMaxEccentricity * kMaxEccentricity) return Status::kOutOfRange;

  const double eta = math::sqrt(1.0 - e_squared);
  const double b = 1.0 / (1.0 + eta);
  const double x = r.dot(node) * inverse_a / eta;
  const double y = r.dot(ahead) * inverse_a / eta;
  const double cos_angle = q.ex + (1.0 - b * q.ex * q.ex) * x - b * q.ex * q.ey * y;
  const double sin_angle = q.ey + (1.0 - b * q.ey * q.ey) * y - b * q.ex * q.ey * x;
  q.u = math::wrap_to_pi(math::atan2(sin_angle, cos_angle) - q.ex * sin_angle + q.ey * cos_angle);
  if (!all_finite(q)) return Status::kNotFinite;  // an overflow on the way
  return q;
}

}  // namespace vbar::fsw::orbit
