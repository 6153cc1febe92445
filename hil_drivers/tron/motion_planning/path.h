#pragma once
// A motion of both arms and the carriage, given at every robot cycle: straight in joint space from posture to posture,
// all 13 axes synchronised, at rest at each. A pure function of the cycle.

#include <array>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "hil_drivers/tron/geometry/collision.h"
#include "hil_drivers/tron/geometry/kinematics.h"
#include "hil_drivers/tron/geometry/testbed_design.h"

namespace vbar::tron {

// Progress along a path, limited in speed, acceleration and jerk: from rest to rest, and from any moment of a motion to
// rest. Closed forms (Biagiotti and Melchiorri 2008, section 3.4).

/// Holds limits, all positive.
struct ProgressLimits {
  double speed = 0.0, acceleration = 0.0, jerk = 0.0;
};

struct Progress {
  double place = 0.0, speed = 0.0, acceleration = 0.0;
};

/// Returns the duration of the fastest motion from rest to rest over `distance` >= 0, s.
[[nodiscard]] double rest_to_rest_s(double distance, const ProgressLimits& limits);

class SCurve {
 public:
  SCurve() = default;
  /// Returns the fastest motion from 0 to `distance` >= 0.
  static SCurve rest_to_rest(double distance, const ProgressLimits& limits);

  [[nodiscard]] double duration_s() const { return duration_s_; }
  /// Returns the progress at a time: at rest before 0 and after the end.
  [[nodiscard]] Progress at(double time_s) const;

  /// Slows down from `time_s` on as fast as the limits of this motion permit; begins at 0 s. It comes to rest at
  /// or before the end of this motion.
  [[nodiscard]] SCurve stop_at(double time_s) const;

 private:
  static constexpr std::size_t kPhasesMax = 7;
  struct Phase {
    double begin_s = 0.0, jerk = 0.0;
    Progress start;
  };
  void add(double duration_s, double jerk);

  ProgressLimits limits_;
  std::array<Phase, kPhasesMax> phases_{};
  std::size_t count_ = 0;
  double duration_s_ = 0.0;
  Progress end_;  ///< after the last phase
};

/// Returns the posture between two, `share` from 0 to 1.
[[nodiscard]] Posture between(const Posture& from, const Posture& to, double share);

/// Limits the share of a straight path that is covered by the limits of all axes, times the override.
class TestbedAxisLimits {
 public:
  explicit TestbedAxisLimits(const TestbedDesign& bench);

  /// Returns the limits of the path parameter from 0 to 1; infinite if nothing moves. Parts of a path (one arm alone)
  /// combine by slower_of.
  [[nodiscard]] ProgressLimits of(const Posture& from, const Posture& to) const;
  [[nodiscard]] ProgressLimits of_camera_arm(const Joints& from, const Joints& to) const;
  [[nodiscard]] ProgressLimits of_target_arm(const Joints& from, const Joints& to) const;
  [[nodiscard]] ProgressLimits of_carriage(double from_m, double to_m) const;
  [[nodiscard]] static ProgressLimits slower_of(const ProgressLimits& one, const ProgressLimits& other);

 private:
  std::array<AxisLimits, kJoints> camera_, target_;
  AxisLimits track_;
};

class Path {
 public:
  /// Makes a path that leads nowhere.
  explicit Path(const Posture& at = {}) : start_(at), end_(at) {}

  /// Adds a straight leg from the end; no cycles if it leads nowhere. Throws std::invalid_argument for a posture that
  /// is not finite.
  void go_to(const Posture& posture, const TestbedAxisLimits& limits, double cycle_s);

  [[nodiscard]] int cycles() const;  ///< the last is at rest
  /// Returns the posture after a number of cycles: 0 is the start, `cycles()` the end.
  [[nodiscard]] Posture at(int cycle) const;
  /// Returns the path that slows down along this one from `at(cycle)` on; its own cycle 0 is that posture. It comes to
  /// rest within the leg.
  [[nodiscard]] Path stop_after(int cycle) const;

  [[nodiscard]] const Posture& start() const { return start_; }
  [[nodiscard]] const Posture& end() const { return end_; }

 private:
  struct Leg {
    Posture from, to;
    SCurve curve;  ///< motion of the share
    int first = 0, cycles = 0;
    double cycle_s = 0.004;
  };
  [[nodiscard]] static Posture on(const Leg& leg, int cycle);

  Posture start_, end_;
  std::vector<Leg> legs_;
};

// Paths free of collisions: straight in joint space, or over a retracted posture.

/// States why there is no path, one sentence.
struct PathFailure {
  std::string reason;
};

class PathPlanner {
 public:
  /// `bodies` must outlive the planner.
  PathPlanner(const TestbedDesign& bench, const TestbedBodies& bodies);

  [[nodiscard]] const TestbedAxisLimits& limits() const { return limits_; }

  /// Returns the straight path if it is free, else the fastest free detour: one arm or both go to their home posture
  /// first. An end beyond limits, in collision or not finite has no path. A corrected posture may be closer than the
  /// clearance: from and to one, half the clearance is kept.
  [[nodiscard]] std::variant<Path, PathFailure> plan(const Posture& from, const Posture& to) const;
  /// Returns true if the straight path is free.
  [[nodiscard]] bool is_straight_free(const Posture& from, const Posture& to) const;

 private:
  [[nodiscard]] std::string refusal_of(const Posture& posture) const;
  [[nodiscard]] double clearance_for(const Posture& from, const Posture& to) const;
  [[nodiscard]] Path through(const Posture& from, const std::vector<Posture>& postures) const;

  const TestbedBodies& bodies_;
  TestbedAxisLimits limits_;
  AxisLimits track_;
  Joints camera_home_, target_home_;
  double cable_turn_rad_, cycle_s_;
};

}  // namespace vbar::tron
