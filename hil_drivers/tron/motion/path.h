#pragma once
// A motion of both arms and the carriage, given at every robot cycle: straight in joint space from posture to posture,
// all 13 axes synchronised, at rest at each. A pure function of the cycle.

#include <vector>

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/kinematics/posture.h"
#include "hil_drivers/tron/motion/s_curve.h"

namespace vbar::tron {

/// Returns the posture between two, `share` from 0 to 1.
[[nodiscard]] Posture between(const Posture& from, const Posture& to, double share);

/// Limits the share of a straight path that is covered by the limits of all axes, times the override.
class AxisLimitsOfBench {
 public:
  explicit AxisLimitsOfBench(const BenchFile& bench);

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
  void go_to(const Posture& posture, const AxisLimitsOfBench& limits, double cycle_s);

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

}  // namespace vbar::tron
