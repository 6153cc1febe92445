// What a rigid body's integration depends on, what it keeps, and what it refuses.

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "host_sim/truth/attitude/rigid_body.h"
#include "host_sim/truth/attitude/torques.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth::test {
namespace {

using fsw::Matrix3;
using fsw::Vector3;

const Matrix3 kInertia = Vector3(2.7, 3.1, 3.5).asDiagonal();
const AttitudeState kStart{Eigen::Quaterniond(0.3, -0.5, 0.2, 0.7).normalized(), {0.01, -0.02, 0.005}};
constexpr double kTolerance = 1e-12;

/// A constant torque about the body's x axis until a date, then none.
class PushUntil final : public Torque {
 public:
  PushUntil(double torque, double end) : torque_(torque), end_(end) {}
  std::string_view name() const override { return "push"; }
  Vector3 torque_body(const ForceInput&, const AttitudeState&) override { return {on_ ? torque_ : 0.0, 0.0, 0.0}; }
  int edge_count() const override { return 1; }
  double edge(int, const ForceInput& orbit) const override { return end_ - orbit.seconds; }
  void set_side(int, bool positive) override { on_ = positive; }

 private:
  double torque_;
  double end_;
  bool on_ = true;
};

std::vector<std::unique_ptr<Torque>> gravity_gradient() {
  std::vector<std::unique_ptr<Torque>> torques;
  torques.push_back(std::make_unique<GravityGradientTorque>(kGm, kInertia));
  return torques;
}

RigidBody orbiting_body() {
  return {kInertia, gravity_gradient(), CircularOrbit{}, kTolerance, 0.0, kStart};
}

/// Advances as the spacecraft's propagator does, whose orbit steps are 45 s long here.
void advance(RigidBody& body, double from, double to) {
  constexpr double kOrbitStep_s = 45.0;
  double end = std::ceil(from / kOrbitStep_s) * kOrbitStep_s;
  for (; end < to; end += kOrbitStep_s) body.advance_to(end, end);
  body.advance_to(to, end);
}

bool same_bits(const AttitudeState& a, const AttitudeState& b) {
  return a.q_body_eci.coeffs() == b.q_body_eci.coeffs() && a.rate_body == b.rate_body;
}

TEST(RigidBodySteps, DoNotDependOnTheTimesAskedFor) {
  RigidBody at_once = orbiting_body(), often = orbiting_body();
  advance(at_once, 0.0, 5000.0);
  double t = 0.0;
  for (double next = 0.7; next < 5000.0; next += 13.37) {
    advance(often, t, next);
    static_cast<void>(often.state_at(next));
    t = next;
  }
  advance(often, t, 5000.0);
  EXPECT_TRUE(same_bits(at_once.state_at(5000.0), often.state_at(5000.0)));
  EXPECT_TRUE(same_bits(at_once.state_at(4321.0), often.state_at(4321.0)));
  EXPECT_EQ(at_once.statistics().evaluations, often.statistics().evaluations);
}

TEST(RigidBodySteps, TorqueFreeMotionIgnoresTheOrbit) {
  RigidBody alone(kInertia, {}, {}, kTolerance, 0.0, kStart), beside(kInertia, {}, {}, kTolerance, 0.0, kStart);
  alone.advance_to(3000.0);
  advance(beside, 0.0, 1000.0);
  beside.orbit_changed(1000.0);
  advance(beside, 1000.0, 3000.0);
  EXPECT_TRUE(same_bits(alone.state_at(3000.0), beside.state_at(3000.0)));
}

TEST(RigidBodySteps, AChangedOrbitCountsFromItsTimeOn) {
  // From 1000 s on, in the middle of a step, the spacecraft flies on at another speed. Reference: two bodies, the
  // second begins there.
  struct FasterFrom {
    const bool* changed;
    ForceInput operator()(double t) const {
      return CircularOrbit{}(*changed && t > 1000.0 ? 1000.0 + 1.5 * (t - 1000.0) : t);
    }
  };
  bool changed = false;
  RigidBody body(kInertia, gravity_gradient(), FasterFrom{&changed}, kTolerance, 0.0, kStart);
  advance(body, 0.0, 1000.0);
  changed = true;
  body.orbit_changed(1000.0);
  advance(body, 1000.0, 3000.0);

  RigidBody before = orbiting_body();
  advance(before, 0.0, 1000.0);
  RigidBody after(kInertia, gravity_gradient(), FasterFrom{&changed}, kTolerance, 1000.0, before.state_at(1000.0));
  advance(after, 1000.0, 3000.0);
  // Different steps with local errors of 1e-12, some 10^3 of them.
  EXPECT_LT(angle_between(body.state_at(3000.0).q_body_eci, after.state_at(3000.0).q_body_eci), 1e-9);
  EXPECT_LT((body.state_at(3000.0).rate_body - after.state_at(3000.0).rate_body).norm(), 1e-11);
}

TEST(RigidBodySteps, EndAtATorquesEdge) {
  // A push of 1 mN m for 123.456 s leaves w = T t / J, to the resolution at which edges are found (1e-7 s); without
  // knowing the edge the integrator would have to find it by rejected steps.
  const double torque = 1e-3, end = 123.456;
  std::vector<std::unique_ptr<Torque>> torques;
  torques.push_back(std::make_unique<PushUntil>(torque, end));
  RigidBody body(kInertia, std::move(torques), CircularOrbit{}, kTolerance, 0.0,
                 {Eigen::Quaterniond::Identity(), Vector3::Zero()});
  advance(body, 0.0, 300.0);
  EXPECT_NEAR(body.state_at(300.0).rate_body.x(), torque * end / 2.7, torque * 1.1e-7 / 2.7);
  EXPECT_EQ(body.statistics().rejected_steps, 0);
}

TEST(RigidBodySteps, KeepTheLastMinutes) {
  RigidBody body = orbiting_body();
  advance(body, 0.0, 4000.0);
  EXPECT_NO_THROW(static_cast<void>(body.state_at(4000.0 - RigidBody::kKeptSpan_s)));
  EXPECT_THROW(static_cast<void>(body.state_at(2000.0)), std::out_of_range);
  EXPECT_THROW(static_cast<void>(body.state_at(5000.0)), std::out_of_range);
  EXPECT_THROW(body.advance_to(3999.0), std::invalid_argument);
}

TEST(RigidBodySteps, ABodyAtRestStaysAtRest) {
  RigidBody body(kInertia, {}, {}, kTolerance, 0.0, {kStart.q_body_eci, Vector3::Zero()});
  body.advance_to(1e5);
  EXPECT_EQ(body.state_at(1e5).rate_body, Vector3::Zero());
  EXPECT_LT(angle_between(body.state_at(12345.0 + 87000.0).q_body_eci, kStart.q_body_eci), 1e-15);
}

TEST(RigidBodySteps, RefuseWhatIsNoBody) {
  const auto diagonal = [](double a, double b, double c) -> Matrix3 { return Vector3(a, b, c).asDiagonal(); };
  EXPECT_NO_THROW(check_inertia(diagonal(1.0, 1.0, 2.0)));  // a flat disk
  EXPECT_THROW(check_inertia(diagonal(1.0, 1.0, 2.1)), std::invalid_argument);
  EXPECT_THROW(check_inertia(diagonal(1.0, 0.0, 1.0)), std::invalid_argument);
  EXPECT_THROW(check_inertia(diagonal(1.0, -1.0, 1.0)), std::invalid_argument);
  EXPECT_THROW(check_inertia(diagonal(1.0, std::numeric_limits<double>::quiet_NaN(), 1.0)), std::invalid_argument);
  Matrix3 skew = diagonal(1.0, 1.0, 1.0);
  skew(0, 1) = 0.1;
  EXPECT_THROW(check_inertia(skew), std::invalid_argument);
  EXPECT_THROW(RigidBody(kInertia, gravity_gradient(), {}, kTolerance, 0.0, kStart), std::invalid_argument);
  AttitudeState no_number = kStart;
  no_number.rate_body.y() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(RigidBody(kInertia, {}, {}, kTolerance, 0.0, no_number), std::invalid_argument);
  no_number = {Eigen::Quaterniond(0.0, 0.0, 0.0, 0.0), Vector3::Zero()};
  EXPECT_THROW(RigidBody(kInertia, {}, {}, kTolerance, 0.0, no_number), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::truth::test
