#pragma once
// Motion of one vehicle in the generator: the last sample extrapolated by its derivatives, joined smoothly to the
// motion before.
//
// The motion is computed up to an advance before the present (the engine's latency; zero in lock-step). A sample is
// used from its own time on, or from the end of what is computed. The curve from there on is the sample's polynomial of
// degree 3 plus a quintic that takes up the difference of position, velocity and acceleration to the old curve and
// vanishes with two derivatives after the join time. Differences above kSnapDistance_m are not joined: the motion
// jumps.
//
// The join time must be greater than latency, sample period and network delay together (Skydel's remote API, example of
// its hardware-in-the-loop interface): computed motion beyond the join time of the newest sample is non-deterministic,
// and a sample is late if its delay alone takes up that margin.

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "hil_drivers/grand/wire/trajectory_sample.h"

namespace vbar::grand::bench {

/// Position and two derivatives, Earth-fixed frame.
struct MotionState {
  fsw::Vector3 position = fsw::Vector3::Zero();
  fsw::Vector3 velocity = fsw::Vector3::Zero();
  fsw::Vector3 acceleration = fsw::Vector3::Zero();
};

enum class Reception {
  kAccepted,    ///< will be used at its time, or where the computed motion ends
  kLate,        ///< behind the computed motion by more than join time less sample period: used from there on
  kDoubled,     ///< the same time as a sample received before: ignored
  kOutOfOrder,  ///< older than the sample in use: ignored
  kRejected,    ///< not finite, not between the ground and geostationary orbits, or too far in the future: ignored
};

struct MotionCounters {
  std::uint64_t samples = 0;  ///< number of samples received
  std::uint64_t late = 0, doubled = 0, out_of_order = 0, rejected = 0, snaps = 0;
  std::uint64_t missing = 0;  ///< between the samples received, by the shortest time from one to the next
  double lead_sum_s = 0.0;    ///< of the usable samples: own time minus time of arrival
  double lead_min_s = 0.0;
};

class VehicleMotion {
 public:
  static constexpr double kSnapDistance_m = 10.0;
  static constexpr fsw::Duration kMaxLead = fsw::duration_of_seconds(10);
  static constexpr fsw::Duration kRadiationLimit = fsw::duration_of_seconds(5);  ///< sample's age; then no RF

  explicit VehicleMotion(fsw::Duration join) : join_(join) {}

  /// Counts a sample and, unless it is ignored, uses it.
  Reception receive(const TrajectorySample& sample);

  /// Moves up to `time`, not before now(). A sample of exactly that time is used from the next call on, so that at() is
  /// the motion at the end of the interval.
  void advance(fsw::Duration time);

  [[nodiscard]] fsw::Duration now() const { return now_; }
  /// Returns false before the first sample: there is no motion.
  [[nodiscard]] bool is_defined() const { return current_.has_value(); }
  /// Time of the newest sample, used or not yet used.
  [[nodiscard]] fsw::Duration newest() const { return newest_; }
  /// Returns the time without a sample, at now().
  [[nodiscard]] fsw::Duration age() const;
  [[nodiscard]] bool is_deterministic() const { return computed().ns - newest_.ns <= join_.ns; }
  [[nodiscard]] bool is_radiated() const { return is_defined() && age() <= kRadiationLimit; }

  /// Returns the state on the present curve; times before or after now() extrapolate that curve. Requires is_defined().
  [[nodiscard]] MotionState at(fsw::Duration time) const;
  /// Returns position, derivatives and attitude on the present curve, as a sample.
  [[nodiscard]] TrajectorySample flown(fsw::Duration time) const;
  /// Returns the unit vector of the antenna's boresight, Earth-fixed frame: the attitude of the sample in use against
  /// north, east, down, rotated further by its angular rate and acceleration.
  [[nodiscard]] fsw::Vector3 boresight_ecef(fsw::Duration time) const;

  /// Returns true once after the motion jumped.
  [[nodiscard]] bool take_snap();
  [[nodiscard]] const MotionCounters& counters() const { return counters_; }
  void set_join(fsw::Duration join) { join_ = join; }
  /// Sets the time by which the motion is computed in advance of now().
  void set_advance(fsw::Duration advance) { advance_ = advance; }

 private:
  /// Quintic in the time since `begin`, zero from `end` on.
  struct Join {
    fsw::Duration begin, end;
    std::array<fsw::Vector3, 6> coefficients{};
  };

  /// Sample and the time from which it is used.
  struct Pending {
    TrajectorySample sample;
    fsw::Duration from;
  };

  void use(const TrajectorySample& sample);
  void count_arrival(fsw::Duration time);
  [[nodiscard]] fsw::Duration computed() const { return now_ + advance_; }
  [[nodiscard]] bool is_late(const TrajectorySample& sample) const;
  [[nodiscard]] static MotionState extrapolated(const TrajectorySample& sample, fsw::Duration time);
  [[nodiscard]] static Join join_of(const MotionState& difference, fsw::Duration begin, fsw::Duration length);

  fsw::Duration join_;
  fsw::Duration advance_;
  fsw::Duration now_;
  fsw::Duration newest_;
  std::optional<fsw::Duration> period_;  ///< shortest time from one sample to the next
  std::deque<fsw::Duration> arrived_;    ///< times of the last samples, which tell a double from a straggler
  std::optional<TrajectorySample> current_;
  Join joined_;
  std::vector<Pending> pending_;  ///< by the time from which it is used, rising; all after now_
  bool snapped_ = false;
  MotionCounters counters_;
};

}  // namespace vbar::grand::bench
