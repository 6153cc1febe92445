// Mode retreat in flight: from anywhere on the last legs the servicer keeps its distance, ends on a safe orbit, and
// resumes its approach.

#include "fsw/gnc/gnc.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/gnc/small_world.h"
#include "tests/unit/fsw/messaging/configurations.h"

namespace vbar::fsw::guidance {

using namespace gnc::test;
namespace {

constexpr std::int64_t kHour = 3600;
constexpr double kContact_m = 2.0;
constexpr std::int8_t kRetreat = mode_command::kModeRetreat;
const Vector6 kWaypoint7 = (Vector6() << 0, -100, 0, 3, 0, 3).finished();

/// The paper's last legs, from waypoint 7 on.
waypoint_table last_waypoints() {
  waypoint_table all = paper_waypoints();
  waypoint_table last{};
  last.reference_semi_major_axis_m = all.reference_semi_major_axis_m;
  for (int k = 8; k <= 10; ++k) {
    waypoint w = all.waypoints[k];
    w.gps_time_ns -= 36 * kHour * kNanosecondsPerSecond;
    w.keep_out_radius_m = 0.8;
    last.waypoints[last.count++] = w;
  }
  return last;
}

/// At waypoint 7, approaching.
Flight approach() {
  Flight flight(kWaypoint7);
  gnc_configuration c = configuration();
  c.navigation_timeout_s = 3000.0;
  flight.send(c);
  flight.send(gnc::test::safety());
  flight.send(last_waypoints());
  flight.send(mode(1));
  return flight;
}

/// Least distance of a flight for a day.
double min_distance(Flight& flight) {
  accuracy::Smallest least(flight.world.distance_m());
  const GpsTime until = flight.now + duration_of_seconds(24 * kHour);
  while (flight.now < until) {
    flight.step();
    least.add(flight.world.distance_m());
  }
  return least;
}

/// The same of a flight whose flight software does nothing any more.
double min_distance_of_drift(Flight& flight) {
  accuracy::Smallest least(flight.world.distance_m());
  for (int k = 0; k < 720; ++k) {
    flight.world.advance_to(flight.world.time() + duration_of_seconds(120));
    least.add(flight.world.distance_m());
  }
  return least;
}

/// A copy of a flight under way.
struct Saved {
  std::vector<std::byte> article;
  SmallWorld world;
  GpsTime now;
  std::deque<Command> to_execute;
};
void put(Flight& flight, const Saved& saved) {
  flight.article.restore(saved.article);
  flight.world = saved.world;
  flight.now = saved.now;
  flight.to_execute = saved.to_execute;
}

TEST(RetreatMode, TheNominalApproachNeedsNone) {
  Flight flight = approach();
  accuracy::Smallest least_by_retreat;
  while (flight.now < at(5 * kHour + 900)) {
    const Answer answer = flight.step();
    ASSERT_NE(answer.control.mode, kRetreat) << seconds(flight.now - kEpoch);
    EXPECT_EQ(answer.health.faults, 0);
    least_by_retreat.add(answer.safety.retreat_distance_m);
    EXPECT_LE(answer.safety.collision_probability, 1e-4);
  }
  EXPECT_GE(least_by_retreat, kContact_m);
  flight.arrive_at(flight.now);
  EXPECT_LT((flight.world.a_roe_m() - (Vector6() << 0, -8.5, 1, 0, 1, 0).finished()).norm(), 0.05);
}

// Every third minute of the three legs, 105 cases: nothing is burned for a while, then the retreat, and nothing is
// measured from the retreat on. The relative semi-major axis is then in error by 5 cm and the drag by 1e-9 m/s^2, of
// either sign.
TEST(RetreatMode, KeepsItsDistanceForADayFromEverywhere) {
  Flight nominal = approach();
  accuracy::Smallest least;
  accuracy::Largest largest_dv;
  int cases = 0;
  for (int minute = 0; minute < 315; ++minute) {
    nominal.step();
    if (minute % 3 != 0) continue;
    const Saved saved{nominal.article.save(), nominal.world, nominal.now, nominal.to_execute};
    for (const int wait_minutes : {0, 10, 35}) {
      for (const double sign : {-1.0, 0.0, 1.0}) {
        Flight flight(kWaypoint7);
        put(flight, saved);
        flight.send(mode(mode_command::kModeHold));
        flight.fly_until(flight.now + duration_of_seconds(60 * wait_minutes));
        flight.send(mode(kRetreat));
        const double before = flight.executed_dv;
        flight.step();
        EXPECT_TRUE(flight.to_execute.empty()) << "the burn is flown within the step";
        flight.world.add_a_da(0.05 * sign);
        flight.world.differential_drag = 1e-9 * sign;
        const double distance = min_distance_of_drift(flight);
        least.add(distance);
        largest_dv.add(flight.executed_dv - before);
        EXPECT_GE(distance, kContact_m) << "minute " << minute << ", after " << wait_minutes << ", sign " << sign;
        ++cases;
      }
    }
  }
  EXPECT_EQ(cases, 105 * 9);
  EXPECT_LT(largest_dv, 5e-3);
  RecordProperty("min_distance_m", std::to_string(least.value));
  RecordProperty("largest_dv_mps", std::to_string(largest_dv.value));
}

TEST(RetreatMode, EndsOnTheHoldOrbitAndTheApproachIsResumed) {
  Flight flight = approach();
  flight.fly_until(at(4 * kHour + 300));
  flight.send(mode(kRetreat));
  Answer answer = flight.step();
  EXPECT_EQ(answer.control.mode, kRetreat);
  EXPECT_NE(answer.health.faults & telemetry_health::kFaultRetreat, 0);
  EXPECT_EQ(answer.safety.phase, telemetry_safety::kPhaseRecede);
  accuracy::Smallest least(flight.world.distance_m());
  while (flight.now < at(20 * kHour)) {
    answer = flight.step();
    least.add(flight.world.distance_m());
  }
  EXPECT_GE(least, kContact_m);
  EXPECT_EQ(answer.safety.phase, telemetry_safety::kPhaseKeep);
  const Vector6 error = flight.world.a_roe_m() - (Vector6() << 0, -200, 0, 6, 0, 6).finished();
  EXPECT_LT(error.norm(), 2.0);

  waypoint_table table = table_of({waypoint_at(8, 26 * kHour, 1, (Vector6() << -0.5, -10, 0, 2, 0, 1).finished())});
  table.waypoints[0].keep_out_radius_m = 0.8;
  flight.send(table);
  flight.send(mode(1));
  answer = flight.step();
  EXPECT_EQ(answer.control.mode, mode_command::kModeApproach);
  EXPECT_EQ(answer.safety.phase, telemetry_safety::kPhaseNone);
  flight.arrive_at(at(26 * kHour));
  EXPECT_LT((flight.world.a_roe_m() - (Vector6() << -0.5, -10, 0, 2, 0, 1).finished()).norm(), 0.05);
}

// An impulse that nobody commanded, as of a thruster that sticks for ten seconds at 1 mm/s^2.
TEST(RetreatMode, AnUncommandedBurnStartsIt) {
  Flight flight = approach();
  flight.fly_until(at(4 * kHour));
  const Vector3 dv_rtn(0.0, 6e-3, 8e-3);
  flight.world.apply(dv_rtn);
  executed_maneuver report{};
  report.maneuver_id = 4000;
  report.accepted = 1;
  for (int k = 0; k < 3; ++k) report.dv_rtn[k] = dv_rtn(k);
  flight.send(report);
  const Answer answer = flight.step();
  EXPECT_EQ(answer.control.mode, kRetreat);
  ASSERT_EQ(answer.commands.size(), 1U);
  EXPECT_EQ(answer.commands[0].message.waypoint_index, -1);
  EXPECT_GE(min_distance(flight), kContact_m);
}

TEST(RetreatMode, WithoutASafetyConfigurationItIsAHold) {
  Flight flight(kWaypoint7);
  flight.send(configuration());
  flight.send(last_waypoints());
  flight.send(mode(kRetreat));
  EXPECT_EQ(flight.step().control.mode, mode_command::kModeHold);
}

// A valve that stays shut: after the second burn none is commanded any more.
TEST(RetreatMode, AThrusterThatFailsIsNotReliedUpon) {
  Flight flight = approach();
  flight.fly_until(at(1800));
  flight.thrust = 0.0;
  Answer answer;
  const int before = flight.executed;
  while (flight.now < at(5 * kHour) && (answer.health.faults & telemetry_health::kFaultThruster) == 0)
    answer = flight.step();
  EXPECT_NE(answer.health.faults & telemetry_health::kFaultThruster, 0);
  EXPECT_NE(answer.health.faults & telemetry_health::kFaultBurnMissed, 0);
  EXPECT_LE(flight.executed - before, 3) << "a third was commanded before the second was reported";
  while (flight.now < at(5 * kHour)) EXPECT_TRUE(flight.step().commands.empty());
}

// Every burn is 10 % short: the third one and all later ones are commanded larger.
TEST(RetreatMode, ShortBurnsAreCompensated) {
  Flight nominal = approach();
  Flight flight = approach();
  flight.thrust = 0.9;
  const GpsTime arrival = at(3 * kHour);
  nominal.arrive_at(arrival);
  const Answer answer = flight.arrive_at(arrival);
  EXPECT_NEAR(answer.safety.burn_scale, 0.9, 0.01);
  EXPECT_NE(answer.health.faults & telemetry_health::kFaultBurnSize, 0);
  const Vector6 waypoint = (Vector6() << -0.5, -10, 0, 2, 0, 1).finished();
  EXPECT_LT((flight.world.a_roe_m() - waypoint).norm(), 0.05);
  EXPECT_NEAR(flight.executed_dv, nominal.executed_dv, 0.1 * nominal.executed_dv);
}

}  // namespace
}  // namespace vbar::fsw::guidance
