// A computer restarts, or its clock jumps: what the flight software continues from, what it discards, what it reports.

#include <algorithm>
#include <limits>
#include <string>

#include "tests/unit/fsw/gnc/small_world.h"

namespace vbar::fsw::gnc::test {
namespace {

using Snapshot = std::vector<std::uint8_t>;

/// The first step at `now` of a flight software restored from `snapshot`, with a measurement.
Answer first_step(Article& article, Flight& flight, GpsTime now) {
  flight.world.advance_to(now);
  EXPECT_EQ(article.deliver(now, flight.world.measurement()), 0);
  return article.step(now, kStep);
}

Answer health_of_restart(Flight& flight, const Snapshot& snapshot, GpsTime now) {
  Article article;
  EXPECT_EQ(article.restore_snapshot(snapshot), 0);
  return first_step(article, flight, now);
}

TEST(Restart, AWarmStateContinuesAsIfThereHadBeenNoRestart) {
  Flight flight = under_way();
  Article restored;
  ASSERT_EQ(restored.restore_snapshot(flight.article.snapshot()), 0);
  std::size_t commands = 0;
  GpsTime now = flight.now + duration_of_seconds(540);  // the age of the state is 600 s: both were without packets
  for (int k = 0; k < 120; ++k, now = now + kStep) {
    flight.world.advance_to(now);
    const Bytes measurement = packet_of(now, flight.world.measurement());
    EXPECT_EQ(flight.article.deliver(measurement), 0);
    EXPECT_EQ(restored.deliver(measurement), 0);
    const Answer uninterrupted = flight.article.step(now, kStep);
    const Answer resumed = restored.step(now, kStep);
    ASSERT_EQ(without_health(resumed.packets), without_health(uninterrupted.packets)) << "step " << k;
    EXPECT_EQ(resumed.health.faults, uninterrupted.health.faults | telemetry_health::kFaultRestart);
    commands += resumed.commands.size();
  }
  EXPECT_GT(commands, 0U) << "two hours without a burn: this compares little";
}

/// Where two snapshots of one size differ, apart from the checksum in their header: the places of the first few bytes.
std::string differing_bytes(const Snapshot& a, const Snapshot& b) {
  constexpr std::size_t kHeader = 40;
  std::string places;
  for (std::size_t k = kHeader; k < a.size() && places.size() < 200; ++k) {
    if (a[k] != b[k]) places += std::to_string(k) + ' ';
  }
  return places.empty() && a != b ? "header" : places;
}

TEST(Restart, TheSnapshotIsTheSameAtAnyAddressAndInAnyMemory) {
  const Flight first = under_way();
  Article::fill = 0xA5;
  const std::vector<std::byte> displacement(12345);
  const Flight second = under_way();
  Article::fill = 0;
  const Snapshot a = first.article.snapshot();
  const Snapshot b = second.article.snapshot();
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(differing_bytes(a, b), "");
  // Restored and saved again, also in other memory, it is the same.
  Article restored;
  ASSERT_EQ(restored.restore_snapshot(a), 0);
  EXPECT_TRUE(restored.snapshot() == a);
}

TEST(Restart, AnOldStateIsDiscardedButForTheTelecommands) {
  Flight flight = under_way();
  const Snapshot snapshot = flight.article.snapshot();
  const GpsTime last = flight.now - kStep;
  const Answer warm = health_of_restart(flight, snapshot, last + duration_of_seconds(600));
  EXPECT_EQ(warm.health.faults, +telemetry_health::kFaultRestart + +telemetry_health::kFaultStepLate);

  Article article;
  ASSERT_EQ(article.restore_snapshot(snapshot), 0);
  const GpsTime later = last + duration_of_seconds(601);
  const Answer blind = article.step(later, kStep);  // no measurement: what was known is too old
  EXPECT_EQ(blind.health.faults, telemetry_health::kFaultColdStart);
  EXPECT_EQ(blind.navigation.valid, 0);
  EXPECT_TRUE(blind.commands.empty());
  EXPECT_EQ(blind.control.mode, 1);
  const Answer seeing = first_step(article, flight, later + kStep);
  EXPECT_EQ(seeing.navigation.valid, 1);
  EXPECT_EQ(seeing.control.waypoint_index, 1);  // that of the table which is still in force
}

TEST(Restart, ADamagedSnapshotIsRefusedAndTheStartIsCold) {
  Flight flight = under_way();
  const Snapshot good = flight.article.snapshot();
  const auto expect_refused = [&](const Snapshot& snapshot, Status reason) {
    Article article;
    EXPECT_EQ(article.restore_snapshot(snapshot), static_cast<vbar_status>(reason));
    const Answer answer = article.step(flight.now, kStep);
    EXPECT_EQ(answer.status, 0);
    EXPECT_EQ(answer.health.faults, telemetry_health::kFaultColdStart);
    ASSERT_EQ(answer.events.size(), 1U);
    EXPECT_EQ(answer.events[0].argument, static_cast<double>(reason));
    EXPECT_EQ(answer.control.mode, 0);
    EXPECT_EQ(answer.navigation.valid, 0);
  };
  for (const std::size_t place :
       {std::size_t{16}, std::size_t{24}, std::size_t{36}, good.size() / 2, good.size() - 1}) {
    Snapshot damaged = good;
    damaged[place] ^= 0x10U;
    expect_refused(damaged, Status::kBadChecksum);
  }
  Snapshot other = good;
  other[4] ^= 0x01U;  // version
  expect_refused(other, Status::kWrongType);
  expect_refused(Snapshot(good.begin(), good.end() - 1), Status::kTooShort);
  expect_refused({}, Status::kTooShort);
}

TEST(Restart, TheFirstStartOfAMissionIsNoFault) {
  Article article;
  EXPECT_EQ(article.step(kEpoch, kStep).health.faults, 0);
}

TEST(Clock, OneTickAnHourAheadIsRefusedWithItsHealthAndNothingIsLost) {
  Flight flight = under_way();
  Article undisturbed;
  undisturbed.restore(flight.article.save());
  const Answer refused = flight.article.step(flight.now + duration_of_seconds(3600), kStep);
  EXPECT_EQ(refused.status, static_cast<vbar_status>(Status::kOutOfRange));
  EXPECT_EQ(refused.telemetry_count, 1);
  EXPECT_EQ(refused.health.faults_present, telemetry_health::kFaultClock);
  ASSERT_EQ(refused.events.size(), 1U);
  EXPECT_EQ(refused.events[0].argument, 3660.0);  // one period after the last step, and an hour
  const Answer next = first_step(flight.article, flight, flight.now);
  const Answer reference = first_step(undisturbed, flight, flight.now);
  EXPECT_EQ(next.status, 0);
  EXPECT_EQ(without_health(next.packets), without_health(reference.packets));
}

TEST(Clock, ThreeRefusedTicksThatAgreeAreFollowedByAStep) {
  for (const std::int64_t jump_s : {3600, -3600}) {
    Flight flight = under_way();
    GpsTime now = flight.now + duration_of_seconds(jump_s);
    for (int k = 0; k < 3; ++k, now = now + kStep) {
      EXPECT_NE(flight.article.step(now, kStep).status, 0);
    }
    const Answer accepted = flight.article.step(now, kStep);
    EXPECT_EQ(accepted.status, 0);
    EXPECT_EQ(accepted.navigation.valid, 0) << "what was known belongs to the other time";
    EXPECT_EQ(accepted.health.faults, telemetry_health::kFaultClock);
    EXPECT_EQ(accepted.health.faults_present, 0);
    EXPECT_EQ(flight.article.step(now + kStep, kStep).status, 0);
  }
}

TEST(Clock, TicksThatDoNotAgreeAreRefusedForever) {
  Flight flight = under_way();
  GpsTime now = flight.now + duration_of_seconds(3600);
  for (int k = 0; k < 50; ++k, now = now + kStep + Duration{1}) {
    EXPECT_NE(flight.article.step(now, kStep).status, 0);
  }
  EXPECT_EQ(flight.article.step(flight.now, kStep).status, 0);
}

TEST(Clock, ATelecommandAcceptsTheTimeOfTheNextTick) {
  Flight flight = under_way();
  const GpsTime jumped = flight.now + duration_of_seconds(3600);
  EXPECT_EQ(flight.article.deliver(jumped, fault_command{.clear = telemetry_health::kFaultClock}), 0);
  EXPECT_NE(flight.article.step(jumped, kStep).status, 0);
  EXPECT_EQ(flight.article.step(jumped + kStep, kStep).status, 0);
}

TEST(Clock, AStepLateByThreePeriodsIsReportedInThatStep) {
  Flight flight = under_way();
  const Answer punctual = first_step(flight.article, flight, flight.now);
  EXPECT_EQ(punctual.health.faults, 0);
  const Answer late = first_step(flight.article, flight, flight.now + duration_of_seconds(4 * 60));
  EXPECT_EQ(late.status, 0);
  EXPECT_EQ(late.health.faults_present, telemetry_health::kFaultStepLate);
  ASSERT_EQ(late.events.size(), 1U);
  EXPECT_EQ(late.events[0].argument, 180.0);
}

TEST(Clock, AnUnusableTimeIsRefusedAfterAnyNumberOfThem) {
  Flight flight = under_way();
  for (int k = 0; k < 10; ++k) {
    const Answer answer = flight.article.step_without_tick({std::numeric_limits<std::int64_t>::min()});
    EXPECT_EQ(answer.status, static_cast<vbar_status>(Status::kOutOfRange));
    EXPECT_EQ(answer.telemetry_count, 1);
  }
}

}  // namespace
}  // namespace vbar::fsw::gnc::test
