// What the flight software promises whoever holds it through the C interface: outputs that depend on the packets of a
// step, not on their order; a state that is its bytes; telemetry in every mode; a clock that only goes forward.

#include <algorithm>
#include <limits>
#include <random>

#include "fsw/gnc/gnc.h"
#include "tests/unit/fsw/gnc/small_world.h"

namespace vbar::fsw::gnc::test {

namespace {

executed_maneuver unheard_of_maneuver(std::int32_t id, double dv_t) {
  executed_maneuver message{};
  message.maneuver_id = id;
  message.accepted = 1;
  message.dv_rtn[1] = dv_t;
  return message;
}

/// Packets that all matter: measurements at three times, two maneuvers between them, telecommands of all kinds.
std::vector<Bytes> rich_step(const Flight& flight) {
  std::vector<Bytes> packets;
  for (int k = 3; k-- > 0;) {
    packets.push_back(packet_of(flight.now - duration_of_seconds(15 * k), flight.world.measurement(), 0));
  }
  const GpsTime just_now = flight.now - duration_of_seconds(1);
  packets.push_back(packet_of(just_now, unheard_of_maneuver(1001, 0.01), 1));
  packets.push_back(packet_of(just_now, unheard_of_maneuver(1002, -0.03), 2));
  gnc_configuration changed = configuration();
  changed.maximum_dv = 5.0;
  packets.push_back(packet_of(flight.now, changed));
  packets.push_back(packet_of(flight.now, paper_waypoints()));
  packets.push_back(packet_of(just_now, mode(3)));
  packets.push_back(packet_of(flight.now, mode(1)));
  tick message{};
  message.period_ns = kStep.ns;
  packets.push_back(packet_of(flight.now, message));
  return packets;
}

TEST(Contract, TheOrderOfPacketsInAStepDoesNotMatter) {
  const Flight flight = under_way();
  const std::vector<std::byte> before = flight.article.save();
  std::vector<Bytes> packets = rich_step(flight);
  std::mt19937_64 random(7);
  std::vector<Bytes> expected;
  for (int trial = 0; trial < 40; ++trial) {
    Article article;
    article.restore(before);
    for (const Bytes& packet : packets) EXPECT_EQ(article.deliver(packet), 0);
    const Answer answer = article.step_without_tick(flight.now);
    const Answer next = article.step(flight.now + kStep, kStep);  // nothing of the order may linger either
    std::vector<Bytes> said = answer.packets;
    said.insert(said.end(), next.packets.begin(), next.packets.end());
    if (trial == 0) expected = said;
    EXPECT_EQ(said, expected) << "trial " << trial;
    std::shuffle(packets.begin(), packets.end(), random);
  }
  EXPECT_GE(expected.size(), 6U);
}

TEST(Contract, TheStateIsItsBytes) {
  Flight flight = under_way();
  const std::vector<std::byte> saved = flight.article.save();
  Article other;
  other.restore(saved);
  int commands = 0;
  for (int k = 0; k < 120; ++k) {
    EXPECT_EQ(other.deliver(flight.now, flight.world.measurement()), 0);
    const Answer resumed = other.step(flight.now, kStep);
    flight.reports_maneuvers = false;  // the other one gets no reports, so this one must not
    flight.measures = false;
    EXPECT_EQ(flight.article.deliver(flight.now, flight.world.measurement()), 0);
    const Answer continued = flight.step();
    ASSERT_EQ(resumed.packets, continued.packets) << "step " << k;
    commands += static_cast<int>(continued.commands.size());
  }
  EXPECT_GT(commands, 0) << "two hours without a burn: this compares little";
}

TEST(Contract, APacketDeliveredBetweenStepsIsPartOfTheSavedState) {
  Flight flight = under_way();
  Article a, b;
  a.restore(flight.article.save());
  EXPECT_EQ(a.deliver(flight.now, flight.world.measurement()), 0);
  b.restore(a.save());
  EXPECT_EQ(a.step(flight.now, kStep).packets, b.step(flight.now, kStep).packets);
}

TEST(Contract, TheClockGoesForwardOnly) {
  Flight flight = under_way();
  const std::vector<std::byte> before = flight.article.save();
  Article article;
  article.restore(before);
  for (const GpsTime wrong : {flight.now - kStep, flight.now - kStep - kStep, kEpoch}) {
    EXPECT_EQ(article.deliver(wrong, flight.world.measurement()), 0);
    const Answer answer = article.step(wrong, kStep);
    EXPECT_EQ(answer.status, static_cast<vbar_status>(Status::kBadSequence));
    EXPECT_EQ(answer.telemetry_count, 1);
    EXPECT_EQ(answer.health.faults_present, telemetry_health::kFaultClock);
    EXPECT_TRUE(without_health(answer.packets).empty());
  }
  // Steps that were refused have left nothing behind but the fault and the count of packets.
  Article undisturbed;
  undisturbed.restore(before);
  EXPECT_EQ(article.deliver(flight.now, flight.world.measurement()), 0);
  EXPECT_EQ(undisturbed.deliver(flight.now, flight.world.measurement()), 0);
  const Answer answer = article.step(flight.now, kStep);
  const Answer reference = undisturbed.step(flight.now, kStep);
  EXPECT_EQ(answer.health.faults & telemetry_health::kFaultClock, telemetry_health::kFaultClock);
  EXPECT_EQ(reference.health.faults & telemetry_health::kFaultClock, 0);
  EXPECT_EQ(without_health(answer.packets), without_health(reference.packets));
}

TEST(Contract, AStepOutsideTheClocksRangeIsRefused) {
  Article article;
  for (const std::int64_t ns :
       {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}, std::numeric_limits<std::int64_t>::max()}) {
    EXPECT_EQ(article.step_without_tick({ns}).status, static_cast<vbar_status>(Status::kOutOfRange));
  }
  EXPECT_EQ(article.step(kEpoch, kStep).status, 0);
}

// Without a tick the next step's time is not known; the promise of the last one holds on.
TEST(Contract, AStepWithoutATickStillSteps) {
  Flight flight = under_way();
  EXPECT_EQ(flight.article.deliver(flight.now, flight.world.measurement()), 0);
  Article ticked;
  ticked.restore(flight.article.save());
  const Answer without = flight.article.step_without_tick(flight.now);
  EXPECT_EQ(without.status, 0);
  EXPECT_EQ(without.telemetry_count, 3);
  const Answer with = ticked.step(flight.now, kStep);
  EXPECT_EQ(without.navigation.step, with.navigation.step);
  EXPECT_EQ(without.control.planned_dv, with.control.planned_dv);
}

// Telemetry cannot carry a NaN (encoding refuses it, and the outbox counts): three packets a step and none dropped is
// the proof.
void expect_whole_telemetry(const Answer& answer, const char* when) {
  EXPECT_EQ(answer.status, 0) << when;
  EXPECT_EQ(answer.telemetry_count, 3) << when;
  EXPECT_EQ(answer.health.outbox_dropped, 0) << when;
}

TEST(Contract, TelemetryIsWholeBeforeAnythingIsKnown) {
  Flight flight(kWaypoint0);
  flight.measures = false;
  expect_whole_telemetry(flight.step(), "first step, no packet at all");
  flight.send(paper_waypoints());
  flight.send(mode(1));
  const Answer answer = flight.step();
  expect_whole_telemetry(answer, "a mission, no measurement");
  EXPECT_EQ(answer.navigation.valid, 0);
  EXPECT_EQ(answer.control.planned_burns, 0);
  EXPECT_TRUE(answer.commands.empty());
}

TEST(Contract, TelemetryIsWholeInEveryMode) {
  for (const std::int8_t number : {0, 1, 2, 3}) {
    Flight flight(kWaypoint0);
    flight.send(paper_waypoints());
    flight.send(mode(number));
    for (int k = 0; k < 60; ++k) {
      const Answer answer = flight.step();
      expect_whole_telemetry(answer, "every mode");
      EXPECT_EQ(answer.control.mode, number);
      EXPECT_EQ(answer.navigation.valid, 1);
      if (number == 0 || number == 3) {
        EXPECT_EQ(answer.control.active_solver, -1);
        EXPECT_EQ(answer.control.waypoint_index, -1);
      }
    }
    EXPECT_EQ(flight.executed > 0, number == 1 || number == 2) << int{number};  // it drifts at 3 m/s
  }
}

TEST(Contract, HoldStopsWhatWasPlannedAndApproachGoesOn) {
  Flight flight = under_way();
  flight.send(mode(3));
  flight.step();
  const int executed = flight.executed + static_cast<int>(flight.to_execute.size());
  flight.fly_until(flight.now + duration_of_seconds(6000));  // an orbit, in which the leg had burns to come
  EXPECT_EQ(flight.executed, executed);
  flight.send(mode(1));
  flight.fly_until(flight.now + duration_of_seconds(6000));
  EXPECT_GT(flight.executed, executed);
}

}  // namespace

