#pragma once
// Rotation of a rigid body under torques, torque-free if there are none.
//
// Euler's equations, dH/dt = T about the centre of mass (Wertz 1978, eq. 16-5; Hughes 2004, eq. 3.3.8), with H taken in
// ECI axes: it then changes by torque alone, so that a torque-free body keeps its angular momentum to the last bit.
//   h_eci'     = R_eci_body T_body
//   q_body_eci' = -1/2 w q_body_eci   (w = rate in body axes as a pure quaternion),  w = J^-1 R_body_eci h_eci

#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "host_sim/truth/attitude/attitude_motion.h"
#include "host_sim/truth/attitude/torques.h"
#include "host_sim/truth/integration/dopri5.h"

namespace vbar::truth {

/// Throws std::invalid_argument unless `inertia_kgm2` is the inertia tensor of a body: finite, symmetric, with
/// principal moments above 0 none of which exceeds the sum of the other two (to 1e-9 of them: a flat plate meets it
/// exactly).
void check_inertia(const fsw::Matrix3& inertia_kgm2);

/// Rotation of one body. The integrator's steps depend on the start, the torques and the orbit with its steps only: not
/// on the times asked for, so neither does the motion.
class RigidBody final : public AttitudeMotion {
 public:
  /// The orbit at a time for which it is known; asked for only if there are torques.
  using OrbitOfTime = std::function<ForceInput(double seconds)>;

  /// Makes a body. `inertia_kgm2`: about the centre of mass, in body axes (check_inertia). `tolerance`: local error a
  /// step, in rad of attitude, and relative to the greater of the initial angular momentum and that of a body which
  /// rotates once an orbit. `orbit` may be empty if there are no torques.
  RigidBody(const fsw::Matrix3& inertia_kgm2, std::vector<std::unique_ptr<Torque>> torques, OrbitOfTime orbit,
            double tolerance, double seconds, const AttitudeState& start);

  void advance_to(double seconds, double orbit_step_end) override;

  /// Advances a torque-free body, which needs no orbit.
  void advance_to(double seconds) { advance_to(seconds, std::numeric_limits<double>::infinity()); }

  void orbit_changed(double seconds) override;

  /// Returns the attitude at a time that is kept: from kKeptSpan_s before the last time asked for, up to the end of the
  /// last step.
  [[nodiscard]] AttitudeState state_at(double seconds) const override;

  [[nodiscard]] const IntegrationStatistics& statistics() const { return integrator_.statistics(); }

  /// Span of the kept steps: not longer than an orbit propagator keeps its steps; a shorter span would limit callers
  /// that need both.
  static constexpr double kKeptSpan_s = 900.0;

 private:
  /// Quaternion q_body_eci (x, y, z, w) and angular momentum in ECI axes (N m s) over its scale. The equations do not
  /// depend on the quaternion's length, so its slow drift from 1 is not corrected here: state_at() normalises.
  using Vector7 = Eigen::Matrix<double, 7, 1>;

  struct Rates {
    RigidBody* body;
    Vector7 operator()(double t, const Vector7& y) const { return body->rates(t, y); }
  };
  using Integrator = Dopri5<7, Rates>;

  struct KeptStep {
    double end;
    DenseStep<7> solution;
  };

  [[nodiscard]] Vector7 rates(double seconds, const Vector7& y);
  [[nodiscard]] AttitudeState attitude_of(const Vector7& y) const;
  void step(double limit);
  [[nodiscard]] double next_jump() const;
  [[nodiscard]] std::optional<double> first_edge_of_last_step() const;
  void enter_regime_of(double seconds);

  fsw::Matrix3 inertia_;
  fsw::Matrix3 inverse_inertia_;
  double momentum_scale_ = 1.0;
  std::vector<std::unique_ptr<Torque>> torques_;
  OrbitOfTime orbit_;
  Integrator integrator_;
  std::deque<KeptStep> kept_;  ///< oldest first, times without gaps
  double current_;
};

}  // namespace vbar::truth
