#pragma once
// Progress along a path, limited in speed, acceleration and jerk: from rest to rest, and from any moment of a motion to
// rest. Closed forms (Biagiotti and Melchiorri 2008, section 3.4).

#include <array>
#include <cstddef>

namespace vbar::tron {

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

}  // namespace vbar::tron