// Every queue filled to the brim: the newest is dropped, counted, and nothing that was there is overwritten.

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
  const auto capacity = static_cast<std::int64_t>(messaging::Inbox::kCapacity<ideal_navigation>);
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
  EXPECT_EQ(answer.health.packets_accepted, messaging::Inbox::kCapacity<ideal_navigation> + 1);  // and the tick
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
  fill(messaging::Inbox::kCapacity<executed_maneuver>, tiny_maneuver(99));
  fill(messaging::Inbox::kCapacity<gnc_configuration>, configuration());
  fill(messaging::Inbox::kCapacity<waypoint_table>, table_of({waypoint_at(8, 3 * 3600, 1, kNear)}));
  fill(messaging::Inbox::kCapacity<mode_command>, mode(1));
  const Answer answer = flight.step();
  EXPECT_EQ(answer.health.inbox_dropped, dropped);
  EXPECT_EQ(answer.control.mode, 1);
  EXPECT_EQ(answer.telemetry_count, 3);
}

// Reports of maneuvers without a command, hundreds of them without a measurement: navigation has room for 64. Its
// anchor then moves past the oldest, so each still counts: 10 a minute of 1 mm/s along track for an hour are 0.6 m/s.
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
  EXPECT_LE(answer.commands.size(), guidance::Guidance::kMaxCommandsPerStep);
  EXPECT_EQ(answer.control.commanded_maneuvers, static_cast<std::int32_t>(answer.commands.size()));
}

}  // namespace

}  // namespace vbar::fsw::gnc::test
