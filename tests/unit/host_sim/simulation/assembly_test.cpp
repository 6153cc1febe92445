// A mission as a world: its truth, and two seconds of it in real time.

#include "host_sim/simulation/assembly.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fsw/packets/messages.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/sensors/sensor_kind.h"
#include "host_sim/simulation/flight_computer.h"
#include "tests/support/paths.h"

namespace vbar::app {

namespace {

mission::Mission load(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return sensors::load_mission(vbar::tests::source_path() + "/missions/" + name, overrides);
}

std::string data() {
  return vbar::tests::source_path() + "/data";
}

TEST(RunTruth, OutlookIsWhatTheTruthBecomes) {
  const mission::Mission mission = load("experiment3.toml");
  const mission::Spacecraft& servicer = flying_spacecraft(mission);
  RunTruth ahead(mission, servicer, data());
  RunTruth later(mission, servicer, data());
  const fsw::GpsTime now = mission.start_time() + fsw::duration_of_seconds(10);
  ahead.advance_to(now);
  for (const std::int64_t ms : {0, 100, 1000}) {
    const fsw::GpsTime time = now + fsw::Duration{ms * 1'000'000};
    const twins::TruthSnapshot outlook = ahead.at(time);
    later.advance_to(time);
    const twins::TruthSnapshot truth = later.snapshot(twins::TruthDetail::kAccelerations);
    EXPECT_EQ(outlook.time, time);
    EXPECT_LT((outlook.R_itrf_gcrf - truth.R_itrf_gcrf).norm(), 1e-14);
    for (std::size_t k = 0; k < truth.spacecraft.size(); ++k) {
      const auto &one = outlook.spacecraft[k], &other = truth.spacecraft[k];
      EXPECT_EQ(one.name, other.name);
      EXPECT_LT((one.orbit.position_eci - other.orbit.position_eci).norm(), 1e-5);
      EXPECT_LT((one.orbit.velocity_eci - other.orbit.velocity_eci).norm(), 2e-5);
      EXPECT_LT((*one.acceleration_eci - *other.acceleration_eci).norm(), 5e-5);
      EXPECT_LT(one.attitude->q_body_eci.angularDistance(other.attitude->q_body_eci), 1e-8);
    }
  }
}

TEST(RunTruth, AccelerationsAreDerivatives) {
  const mission::Mission mission = load("experiment3.toml");
  RunTruth truth(mission, flying_spacecraft(mission), data());
  const auto at = [&](int ms) {
    truth.advance_to(mission.start_time() + fsw::Duration{ms * 1'000'000LL});
    return truth.snapshot(twins::TruthDetail::kAccelerations).spacecraft[0];
  };
  const twins::SpacecraftTruth before = at(10'000), now = at(10'500), after = at(11'000);
  const fsw::Vector3 acceleration = after.orbit.velocity_eci - before.orbit.velocity_eci;  // in one second
  EXPECT_LT((*now.acceleration_eci - acceleration).norm(), 1e-6);
  const fsw::Vector3 angular = after.attitude->rate_body - before.attitude->rate_body;
  ASSERT_TRUE(now.angular_acceleration_body);
  EXPECT_LT((*now.angular_acceleration_body - angular).norm(), 1e-9);
  EXPECT_FALSE(truth.snapshot(twins::TruthDetail::kStates).spacecraft[0].acceleration_eci);
}

TEST(RunTruth, LookingAheadChangesNoBit) {
  const mission::Mission mission = load("experiment3.toml");
  RunTruth watched(mission, flying_spacecraft(mission), data());
  RunTruth alone(mission, flying_spacecraft(mission), data());
  for (int s = 0; s <= 600; s += 10) {
    const fsw::GpsTime time = mission.start_time() + fsw::duration_of_seconds(s);
    watched.advance_to(time);
    alone.advance_to(time);
    static_cast<void>(watched.at(time + fsw::duration_of_seconds(1)));
    if (s != 300) continue;
    watched.apply_impulse_rtn({0.0, 1e-3, 0.0});
    alone.apply_impulse_rtn({0.0, 1e-3, 0.0});
  }
  const auto one = watched.snapshot(twins::TruthDetail::kStates), other = alone.snapshot(twins::TruthDetail::kStates);
  for (std::size_t k = 0; k < one.spacecraft.size(); ++k) {
    EXPECT_EQ(one.spacecraft[k].orbit.position_eci, other.spacecraft[k].orbit.position_eci);
    EXPECT_EQ(one.spacecraft[k].orbit.velocity_eci, other.spacecraft[k].orbit.velocity_eci);
    EXPECT_EQ(one.spacecraft[k].attitude->q_body_eci.coeffs(), other.spacecraft[k].attitude->q_body_eci.coeffs());
  }
}

TEST(RunTruth, OutlookReachesOneSecond) {
  const mission::Mission mission = load("ideal_navigation.toml");
  RunTruth truth(mission, flying_spacecraft(mission), data());
  EXPECT_THROW(static_cast<void>(truth.at(mission.start_time() + fsw::Duration{1'000'000'001})), std::out_of_range);
  EXPECT_THROW(static_cast<void>(truth.at(mission.start_time() - fsw::Duration{1})), std::out_of_range);
}

TEST(AssembledMission, TwoSecondsInRealTime) {
  const mission::Mission mission = load(
      "ideal_navigation.toml", {"mission.duration_h=0.000555555555556", "mission.step_s=0.5", "mission.start_h=0.5",
                                "clock.mode=real_time", "spacecraft.servicer.sensors.navigation.period_s=0.1",
                                "spacecraft.servicer.flight_computer.compute_latency_s=0.1"});
  AssembledMission assembled(mission, data());
  assembled.start();
  const auto computer = connect_flight_computer(flying_spacecraft(mission));
  engine::SteadyWallClock wall;
  report::RunRecord record;
  EXPECT_TRUE(assembled.fly({*computer, wall, {}, {}, {}}, record));
  EXPECT_GE(record.summary.wall_s, 1.9);
  EXPECT_NEAR(record.summary.simulated_s, 2.0, 1e-6);
  ASSERT_EQ(record.summary.sources.size(), 1U);
  EXPECT_EQ(record.summary.sources[0].name, "servicer/navigation");
  EXPECT_EQ(record.summary.sources[0].kind, "ideal");
  EXPECT_GE(record.summary.sources[0].epochs, 20);
  // Half an hour of propagation before the start is no part of the run.
  const auto& share = record.summary.wall_share;
  EXPECT_GE(share.other_s, 0.0);
  EXPECT_NEAR(share.truth_s + share.flight_s + share.link_s + share.other_s, record.summary.wall_s, 1e-9);
}

}  // namespace

namespace {

using testing::ElementsAre;
using twins::StopReason;

/// Writes down its life.
class Device final : public twins::PacketSource {
 public:
  Device(std::string name, std::vector<std::string>& diary, std::string refusal)
      : name_(std::move(name)), diary_(diary), refusal_(std::move(refusal)) {}
  void start(fsw::GpsTime) override {
    diary_.push_back("start " + name_);
    if (refusal_ == "start") throw std::runtime_error("the rails do not answer");
  }
  void stop(StopReason reason) override {
    diary_.push_back("stop " + name_ + " " + std::to_string(static_cast<int>(reason)));
    if (refusal_ == "stop") throw std::runtime_error("the brakes do not answer");
  }
  std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime) const override { return std::nullopt; }
  twins::Measurement measure(const twins::TruthSnapshot&) override { return {}; }

 private:
  std::string name_;
  std::vector<std::string>& diary_;
  std::string refusal_;
};

struct Bench {
  explicit Bench(const std::vector<std::string>& refusals) {
    for (std::size_t k = 0; k < refusals.size(); ++k) {
      const std::string name(1, static_cast<char>('a' + k));
      sources.push_back({name, "fake", std::make_unique<Device>(name, diary, refusals[k])});
    }
  }
  std::vector<std::string> diary;
  std::vector<Source> sources;
};

TEST(StartedSources, AreStoppedInReverseOrderOnce) {
  Bench bench({"", ""});
  {
    StartedSources started(bench.sources);
    started.start({});
    EXPECT_EQ(started.stop(StopReason::kCompleted), "");
    EXPECT_EQ(started.stop(StopReason::kCompleted), "");
  }
  EXPECT_THAT(bench.diary, ElementsAre("start a", "start b", "stop b 0", "stop a 0"));
}

TEST(StartedSources, AreStoppedByAnException) {
  Bench bench({""});
  try {
    StartedSources started(bench.sources);
    started.start({});
    throw std::runtime_error("the disk is full");
  } catch (const std::runtime_error&) {
    EXPECT_THAT(bench.diary, ElementsAre("start a", "stop a 1"));
  }
}

TEST(StartedSources, OneThatRefusesToStartIsNamedAndAllAreStopped) {
  Bench bench({"", "start", ""});
  StartedSources started(bench.sources);
  try {
    started.start({});
    ADD_FAILURE() << "started";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "source b: the rails do not answer");
  }
  EXPECT_THAT(bench.diary, ElementsAre("start a", "start b", "stop b 2", "stop a 2"));
}

TEST(StartedSources, OneThatCannotBeStoppedDoesNotKeepTheOthersRunning) {
  Bench bench({"", "stop"});
  StartedSources started(bench.sources);
  started.start({});
  EXPECT_EQ(started.stop(StopReason::kInterrupted), "source b could not be stopped: the brakes do not answer");
  EXPECT_THAT(bench.diary, ElementsAre("start a", "start b", "stop b 1", "stop a 1"));
}

}  // namespace

namespace {

using fsw::packets::Apid;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr fsw::GpsTime kStart{1'000'000'000LL};
constexpr fsw::GpsTime kLater{7'000'000'000LL};

/// Guidance, waypoints, two cameras and the mode.
std::vector<twins::Packet> telecommands(std::int32_t waypoints, double camera_value, bool with_mode = true) {
  sensors::Telecommands all(kStart, 1);
  all.add(gnc_configuration{});
  waypoint_table table{};
  table.count = waypoints;
  all.add(table);
  all.add(camera_configuration{}, 0);
  camera_configuration second{};
  second.focal_length_px[0] = camera_value;
  all.add(second, 1);
  if (with_mode) all.add(mode_command{});
  return all.packets();
}

TEST(ChangedTelecommands, AreThoseWithAnotherContentAtTheirTime) {
  const auto changed = changed_telecommands(telecommands(2, 1.0), telecommands(3, 1.0), kLater);
  ASSERT_EQ(changed.size(), 1U);
  const auto packet = fsw::packets::parse_packet(changed.front());
  ASSERT_TRUE(packet.ok());
  EXPECT_EQ(packet.value().header.apid, Apid::kWaypointTable);
  EXPECT_EQ(packet.value().header.time, kLater);
  EXPECT_EQ(packet.value().header.spacecraft, 1);
  EXPECT_EQ(fsw::packets::decode<waypoint_table>(packet.value()).value().count, 3);
  EXPECT_TRUE(changed_telecommands(telecommands(2, 1.0), telecommands(2, 1.0), kLater).empty());
}

TEST(ChangedTelecommands, OneThatWasNotSentIsNew) {
  EXPECT_EQ(changed_telecommands(telecommands(2, 1.0, false), telecommands(2, 1.0), kLater).size(), 1U);
}

TEST(ChangedTelecommands, WhatCannotBeGivenInFlightIsNamed) {
  EXPECT_THAT(
      [] { return changed_telecommands(telecommands(2, 1.0), telecommands(2, 2.0), kLater); },
      ThrowsMessage<std::runtime_error>(HasSubstr("camera_configuration, which is given before the first step")));
  EXPECT_THAT([] { return changed_telecommands(telecommands(2, 1.0), telecommands(2, 1.0, false), kLater); },
              ThrowsMessage<std::runtime_error>(HasSubstr("takes back the telecommand mode_command")));
}

}  // namespace

}  // namespace vbar::app
