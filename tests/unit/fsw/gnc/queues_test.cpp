// Every queue filled to the brim: the newest is dropped, counted, and nothing that was there is overwritten.

#include "fsw/gnc/gnc.h"
#include "tests/unit/fsw/gnc/small_world.h"

namespace vbar::fsw::gnc::test {
namespace {

const Vector6 kStart = (Vector6() << 0, -100, 0, 3, 0, 3).finished();
const Vector6 kNear = (Vector6() << -0.5, -10, 0, 2, 0, 1).finished();
constexpr auto kFull = static_cast<vbar_status>(Status::kFull);

executed_maneuver tiny_maneuver(std::int32_t id) {
  executed_maneuver message{};
  message.maneuver_id = id;
  message.accepted = 1;
  message.dv_rtn[1] = 1e-3;
  return message;
}

// More measurements than fit: the first are kept, so the state is that of the last of these.
TEST(Queues, OfMeasurementsKeepWhatTheyHave) {
  Flight flight(kStart);
  const std::int64_t first = flight.now.ns - kNanosecondsPerSecond;
  const auto capacity = static_cast<std::int64_t>(Inbox::kCapacity<ideal_navigation>);
  for (std::int64_t k = 0; k < capacity; ++k) {
    EXPECT_EQ(flight.article.deliver({first + k}, flight.world.measurement()), 0);
  }
  SmallWorld elsewhere(kNear);
  for (std::int64_t k = 0; k < 7; ++k) {
    EXPECT_EQ(flight.article.deliver({first + capacity + k}, elsewhere.measurement()), kFull);
  }
  flight.measures = false;
  const Answer answer = flight.step();
  EXPECT_EQ(answer.health.inbox_dropped, 7);
  EXPECT_EQ(answer.health.faults, telemetry_health::kFaultInboxFull);
  EXPECT_EQ(answer.health.packets_accepted, Inbox::kCapacity<ideal_navigation> + 1);  // and the tick
  EXPECT_NEAR(answer.navigation.relative_position_rtn[1], -100.0, 10.0);  // not the -10 m of the dropped ones

  // The next step has all its room again.
  for (std::int64_t k = 0; k < capacity; ++k) {
    EXPECT_EQ(flight.article.deliver({first + 2 * kNanosecondsPerSecond + k}, flight.world.measurement()), 0);
  }
  EXPECT_EQ(flight.step().health.inbox_dropped, 7);
}

TEST(Queues, OfManeuversAndTelecommandsKeepWhatTheyHave) {
  Flight flight(kStart);
  flight.step();
  int dropped = 0;
  const auto fill = [&](std::size_t capacity, const auto& message) {
    for (std::uint16_t k = 0; k < capacity; ++k) EXPECT_EQ(flight.article.deliver(flight.now, message, k), 0);
    for (std::uint16_t k = 0; k < 3; ++k) {
      const auto sequence = static_cast<std::uint16_t>(capacity + k);
      EXPECT_EQ(flight.article.deliver(flight.now, message, sequence), kFull);
      ++dropped;
    }
  };
  fill(Inbox::kCapacity<executed_maneuver>, tiny_maneuver(99));
  fill(Inbox::kCapacity<gnc_configuration>, configuration());
  fill(Inbox::kCapacity<waypoint_table>, table_of({waypoint_at(8, 3 * 3600, 1, kNear)}));
  fill(Inbox::kCapacity<mode_command>, mode(1));
  const Answer answer = flight.step();
  EXPECT_EQ(answer.health.inbox_dropped, dropped);
  EXPECT_EQ(answer.control.mode, 1);
  EXPECT_EQ(answer.telemetry_count, 3);
}

// Reports of maneuvers nobody commanded, hundreds of them without a measurement: navigation has room for 64. Its anchor
// then moves past the oldest, so each still counts: 10 a minute of 1 mm/s along track for an hour are 0.6 m/s.
TEST(Queues, OfManeuversSinceTheLastMeasurementLoseNone) {
  Flight flight(kStart);
  gnc_configuration c = configuration();
  c.navigation_timeout_s = 7000.0;
  flight.send(c);
  flight.step();
  flight.measures = false;
  std::int32_t id = 1000;
  Answer answer;
  while (flight.now < at(3600)) {
    const GpsTime step_time = flight.now;
    for (int k = 0; k < 10; ++k) {
      const GpsTime time = step_time - duration_of_seconds(50 - 5 * k);
      EXPECT_EQ(flight.article.deliver(time, tiny_maneuver(id), static_cast<std::uint16_t>(id % 16384)), 0);
      ++id;
    }
    answer = flight.step();
  }
  EXPECT_EQ(answer.health.rejected_time, 0);
  ASSERT_EQ(answer.navigation.valid, 1);
  // The same maneuvers in the world, whose present is that of the next step: compared after a measurement-free step
  // there.
  SmallWorld world(kStart);
  for (GpsTime step_time = at(60); step_time < at(3600); step_time = step_time + kStep) {
    for (int k = 0; k < 10; ++k) {
      world.advance_to(step_time - duration_of_seconds(50 - 5 * k));
      world.apply({0.0, 1e-3, 0.0});
    }
  }
  world.advance_to(at(3540));
  const ideal_navigation expected = world.measurement();
  for (int k = 0; k < 3; ++k) {
    // Truncation of the coast's steps, which divide the time otherwise, is millimetres in an hour.
    EXPECT_NEAR(answer.navigation.servicer_position_eci[k], expected.servicer_position_eci[k], 0.02);
  }
}

// With the next step only after the waypoint, all burns of the leg are due at once; never more than the limit leave a
// step.
TEST(Queues, CommandsOfAStepAreBounded) {
  Flight flight(kStart);
  flight.send(table_of({waypoint_at(8, 3 * 3600, 1, kNear)}));
  flight.send(mode(1));
  EXPECT_EQ(flight.article.deliver(flight.now, flight.world.measurement()), 0);
  const Answer answer = flight.article.step(flight.now, duration_of_seconds(4 * 3600));
  EXPECT_EQ(answer.control.planned_burns, 0) << "all burns of the leg are due before the next step";
  EXPECT_GT(answer.commands.size(), 1U);
  EXPECT_LE(answer.commands.size(), Guidance::kMaxCommandsPerStep);
  EXPECT_EQ(answer.control.commanded_maneuvers, static_cast<std::int32_t>(answer.commands.size()));
}

}  // namespace
}  // namespace vbar::fsw::gnc::test
