// Telecommands in, modes and waypoints out; nonsense changes nothing and is counted.

#include "fsw/guidance/management.h"

#include <limits>

#include <gtest/gtest.h>

#include "fsw/gnc/telecommand_checks.h"
#include "fsw/guidance/lit_windows.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/sun.h"
#include "tests/unit/fsw/messaging/configurations.h"
#include "tests/unit/fsw/orbit/mission.h"

namespace vbar::fsw::guidance {

namespace {

using gnc::test::kServicer;
using gnc::test::packet_of;

waypoint_table table_of_three() {
  waypoint_table table{};
  table.count = 3;
  table.reference_semi_major_axis_m = 7.0e6;
  for (int k = 0; k < 3; ++k) {
    table.waypoints[k].index = k;
    table.waypoints[k].gps_time_ns = 100 * (k + 1);
    table.waypoints[k].a_roe_m[1] = -7000.0 * (k + 1);
  }
  return table;
}

mode_command approach() {
  mode_command command{};
  command.mode = 1;
  return command;
}

class ManagementTest : public ::testing::Test {
 protected:
  template <class Message>
  void send(const Message& message, std::int64_t ns = 0) {
    ASSERT_EQ(inbox_.receive(packet_of({ns}, message)), Status::kOk);
  }
  void step(std::int64_t ns) {
    telecommands_.update({ns}, inbox_, gnc::telecommand_rules());
    management_.update({ns}, telecommands_);
    inbox_.clear(GpsTime{});
  }

  messaging::Inbox inbox_{kServicer};
  messaging::Telecommands telecommands_;
  Management management_;
};

TEST_F(ManagementTest, FliesTheTableThenKeepsStation) {
  EXPECT_EQ(management_.mode(), Mode::kIdle);
  send(table_of_three());
  send(approach());
  step(50);
  EXPECT_EQ(management_.mode(), Mode::kApproach);
  ASSERT_NE(management_.next_waypoint(), nullptr);
  EXPECT_EQ(management_.next_waypoint()->index, 0);
  EXPECT_EQ(management_.last_waypoint(), nullptr);
  EXPECT_DOUBLE_EQ(management_.next_waypoint()->roe(1), -1e-3);  // -7000 m over 7000 km

  step(100);  // the waypoint's own time: it is reached, what comes now is for the next one
  EXPECT_EQ(management_.next_waypoint()->index, 1);
  EXPECT_EQ(management_.last_waypoint()->index, 0);

  step(300);
  EXPECT_EQ(management_.next_waypoint(), nullptr);
  EXPECT_EQ(management_.mode(), Mode::kStationKeeping);
  EXPECT_EQ(management_.last_waypoint()->index, 2);
}

TEST_F(ManagementTest, StationKeepingWithoutAWaypointReachedIsIdle) {
  mode_command keep{};
  keep.mode = 2;
  send(table_of_three());
  send(keep);
  step(10);
  EXPECT_EQ(management_.mode(), Mode::kIdle);
}

TEST_F(ManagementTest, ANewTableReplacesTheOld) {
  send(table_of_three());
  step(150);
  waypoint_table other = table_of_three();
  other.count = 1;
  other.waypoints[0].index = 9;
  other.waypoints[0].gps_time_ns = 900;
  send(other);
  step(160);
  EXPECT_EQ(management_.next_waypoint()->index, 9);
}

TEST_F(ManagementTest, RefusesTablesThatCannotBeFlown) {
  const auto refused = [this](const waypoint_table& table) {
    const std::int32_t before = inbox_.counters().rejected_content;
    send(table);
    step(1);
    return inbox_.counters().rejected_content == before + 1 && management_.next_waypoint() == nullptr;
  };
  waypoint_table table = table_of_three();
  table.count = 17;
  EXPECT_TRUE(refused(table));
  table = table_of_three();
  table.count = 0;
  EXPECT_TRUE(refused(table));
  table = table_of_three();
  table.waypoints[2].gps_time_ns = table.waypoints[1].gps_time_ns;
  EXPECT_TRUE(refused(table));
  table = table_of_three();
  table.waypoints[1].control_mode = 3;
  EXPECT_TRUE(refused(table));
  table = table_of_three();
  table.reference_semi_major_axis_m = 0.0;
  EXPECT_TRUE(refused(table));
  table = table_of_three();
  table.waypoints[0].a_roe_m[3] = 2e6;
  EXPECT_TRUE(refused(table));
}

TEST_F(ManagementTest, RefusesAConfigurationWithAnImpossibleFieldAndKeepsTheOld) {
  gnc_configuration configuration = management_.configuration();
  const double before = configuration.maximum_dv;
  configuration.maximum_dv = 123.0;
  configuration.koenig_damico_grid_ns = 0;
  send(configuration);
  step(1);
  EXPECT_EQ(management_.configuration().maximum_dv, before);
  EXPECT_EQ(inbox_.counters().rejected_content, 1);
}

// Spans that, added to a time, could leave the clock's range, and waypoints outside it.
TEST_F(ManagementTest, RefusesSpansAndTimesThatOverflow) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  std::int32_t refusals = 0;
  const auto refused = [&](const auto& message) {
    send(message);
    step(1);
    return inbox_.counters().rejected_content == ++refusals;
  };
  const auto with = [this](std::int64_t gnc_configuration::*span) {
    gnc_configuration c = management_.configuration();
    c.*span = kMax;
    return c;
  };
  EXPECT_TRUE(refused(with(&gnc_configuration::compute_latency_ns)));
  EXPECT_TRUE(refused(with(&gnc_configuration::closed_form_period_ns)));
  EXPECT_TRUE(refused(with(&gnc_configuration::koenig_damico_period_ns)));
  EXPECT_TRUE(refused(with(&gnc_configuration::koenig_damico_grid_ns)));
  gnc_configuration c = management_.configuration();
  c.station_keeping_horizon_s = 1e300;
  EXPECT_TRUE(refused(c));
  c.station_keeping_horizon_s = 0.0;
  EXPECT_TRUE(refused(c));
  waypoint_table table = table_of_three();
  table.waypoints[2].gps_time_ns = kMax;
  EXPECT_TRUE(refused(table));
  table = table_of_three();
  table.waypoints[0].gps_time_ns = -kMax;
  EXPECT_TRUE(refused(table));
}

TEST_F(ManagementTest, ATelecommandOfTheFutureIsNotTaken) {
  send(approach(), 500);
  step(100);
  EXPECT_EQ(management_.mode(), Mode::kIdle);
  EXPECT_EQ(inbox_.counters().rejected_time, 1);
}

// Two mode commands in one step: the later time tag has the last word, in whatever order they came.
TEST_F(ManagementTest, TelecommandsApplyInOrderOfTheirTimeTags) {
  send(table_of_three());
  mode_command hold{};
  hold.mode = 3;
  send(hold, 20);
  send(approach(), 10);
  step(50);
  EXPECT_EQ(management_.mode(), Mode::kHold);
}

}  // namespace

