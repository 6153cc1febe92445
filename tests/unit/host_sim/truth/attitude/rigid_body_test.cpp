// Torque-free rotation against what is known of it in closed form.

#include "host_sim/truth/attitude/rigid_body.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <gtest/gtest.h>

#include "host_sim/truth/attitude/torques.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth {

namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using fsw::Matrix3;
using fsw::Vector3;

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr double kTolerance = 1e-13;  // the truth model's usual one
constexpr double kHour_s = 3600.0;

// Tango's principal moments (published research code on PRISMA), in ascending order.
const Vector3 kTango(2.685703125, 3.106463735035312, 3.458072723298021);

RigidBody free_body(const Matrix3& inertia, const AttitudeState& start, double tolerance = kTolerance) {
  return {inertia, {}, {}, tolerance, 0.0, start};
}

Matrix3 diagonal(const Vector3& moments) {
  return moments.asDiagonal();
}

/// A body whose principal axes are not its body axes.
Matrix3 turned_tango() {
  const Matrix3 R = AngleAxisd(0.7, Vector3(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  return R * diagonal(kTango) * R.transpose();
}

const Quaterniond kSomeAttitude = Quaterniond(0.3, -0.5, 0.2, 0.7).normalized();

TEST(RigidBody, KeepsAngularMomentumAndEnergy) {
  // Euler's two integrals of the torque-free body, over 6 h at the fastest tumble of the missions, 1.5 deg/s.
  const Matrix3 inertia = 0.5 * (turned_tango() + turned_tango().transpose());
  const AttitudeState start{kSomeAttitude, 1.5 * kDegree * Vector3(0.5, -0.7, 0.4).normalized()};
  RigidBody body = free_body(inertia, start);
  const Vector3 momentum_eci = start.q_body_eci.conjugate() * (inertia * start.rate_body);
  const double energy = start.rate_body.dot(inertia * start.rate_body);
  accuracy::Largest momentum_error, direction_error, energy_error;
  for (double t = 0.0; t <= 6.0 * kHour_s; t += 100.0) {
    body.advance_to(t);
    const AttitudeState now = body.state_at(t);
    const Vector3 h = inertia * now.rate_body;
    momentum_error.add(std::abs(h.norm() / momentum_eci.norm() - 1.0));
    direction_error.add((now.q_body_eci.conjugate() * h - momentum_eci).norm());
    energy_error.add(std::abs(now.rate_body.dot(h) / energy - 1.0));
  }
  // The angular momentum is integrated in ECI, where nothing changes it: rounding only.
  accuracy::expect_below("attitude: |J w| of a torque-free tumble, 6 h at 1.5 deg/s", "constant of the motion",
                         momentum_error, 1e-14, "relative");
  EXPECT_LT(direction_error / momentum_eci.norm(), 1e-14);
  // Energy feels the attitude's local errors, at most 1e-13 a step, some 10^4 steps: 1e-10 if they hardly add up.
  accuracy::expect_below("attitude: w' J w of a torque-free tumble, 6 h at 1.5 deg/s", "constant of the motion",
                         energy_error, 1e-10, "relative");
}

TEST(RigidBody, AxisymmetricBodyPrecessesAsInClosedForm) {
  // J = diag(1, 1, 2), w = (0.1, 0, 0.2) rad/s: seen from the body w1 + i w2 turns at (J3 - J1)/J1 w3 = +0.2 rad/s;
  // seen from outside the axis goes round the angular momentum at |H|/J1 while the body turns about it at (1 - J3/J1)
  // w3 (Hughes 2004, section 4.2).
  const Vector3 w0(0.1, 0.0, 0.2);
  const Vector3 moments(1.0, 1.0, 2.0);
  const AttitudeState start{kSomeAttitude, w0};
  RigidBody body = free_body(diagonal(moments), start);
  const Vector3 momentum_eci = kSomeAttitude.conjugate() * moments.cwiseProduct(w0);
  accuracy::Largest rate_error, attitude_error;
  for (double t = 0.0; t <= kHour_s; t += 7.0) {
    body.advance_to(t);
    const AttitudeState now = body.state_at(t);
    const Vector3 w(0.1 * std::cos(0.2 * t), 0.1 * std::sin(0.2 * t), 0.2);
    const Quaterniond q_eci_body = AngleAxisd(momentum_eci.norm() * t, momentum_eci.normalized()) *
                                   kSomeAttitude.conjugate() * AngleAxisd(-0.2 * t, Vector3::UnitZ());
    rate_error.add((now.rate_body - w).norm() / w.norm());
    attitude_error.add(angle_between(now.q_body_eci, q_eci_body.conjugate()));
  }
  // Some 2e4 steps with local errors up to 1e-13 change the energy by 1e-11 (6 h above: 1e-12), and a rate that is
  // wrong by as much makes a phase of 800 rad wrong by 1e-8.
  accuracy::expect_below("attitude: rate of an axisymmetric body, 1 h at 13 deg/s", "closed form (J3 - J1)/J1 w3",
                         rate_error, 2e-8, "relative");
  accuracy::expect_below("attitude: precession of an axisymmetric body, 1 h at 13 deg/s", "closed form, 515 instants",
                         attitude_error, 2e-8, "rad");
}

/// Torque-free motion of a body with moments I1 < I2 < I3 and |M|^2 > 2 E I2, by Jacobi's elliptic functions (Landau
/// and Lifshitz, Mechanics, section 37). Space axes have z along the angular momentum. w2 = 0 at time 0.
class AsymmetricTop {
 public:
  AsymmetricTop(const Vector3& moments, double w1, double w3) : moments_(moments) {
    const double i1 = moments[0], i2 = moments[1], i3 = moments[2];
    doubled_energy_ = i1 * w1 * w1 + i3 * w3 * w3;
    momentum_ = std::hypot(i1 * w1, i3 * w3);
    const double slow = doubled_energy_ * i3 - momentum_ * momentum_,
                 fast = momentum_ * momentum_ - doubled_energy_ * i1;
    amplitude_ = {std::sqrt(slow / (i1 * (i3 - i1))), std::sqrt(slow / (i2 * (i3 - i2))),
                  std::sqrt(fast / (i3 * (i3 - i1)))};
    frequency_ = std::sqrt((i3 - i2) * fast / (i1 * i2 * i3));
    modulus_ = std::sqrt((i2 - i1) * slow / ((i3 - i2) * fast));
  }

  Vector3 rate(double t) const {
    double cn = 0.0, dn = 0.0;
    const double sn = boost::math::jacobi_elliptic(modulus_, frequency_ * t, &cn, &dn);
    return {amplitude_[0] * cn, amplitude_[1] * sn, amplitude_[2] * dn};
  }

  /// Euler's angles: psi and theta say where the angular momentum is in the body, phi is a quadrature of it.
  Quaterniond q_body_eci(double t) const {
    const Vector3 m = moments_.cwiseProduct(rate(t));
    const double psi = std::atan2(m[0], m[1]), theta = std::atan2(std::hypot(m[0], m[1]), m[2]);
    const auto phi_rate = [&](double s) {
      const Vector3 w = rate(s);
      const double i1 = moments_[0], i2 = moments_[1];
      return momentum_ * (i1 * w[0] * w[0] + i2 * w[1] * w[1]) / (i1 * i1 * w[0] * w[0] + i2 * i2 * w[1] * w[1]);
    };
    double phi = 0.0;
    constexpr double kPiece_s = 20.0;  // the integrand is smooth on a few seconds: 31 points there give all digits
    for (double from = 0.0; from < t; from += kPiece_s) {
      phi += boost::math::quadrature::gauss_kronrod<double, 31>::integrate(phi_rate, from, std::min(from + kPiece_s, t),
                                                                           0);
    }
    return (AngleAxisd(phi, Vector3::UnitZ()) * AngleAxisd(theta, Vector3::UnitX()) * AngleAxisd(psi, Vector3::UnitZ()))
        .conjugate();
  }

 private:
  Vector3 moments_, amplitude_;
  double doubled_energy_, momentum_, frequency_, modulus_;
};

TEST(RigidBody, AsymmetricBodyMovesAsJacobisFunctionsSay) {
  // Tango at about 1.5 deg/s, half of it across the axis of the greatest moment, for 2 h.
  const AsymmetricTop top(kTango, 0.9 * kDegree, 1.2 * kDegree);
  RigidBody body = free_body(diagonal(kTango), {top.q_body_eci(0.0), top.rate(0.0)});
  accuracy::Largest rate_error, attitude_error;
  for (double t = 0.0; t <= 2.0 * kHour_s; t += 240.0) {
    body.advance_to(t);
    const AttitudeState now = body.state_at(t);
    rate_error.add((now.rate_body - top.rate(t)).norm() / top.rate(t).norm());
    attitude_error.add(angle_between(now.q_body_eci, top.q_body_eci(t)));
  }
  // Some 3,000 steps with local errors up to 1e-13; the interpolant inside a step is some 1e-11 off.
  accuracy::expect_below("attitude: rate of Tango tumbling, 2 h at 1.5 deg/s", "Jacobi's elliptic functions",
                         rate_error, 1e-9, "relative");
  accuracy::expect_below("attitude: Tango tumbling, 2 h at 1.5 deg/s", "Jacobi's elliptic functions and a quadrature",
                         attitude_error, 1e-9, "rad");
}

TEST(RigidBody, RotationAboutTheIntermediateAxisIsUnstable) {
  // Small rates across the axis of moment I2 grow as exp(lambda t), lambda^2 = w2^2 (I3 - I2)(I2 - I1)/(I1 I3) (Hughes
  // 2004, section 4.4), and in the end the body turns over.
  const double w2 = 1.0 * kDegree;
  const double lambda = w2 * std::sqrt((kTango[2] - kTango[1]) * (kTango[1] - kTango[0]) / (kTango[0] * kTango[2]));
  const double disturbance = 1e-7 * w2;
  RigidBody body = free_body(diagonal(kTango), {kSomeAttitude, {disturbance, w2, 0.0}});
  // w1 = disturbance cosh(lambda t), to the square of the disturbance's growth (exp(6)/2 of 1e-7) and its local errors.
  for (const double growth : {1.0, 3.0, 6.0}) {
    const double t = growth / lambda;
    body.advance_to(t);
    EXPECT_NEAR(body.state_at(t).rate_body[0] / (disturbance * std::cosh(growth)), 1.0, 1e-5) << growth;
  }
  accuracy::Smallest least{w2};
  for (double t = 6.0 / lambda; t < 40.0 / lambda; t += 10.0) {
    body.advance_to(t);
    least.add(body.state_at(t).rate_body[1]);
  }
  EXPECT_NEAR(least, -w2, 1e-3 * w2);  // 10 s beside the turn's end leave 1e-4 of it
}

TEST(RigidBody, RotationAboutTheOuterAxesIsStable) {
  for (const int axis : {0, 2}) {
    Vector3 w = Vector3::Constant(1e-7 * kDegree);
    w[axis] = 1.0 * kDegree;
    RigidBody body = free_body(diagonal(kTango), {kSomeAttitude, w});
    accuracy::Largest farthest;
    for (double t = 0.0; t < 2.0 * kHour_s; t += 10.0) {
      body.advance_to(t);
      Vector3 across = body.state_at(t).rate_body;
      across[axis] = 0.0;
      farthest.add(across.norm());
    }
    // The polhode is an ellipse of axis ratio below 2 for these moments.
    EXPECT_LT(farthest, 3.0 * std::sqrt(2.0) * 1e-7 * kDegree) << axis;
  }
}

TEST(RigidBody, MotionReversedReturnsToTheStart) {
  // Torque-free motion with all rates reversed runs back the way it came.
  const AttitudeState start{kSomeAttitude, 1.5 * kDegree * Vector3(0.5, -0.7, 0.4).normalized()};
  const double span = 6.0 * kHour_s;
  RigidBody there = free_body(turned_tango(), start);
  there.advance_to(span);
  AttitudeState turn = there.state_at(span);
  turn.rate_body = -turn.rate_body;
  RigidBody back = free_body(turned_tango(), turn);
  back.advance_to(span);
  const AttitudeState end = back.state_at(span);
  // Twice 6 h of local errors up to 1e-13, some 10^4 steps each way, that add up with the phase.
  accuracy::expect_below("attitude: 6 h tumble and back at 1.5 deg/s", "the start",
                         angle_between(end.q_body_eci, start.q_body_eci), 1e-9, "rad");
  EXPECT_LT((end.rate_body + start.rate_body).norm() / start.rate_body.norm(), 1e-9);
}

/// Nothing; but a body under torques ends its steps where the orbit's end.
class NoTorque final : public Torque {
 public:
  std::string_view name() const override { return "none"; }
  Vector3 torque_body(const ForceInput&, const AttitudeState&) override { return Vector3::Zero(); }
};

TEST(RigidBody, ConvergesWithOrderFive) {
  // Errors after 10 min, at the end of a step, against numbers of steps, tolerances a factor 1e3 apart: the slope is
  // the order. The step-size control is not exactly proportional: 0.3.
  const AsymmetricTop top(kTango, 9.0 * kDegree, 12.0 * kDegree);
  const double end = 600.0;
  const auto error_and_steps = [&](double tolerance) {
    std::vector<std::unique_ptr<Torque>> torques;
    torques.push_back(std::make_unique<NoTorque>());
    const auto no_orbit = [](double) { return ForceInput{}; };
    const AttitudeState start{top.q_body_eci(0.0), top.rate(0.0)};
    RigidBody body(diagonal(kTango), std::move(torques), no_orbit, tolerance, 0.0, start);
    body.advance_to(end, end);
    const double error = (body.state_at(end).rate_body - top.rate(end)).norm();
    return std::pair(error, static_cast<double>(body.statistics().accepted_steps));
  };
  const auto [coarse_error, coarse_steps] = error_and_steps(1e-7);
  const auto [fine_error, fine_steps] = error_and_steps(1e-10);
  const double order = std::log(coarse_error / fine_error) / std::log(fine_steps / coarse_steps);
  EXPECT_NEAR(order, 5.0, 0.3);
}

}  // namespace

}  // namespace vbar::truth

namespace vbar::truth::test {

// What a rigid body's integration depends on, what it keeps, and what it refuses.

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
