#pragma once
// From 0 to 1, rest to rest, with limits on speed, acceleration and jerk, in the shortest time: the symmetric profile
// of seven segments in closed form (for example Biagiotti, Melchiorri 2008, "Trajectory planning for automatic machines
// and robots", section 3.4).

namespace vbar::tron {

struct RateLimits {
  double speed = 0.0, acceleration = 0.0, jerk = 0.0;  ///< 1/s, 1/s2, 1/s3
};

class SCurve {
 public:
  /// Limits above 0.
  explicit SCurve(const RateLimits& limits);

  [[nodiscard]] double duration_s() const { return 2.0 * ramp_s_ + cruise_s_; }

  struct State {
    double position = 0.0, speed = 0.0, acceleration = 0.0;
  };
  /// At rest outside 0 to duration_s().
  [[nodiscard]] State at(double time_s) const;

 private:
  [[nodiscard]] State ramp_up(double time_s) const;

  double jerk_;
  double jerk_s_ = 0.0;  ///< of each phase of jerk
  double ramp_s_ = 0.0;  ///< until the cruise
  double cruise_s_ = 0.0;
  double acceleration_ = 0.0, speed_ = 0.0;  ///< reached
};

}  // namespace vbar::tron