// Burns in sunlight: against the shadow of a cylinder on the same orbit, minute by minute.

namespace {

constexpr GpsTime kEpoch{994'986'015LL * kNanosecondsPerSecond};  // 2011-07-18 01:00 UTC
constexpr double kEarthRadius_m = 6.378e6;

bool is_lit(const orbit::QnsElements& mean, double s) {
  const Vector3 sun = orbit::sun_position_gcrf(kEpoch).normalized();
  const Vector3 r = orbit::cartesian_from_qns(orbit::propagate_secular(mean, s)).value().position_eci;
  const double along = r.dot(sun);
  return along > 0.0 || (r - along * sun).norm() > kEarthRadius_m;
}

TEST(LitWindows, AreTheLitPartOfTheOrbitLessItsEdges) {
  const orbit::QnsElements mean = orbit::mission::kServicerMean;  // the printed node: a third of the orbit is dark
  const LitWindows windows(kEpoch, mean);
  int allowed = 0;
  int dark = 0;
  for (int s = 0; s < 6000; s += 10) {
    const bool is_allowed = windows.allows(kEpoch + duration_of_seconds(s));
    // The limb of the on-board shadow differs from this one by the oblateness: some seconds.
    if (!is_lit(mean, s - 30.0) || !is_lit(mean, s) || !is_lit(mean, s + 30.0)) {
      EXPECT_FALSE(is_allowed) << s;
      ++dark;
    }
    bool is_surely_lit = true;
    for (double offset = -150.0; offset <= 90.0; offset += 10.0)
      is_surely_lit = is_surely_lit && is_lit(mean, s + offset);
    if (is_surely_lit) {
      EXPECT_TRUE(is_allowed) << s;
      ++allowed;
    }
  }
  EXPECT_GT(allowed, 200);
  EXPECT_GT(dark, 100);
}

TEST(LitWindows, TheSolverAsksTheSame) {
  const LitWindows windows(kEpoch, orbit::mission::kServicerMean);
  const control::ThrustWindows thrust = windows.thrust_windows();
  for (int s = 0; s < 6000; s += 100) {
    const GpsTime time = kEpoch + duration_of_seconds(s);
    EXPECT_EQ(thrust.allowed(thrust.context, time), windows.allows(time));
  }
}

}  // namespace

}  // namespace vbar::fsw::guidance
