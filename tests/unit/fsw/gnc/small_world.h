#pragma once
// A small world to fly in: two spacecraft under point mass and J2, true states as measurements, burns executed as
// commanded. The flight software's own coast is the same model, so what a test sees is guidance, not the weather.

#include <cstdint>
#include <deque>

#include "fsw/orbit/elements.h"
#include "tests/unit/fsw/gnc/article.h"

namespace vbar::fsw::gnc::test {

inline constexpr GpsTime kEpoch{994'986'015LL * kNanosecondsPerSecond};  ///< 2011-07-18 01:00:00 UTC
inline constexpr Duration kStep = duration_of_seconds(60);
inline constexpr double kReferenceA = 7078138.944;  ///< m, the mission's

constexpr GpsTime at(std::int64_t s) {
  return kEpoch + duration_of_seconds(s);
}

/// A waypoint `s` seconds after the epoch; control_mode as in vbar.lcm.
waypoint waypoint_at(std::int32_t index, std::int64_t s, std::int8_t control_mode, const Vector6& a_roe_m);

waypoint_table table_of(std::initializer_list<waypoint> waypoints);

/// The paper's waypoints 0 to 10: closed form to 7, Koenig-D'Amico from there.
waypoint_table paper_waypoints();

/// What the flight software starts with; a test changes what it is about.
gnc_configuration configuration();

mode_command mode(std::int8_t number);

class SmallWorld {
 public:
  /// At the epoch: the mission's servicer, the target about it by mean ROE (m).
  explicit SmallWorld(const Vector6& a_roe_m);

  /// Moves both to `time`.
  void advance_to(GpsTime time);
  void apply(const Vector3& dv_rtn);

  [[nodiscard]] GpsTime time() const { return time_; }
  [[nodiscard]] ideal_navigation measurement() const;
  /// True mean ROE of the target, m.
  [[nodiscard]] Vector6 a_roe_m() const;
  /// Between the centres of mass, m.
  [[nodiscard]] double distance_m() const { return (target_.position_eci - servicer_.position_eci).norm(); }
  /// Changes the relative semi-major axis by an impulse of the target along its flight.
  void add_a_da(double metres);

  double differential_drag = 0.0;  ///< m/s^2, acceleration of the target along its flight

 private:
  GpsTime time_ = kEpoch;
  orbit::CartesianState servicer_;
  orbit::CartesianState target_;
};

/// The loop: measure, tick, step, execute, report. A step of flight is one call.
class Flight {
 public:
  explicit Flight(const Vector6& a_roe_m) : world(a_roe_m) {}

  template <class Message>
  void send(const Message& message) {
    EXPECT_EQ(article.deliver(now, message, sequence_++), 0);
  }

  /// Runs the step at `now` and flies to the next one.
  Answer step();
  /// Steps until `until`; the last answer.
  Answer fly_until(GpsTime until);
  /// As fly_until, and what was commanded for that very instant is flown too: the ROE feel a burn at once.
  Answer arrive_at(GpsTime time);

  SmallWorld world;
  Article article;
  GpsTime now = kEpoch;
  bool measures = true;           ///< a measurement before each step
  double thrust = 1.0;            ///< executed share of a commanded burn
  bool reports_maneuvers = true;  ///< what was executed is reported before the next step
  std::deque<Command> to_execute;
  double executed_dv = 0.0;  ///< m/s
  int executed = 0;

 private:
  void execute_until(GpsTime until);
  void execute(const Command& command);

  std::deque<Bytes> reports_;
  std::uint16_t sequence_ = 0;
};

/// The paper's first waypoint, a * ROE, m.
inline const Vector6 kWaypoint0 = (Vector6() << -2000, -75000, 0, 0, 0, 0).finished();

/// A flight that has had burns, half an orbit into the paper's first leg.
Flight under_way();

/// Without the packets that report faults: health and events.
std::vector<Bytes> without_health(std::vector<Bytes> packets);

}  // namespace vbar::fsw::gnc::test
