#include "fsw/navigation/pose_attitude.h"

#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"
#include "fsw/orbit/constants.h"

namespace vbar::fsw::navigation {
namespace {

constexpr double kMaxStep_s = 2.5;
constexpr int kMaxSteps = 1440;

using Vector4 = Eigen::Matrix<double, 4, 1>;

struct Rates {
  Vector4 quaternion;  // x, y, z, w
  Vector3 rate;
};

Rates rates_of(const Vector4& q, const Vector3& rate, const Inertia& inertia, const GravityGradient& gradient) {
  Rates d;
  const Vector3 v = q.head<3>();
  d.quaternion.head<3>() = 0.5 * (q(3) * rate + v.cross(rate));
  d.quaternion(3) = -0.5 * v.dot(rate);
  Vector3 torque = (inertia.tensor * rate).cross(rate);
  if (gradient.strength != 0.0) {
    // R_body_eci u without the matrix; the length of q is 1 to the rounding errors of the integration.
    const Vector3 across = 2.0 * gradient.vertical_eci.cross(v);
    const Vector3 vertical = gradient.vertical_eci + q(3) * across + across.cross(v);
    torque += gradient.strength * vertical.cross(inertia.tensor * vertical);
  }
  d.rate = inertia.inverse * torque;
  return d;
}

Vector4 normalised(const Vector4& q) {
  return q / math::sqrt(q.squaredNorm());
}

}  // namespace

Result<Inertia> inertia_of(const Matrix3& tensor) {
  if (!math::is_finite(tensor.sum())) return Status::kNotFinite;
  const double asymmetry = (tensor - tensor.transpose()).cwiseAbs().maxCoeff();
  const math::Cholesky<3> factor(tensor);
  if (!factor.ok() || !(asymmetry <= 1e-9 * tensor.diagonal().maxCoeff())) return Status::kOutOfRange;
  return Inertia{tensor, factor.inverse()};
}

GravityGradient gravity_gradient_at(const Vector3& position_eci) {
  const double r2 = position_eci.squaredNorm();
  const double r = math::sqrt(r2);
  return {.vertical_eci = position_eci / r, .strength = 3.0 * orbit::kMu / (r2 * r)};
}

AttitudeState propagate_attitude(const AttitudeState& state, const Inertia& inertia, const GravityGradient& gradient,
                                 double dt) {
  int steps = 1;
  while (steps < kMaxSteps && math::abs(dt) > steps * kMaxStep_s) ++steps;
  const double h = dt / steps;
  Vector4 q = state.q_eci_body.coeffs();
  Vector3 rate = state.rate_body;
  for (int k = 0; k < steps; ++k) {
    const Rates a = rates_of(q, rate, inertia, gradient);
    const Rates b = rates_of(q + 0.5 * h * a.quaternion, rate + 0.5 * h * a.rate, inertia, gradient);
    const Rates c = rates_of(q + 0.5 * h * b.quaternion, rate + 0.5 * h * b.rate, inertia, gradient);
    const Rates d = rates_of(q + h * c.quaternion, rate + h * c.rate, inertia, gradient);
    q = normalised(q + h / 6.0 * (a.quaternion + 2.0 * b.quaternion + 2.0 * c.quaternion + d.quaternion));
    rate += h / 6.0 * (a.rate + 2.0 * b.rate + 2.0 * c.rate + d.rate);
  }
  AttitudeState later;
  later.q_eci_body.coeffs() = q;
  later.rate_body = rate;
  return later;
}

Vector3 grp_of(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  return 4.0 * sign / (1.0 + math::abs(q.w())) * q.vec();
}

Eigen::Quaterniond quaternion_of_grp(const Vector3& grp) {
  const double square = grp.squaredNorm();
  const double w = (16.0 - square) / (16.0 + square);
  Eigen::Quaterniond q;
  q.w() = w;
  q.vec() = 0.25 * (1.0 + w) * grp;
  return q;
}

Vector3 rotation_vector_of(const Eigen::Quaterniond& q) {
  const double sine = math::sqrt(q.vec().squaredNorm());
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  if (sine < 1e-12) return 2.0 * sign * q.vec();
  return 2.0 * sign * math::atan2(sine, math::abs(q.w())) / sine * q.vec();
}

Eigen::Quaterniond quaternion_of_rotation_vector(const Vector3& rotation) {
  const double angle = math::sqrt(rotation.squaredNorm());
  Eigen::Quaterniond q;
  q.w() = math::cos(0.5 * angle);
  q.vec() = angle < 1e-12 ? Vector3(0.5 * rotation) : Vector3(math::sin(0.5 * angle) / angle * rotation);
  return q;
}

}  // namespace vbar::fsw::navigation
