#pragma once
// Propagation of one spacecraft: its dynamics, the integrator, and the dense output of the last few steps.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/attitude/attitude_motion.h"
#include "host_sim/truth/attitude/pointing_profile.h"
#include "host_sim/truth/integration/dopri5.h"
#include "host_sim/truth/spacecraft_dynamics.h"

namespace vbar::truth {

/// Times are seconds after the model's epoch. The integrator's steps do not depend on the times asked for, so neither
/// does the trajectory; only impulses and the forces' jumps end a step. Not thread-safe: one thread per spacecraft.
///
/// Where a force jumps (force.h), a step ends: at dates exactly, at edges within kEdgeResolution beyond the edge of the
/// dense output. Along each step every edge is sampled twice or more, at most a twelfth of the perigee circle's
/// period apart (8 minutes in a low orbit; steps are shorter there), and a dip between these samples is followed to its
/// minimum: a grazing passage through the shadow of a tenth of a second is detected.
class SpacecraftPropagator {
 public:
  /// Starts at `seconds` with an osculating state. `tolerance`: local error of each element a step, relative for the
  /// semi-major axis, absolute for the others (rad, or eccentricity); so tolerance times semi-major axis is about the
  /// local position error. Throws std::domain_error, naming the spacecraft and the date, if the state is not that
  /// of an ellipse above the Earth's atmosphere.
  SpacecraftPropagator(std::unique_ptr<SpacecraftDynamics> dynamics, double tolerance, double seconds,
                       const fsw::orbit::CartesianState& osculating);

  /// Moves the current time to `seconds`, not before it. Throws std::domain_error, naming the spacecraft
  /// and the date, on re-entry or if the orbit ceases to be an ellipse.
  void advance_to(double seconds);

  /// Returns the state at the current time.
  fsw::orbit::CartesianState state() const { return state_at(current_); }

  /// Returns the state at a time from the beginning of the steps still kept (some minutes; kKeptSteps) to the end of
  /// the last one, which may lie after the current time. At an impulse's time: after it. Throws std::out_of_range
  /// outside, stating what is kept.
  fsw::orbit::CartesianState state_at(double seconds) const;

  /// Returns the state with the total acceleration.
  OrbitalMotion motion_at(double seconds) const;

  /// Returns the input of torques at a time as in state_at; for a time after the end of the last step, the input there:
  /// the first guess of an attitude step, or rounding, may reach beyond.
  ForceInput surroundings_at(double seconds) const;

  /// Gives the spacecraft an attitude, known at the current time; from then on it is carried along.
  void set_attitude(std::unique_ptr<AttitudeMotion> attitude) { attitude_ = std::move(attitude); }
  bool has_attitude() const { return attitude_ != nullptr; }

  /// Returns the attitude motion; null if it has none.
  AttitudeMotion* attitude() { return attitude_.get(); }

  /// Returns the attitude at a time as in state_at. Throws std::logic_error if the spacecraft has none,
  /// std::domain_error, naming the spacecraft, where it is not defined.
  AttitudeState attitude_at(double seconds) const;

  /// Adds `dv_rtn` (m/s, in the spacecraft's own RTN) to the velocity at the current time.
  void apply_impulse_rtn(const fsw::Vector3& dv_rtn);

  /// Begins a burn with a duration at the current time, `arc.begin_s`. Throws as SpacecraftDynamics::add_burn().
  void begin_burn(const ThrustArc& arc);

  /// Returns whether advance_to(seconds) would have to integrate.
  bool needs_steps_to(double seconds) const { return integrator_.time() < seconds; }

  /// Returns the end of the last step.
  double known_until() const { return integrator_.time(); }

  /// Returns the forces' shares of the acceleration at the current time.
  std::vector<ForceAcceleration> accelerations() { return dynamics_->accelerations(current_, state()); }

  SpacecraftDynamics& dynamics() { return *dynamics_; }
  const std::string& name() const { return dynamics_->name(); }
  const IntegrationStatistics& statistics() const { return integrator_.statistics(); }
  std::int64_t edges_crossed() const { return edges_crossed_; }

  static constexpr std::size_t kKeptSteps = 8;
  static constexpr double kEdgeResolution = 1e-7;  ///< s; the force's error in it is far below any tolerance's

 private:
  struct Rates {
    SpacecraftDynamics* dynamics;
    fsw::Vector6 operator()(double t, const fsw::Vector6& y) const { return dynamics->element_rates(t, y); }
  };
  using Integrator = Dopri5<6, Rates>;

  struct KeptStep {
    double end;
    DenseStep<6> solution;
  };

  struct Crossing {
    double seconds;
    int edge;
  };

  void step();
  std::optional<Crossing> first_crossing_in_last_step() const;
  double edge_in_last_step(int edge, double seconds) const;
  void retake_last_step_to(double seconds);
  fsw::orbit::CartesianState cartesian(const fsw::Vector6& elements) const;

  std::unique_ptr<SpacecraftDynamics> dynamics_;
  Integrator integrator_;
  std::deque<KeptStep> kept_;        ///< oldest first; since the last impulse's step, times without gaps
  ForceRegime regime_of_last_step_;  ///< as it was when that step was taken
  std::int64_t edges_crossed_ = 0;
  double current_;
  std::unique_ptr<AttitudeMotion> attitude_;
};

}  // namespace vbar::truth
