// After the last waypoint: nothing while the ROE stay within the dead-band, a correction back into it when they leave.

#include "tests/support/figures.h"
#include "tests/unit/fsw/gnc/small_world.h"

namespace vbar::fsw::gnc::test {
namespace {

const Vector6 kStation = (Vector6() << 0, -100, 0, 3, 0, 3).finished();

/// Reached the station, `off` beside it.
Flight at_station(const Vector6& off, double deadband_m) {
  Flight flight(kStation + off);
  gnc_configuration c = configuration();
  c.station_keeping_deadband_m = deadband_m;
  c.station_keeping_horizon_s = 12000.0;  // two orbits
  flight.send(c);
  flight.send(table_of({waypoint_at(7, 0, 1, kStation)}));
  flight.send(mode(1));
  return flight;
}

TEST(StationKeeping, BeginsWhenTheLastWaypointIsReached) {
  Flight flight = at_station(Vector6::Zero(), 1.0);
  const Answer answer = flight.step();
  EXPECT_EQ(answer.control.mode, 2);
}

// da = 0.01 m drifts by 0.09 m an orbit; the dead-band is far.
TEST(StationKeeping, DoesNothingWithinTheDeadband) {
  Flight flight = at_station((Vector6() << 0.01, 0.3, 0.1, 0, 0.1, 0).finished(), 1.0);
  const Answer answer = flight.fly_until(at(2 * 6000));
  EXPECT_EQ(answer.control.active_solver, -1);
  EXPECT_EQ(answer.control.waypoint_index, -1);
  EXPECT_EQ(flight.executed + static_cast<int>(flight.to_execute.size()), 0);
}

TEST(StationKeeping, BringsBackWhatLeftTheDeadband) {
  for (const std::int8_t solver : {0, 1, 2}) {
    Flight flight(kStation + (Vector6() << 0.2, 4.0, 1.0, -1.0, 0.5, 0).finished());
    gnc_configuration c = configuration();
    c.station_keeping_horizon_s = 12000.0;
    flight.send(c);
    flight.send(table_of({waypoint_at(7, 0, solver, kStation)}));
    flight.send(mode(1));
    const Answer first = flight.step();
    EXPECT_EQ(first.control.mode, 2);
    EXPECT_GE(first.control.active_solver, 0);
    EXPECT_EQ(first.control.waypoint_index, 7);
    const Answer second = flight.step();
    EXPECT_EQ(second.control.waypoint_index, 7) << "a correction under way has a goal like any other";
    flight.arrive_at(at(12000));
    EXPECT_LT((flight.world.a_roe_m() - kStation).norm(), 1.0) << int{solver};  // the dead-band
    EXPECT_GT(flight.executed, 0);
    EXPECT_LT(flight.executed_dv, 0.02);  // n a |droe| of 1.5 m is 1.6 mm/s, dlambda over two orbits less

    const int executed = flight.executed;
    flight.fly_until(at(12000 + 3000));
    EXPECT_EQ(flight.executed, executed) << "back in the dead-band nothing more is done";
  }
}

// For a day: a drift that leaves the dead-band again and again never gets far.
TEST(StationKeeping, HoldsForADay) {
  Flight flight = at_station((Vector6() << 0.3, 0, 0, 0, 0, 0).finished(), 1.0);
  accuracy::Largest farthest;
  while (flight.now < at(86400)) {
    flight.step();
    farthest.add((flight.world.a_roe_m() - kStation).norm());
  }
  // The correction takes two orbits; 0.3 m of da drift 2.8 m in each at first, and burns on the way swing by as much.
  EXPECT_LT(farthest, 8.0);
  EXPECT_LT(flight.executed_dv, 0.01);
}

}  // namespace
}  // namespace vbar::fsw::gnc::test
