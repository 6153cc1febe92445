#pragma once
// Motorised lead-screw axis: counted microsteps, and the real place of its carriage.

#include <cstdint>
#include <optional>
#include <string>

#include "host_sim/engine/random_stream.h"

namespace vbar::zaber {

struct AxisSettings {
  double microstep_um = 0.047625;
  double travel_um = 101600.0;
  double backlash_um = 3.0;       ///< the carriage lags behind the screw when it comes from above
  double repeatability_um = 0.5;  ///< one sigma, drawn for every place that is approached
  double speed_um_s = 20000.0;
  double start_um = 50800.0;   ///< place of the carriage when the power comes on
  bool moves_at_once = false;  ///< a move lasts no time: it is under way until the state is asked for
};

class Axis {
 public:
  Axis(const AxisSettings& settings, engine::RandomStream places);

  // Homes the axis. Times in seconds, never decreasing.
  void home(double now_s);
  /// Moves to a counted place; returns false if it is beyond the limits.
  [[nodiscard]] bool move_to(std::int64_t microsteps, double now_s);
  /// Moves at a constant speed, microsteps/s, up to a limit.
  void move_at(double microsteps_per_s, double now_s);
  void stop(double now_s);
  void advance(double now_s);
  [[nodiscard]] bool is_busy() const { return move_.has_value(); }

  [[nodiscard]] std::int64_t count() const { return count_; }
  void set_count(std::int64_t microsteps);
  [[nodiscard]] std::int64_t limit_min() const { return limit_min_; }
  [[nodiscard]] std::int64_t limit_max() const { return limit_max_; }
  void set_limits(std::int64_t min, std::int64_t max);
  [[nodiscard]] double speed_um_s() const { return speed_um_s_; }
  void set_speed(double um_s) { speed_um_s_ = um_s; }
  [[nodiscard]] double microstep_um() const { return settings_.microstep_um; }

  [[nodiscard]] bool is_homed() const { return is_homed_; }
  /// Returns the gravest warning, "--" without one.
  [[nodiscard]] std::string warning() const;
  /// Clears the warnings that stay until then.
  void clear_warnings();

  /// Returns the place of the carriage, from the home sensor.
  [[nodiscard]] double carriage_um() const;

  // Faults.
  /// The carriage is blocked: the next move stalls half way.
  void block() { is_blocked_ = true; }
  void release() { is_blocked_ = false; }
  [[nodiscard]] std::uint64_t stalls() const { return stalls_; }
  /// Displaces the carriage by hand, at the knob of the screw: the count follows.
  void displace(double um);

 private:
  struct Move {
    std::int64_t target = 0;
    double begin_s = 0.0, end_s = 0.0;
    std::int64_t begin_count = 0;
    bool is_homing = false;
    bool stalls = false;
  };
  void begin(std::int64_t target, double speed_um_s, bool is_homing, double now_s);
  void arrive(const Move& move);
  void settle(std::int64_t from, std::int64_t to);

  AxisSettings settings_;
  engine::RandomStream places_;
  std::int64_t count_ = 0;
  double count_to_carriage_um_;  ///< carriage of count 0, without lag and scatter
  double lag_um_ = 0.0, scatter_um_ = 0.0;
  double speed_um_s_;
  std::int64_t limit_min_ = 0, limit_max_;
  std::optional<Move> move_;
  bool is_homed_ = false, is_blocked_ = false;
  bool has_stalled_ = false, was_interrupted_ = false, was_displaced_ = false;
  std::uint64_t stalls_ = 0;
};

}  // namespace vbar::zaber
