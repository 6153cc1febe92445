#include "host_sim/truth/attitude/rigid_body.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <fmt/format.h>

#include "host_sim/truth/integration/event_location.h"

namespace vbar::truth {
namespace {

using fsw::Matrix3;
using fsw::Vector3;

/// Rate of rotation whose angular momentum scales the errors of a body at rest: once around in a low orbit.
constexpr double kOrbitRate_radps = 1e-3;

/// An edge is crossed in some seconds and a step takes no more than a minute: four parts miss no relevant one.
constexpr int kEdgeSamples = 4;
constexpr double kEdgeResolution_s = 1e-7;

Matrix3 checked_inverse(const Matrix3& inertia) {
  check_inertia(inertia);
  return inertia.inverse();
}

template <class Tolerance>
Tolerance uniform_tolerance(double tolerance) {
  Tolerance uniform;
  uniform.relative.setZero();
  uniform.absolute.setConstant(tolerance);
  return uniform;
}

}  // namespace

void check_inertia(const Matrix3& inertia) {
  const bool symmetric =
      inertia.allFinite() && (inertia - inertia.transpose()).cwiseAbs().maxCoeff() <= 1e-12 * inertia.norm();
  if (!symmetric) throw std::invalid_argument("an inertia tensor must be finite and symmetric");
  const Vector3 moments = Eigen::SelfAdjointEigenSolver<Matrix3>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
  if (!(moments[0] > 0.0)) throw std::invalid_argument("an inertia tensor must have principal moments above 0");
  if (!(moments[2] <= (moments[0] + moments[1]) * (1.0 + 1e-9))) {
    throw std::invalid_argument("no body has a principal moment of inertia above the sum of the other two");
  }
}

RigidBody::RigidBody(const Matrix3& inertia_kgm2, std::vector<std::unique_ptr<Torque>> torques, OrbitOfTime orbit,
                     double tolerance, double seconds, const AttitudeState& start)
    : inertia_(inertia_kgm2),
      inverse_inertia_(checked_inverse(inertia_kgm2)),
      torques_(std::move(torques)),
      orbit_(std::move(orbit)),
      integrator_(Rates{this}, uniform_tolerance<Integrator::Tolerance>(tolerance)),
      current_(seconds) {
  if (!torques_.empty() && !orbit_) throw std::invalid_argument("torques need an orbit");
  const Eigen::Quaterniond q = start.q_body_eci.normalized();
  // Eigen leaves a quaternion of zeros as it is.
  if (!(q.squaredNorm() > 0.5) || !start.rate_body.allFinite()) {
    throw std::invalid_argument("an initial attitude is not a rotation, or its rate is not finite");
  }
  const Vector3 momentum_body = inertia_ * start.rate_body;
  momentum_scale_ = std::max(momentum_body.norm(), inertia_.trace() / 3.0 * kOrbitRate_radps);
  Vector7 y;
  y << q.coeffs(), (q.conjugate() * momentum_body) / momentum_scale_;
  enter_regime_of(seconds);
  integrator_.start(seconds, y);
}

AttitudeState RigidBody::attitude_of(const Vector7& y) const {
  AttitudeState attitude;
  attitude.q_body_eci = Eigen::Quaterniond(Eigen::Vector4d(y.head<4>())).normalized();
  attitude.rate_body = inverse_inertia_ * (attitude.q_body_eci * (momentum_scale_ * y.tail<3>()));
  return attitude;
}

RigidBody::Vector7 RigidBody::rates(double seconds, const Vector7& y) {
  const AttitudeState attitude = attitude_of(y);
  const Vector3& w = attitude.rate_body;
  const Eigen::Quaterniond q(Eigen::Vector4d(y.head<4>()));
  Vector7 rate;
  rate.head<4>() = -0.5 * (Eigen::Quaterniond(0.0, w.x(), w.y(), w.z()) * q).coeffs();
  rate.tail<3>().setZero();
  if (!torques_.empty()) {
    const ForceInput orbit = orbit_(seconds);
    Vector3 torque_body = Vector3::Zero();
    for (const auto& torque : torques_) torque_body += torque->torque_body(orbit, attitude);
    rate.tail<3>() = (attitude.q_body_eci.conjugate() * torque_body) / momentum_scale_;
  }
  return rate;
}

void RigidBody::advance_to(double seconds, double orbit_step_end) {
  if (!(seconds >= current_)) throw std::invalid_argument("the attitude does not go back in time");
  // Torques see the orbit's polynomial of the current step; a torque-free body does not depend on the orbit.
  const double limit = torques_.empty() ? std::numeric_limits<double>::infinity() : orbit_step_end;
  while (integrator_.time() < seconds) step(limit);
  current_ = seconds;
  while (kept_.size() > 1 && kept_.front().end < current_ - kKeptSpan_s) kept_.pop_front();
}

void RigidBody::step(double limit) {
  const double jump = next_jump();
  integrator_.step(std::min(limit, jump));
  const std::optional<double> edge = first_edge_of_last_step();
  if (edge) integrator_.cut_last_step(*edge);
  kept_.push_back({integrator_.time(), integrator_.last_step()});
  if (edge || integrator_.time() == jump) {
    enter_regime_of(integrator_.time());
    integrator_.restart(integrator_.state());
  }
}

double RigidBody::next_jump() const {
  double first = std::numeric_limits<double>::infinity();
  for (const auto& torque : torques_) first = std::min(first, torque->next_jump_after(integrator_.time()));
  return first;
}

std::optional<double> RigidBody::first_edge_of_last_step() const {
  std::optional<double> first;
  double end = integrator_.time();
  for (const auto& torque : torques_) {
    for (int i = 0; i < torque->edge_count(); ++i) {
      const auto g = [&](double t) { return torque->edge(i, orbit_(t)); };
      const auto found = first_sign_change(g, integrator_.last_step().start, end, kEdgeSamples, kEdgeResolution_s);
      if (!found) continue;
      first = found;
      end = *found;
    }
  }
  return first;
}

/// Sides of all edges and intervals of all jumps at an instant.
void RigidBody::enter_regime_of(double seconds) {
  if (torques_.empty()) return;
  const ForceInput orbit = orbit_(seconds);
  for (const auto& torque : torques_) {
    torque->enter_interval(seconds);
    for (int i = 0; i < torque->edge_count(); ++i) torque->set_side(i, torque->edge(i, orbit) > 0.0);
  }
}

void RigidBody::orbit_changed(double seconds) {
  if (torques_.empty()) return;
  if (seconds < integrator_.time()) {
    // advance_to went no further than the step that holds `seconds`. The step may have ended at an edge or a jump, and
    // the torques been set to what follows.
    enter_regime_of(integrator_.last_step().start);
    integrator_.cut_last_step(seconds);
    kept_.back() = {seconds, integrator_.last_step()};
  }
  enter_regime_of(seconds);
  integrator_.restart(integrator_.state());
}

AttitudeState RigidBody::state_at(double seconds) const {
  if (seconds == integrator_.time()) return attitude_of(integrator_.state());
  auto kept = kept_.rbegin();
  while (kept != kept_.rend() && seconds < kept->solution.start) ++kept;
  if (kept == kept_.rend() || !(seconds <= kept->end)) {
    throw std::out_of_range(fmt::format("no attitude {} s after the epoch; kept are {} s to {} s", seconds,
                                        kept_.empty() ? current_ : kept_.front().solution.start, integrator_.time()));
  }
  return attitude_of(kept->solution(seconds));
}

}  // namespace vbar::truth
