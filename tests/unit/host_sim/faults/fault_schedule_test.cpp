// Faults that begin with events.

#include "host_sim/faults/fault_schedule.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "fsw/orbit/roe.h"
#include "fsw/packets/messages.h"
#include "host_sim/faults/fault_injection.h"
#include "host_sim/twins/actuator.h"
#include "host_sim/twins/packet_encoder.h"

namespace vbar::faults {

namespace {

using mission::Fault;
using mission::FaultEvent;
using mission::FaultKind;

constexpr fsw::GpsTime at(double s) {
  return fsw::GpsTime{1'000'000'000'000} + fsw::nearest_duration(s);
}

Fault awaiting(FaultEvent::Kind kind, double argument, double delay_s = 0.0) {
  Fault fault;
  fault.awaited = FaultEvent{kind, argument, fsw::nearest_duration(delay_s)};
  fault.begin = Fault::kNever;
  return fault;
}

twins::TruthSnapshot pair_at(double s, double range_m) {
  twins::TruthSnapshot truth;
  truth.time = at(s);
  truth.spacecraft.resize(2);
  truth.spacecraft[0].name = "servicer";
  truth.spacecraft[1].name = "target";
  truth.spacecraft[1].orbit.position_eci = truth.spacecraft[0].orbit.position_eci + fsw::Vector3(0.0, range_m, 0.0);
  return truth;
}

TEST(FaultSchedule, ARangeCountsOnceItIsBelow) {
  FaultSchedule schedule({awaiting(FaultEvent::Kind::kRangeBelow, 10.0, 20.0)}, "servicer", "target");
  const Fault& fault = schedule.faults()[0];
  schedule.on_truth(pair_at(0.0, 10.0));
  EXPECT_FALSE(fault.has_begun(at(1e6)));
  schedule.on_truth(pair_at(60.0, 9.9));
  EXPECT_EQ(fault.begin, at(80.0));
  EXPECT_FALSE(fault.has_begun(at(79.0)));
  EXPECT_TRUE(fault.is_present(at(80.0)));
  schedule.on_truth(pair_at(120.0, 9.0));
  EXPECT_EQ(fault.begin, at(80.0)) << "the first time";
}

TEST(FaultSchedule, TheFirstFixIsThatOfTelemetry) {
  FaultSchedule schedule({awaiting(FaultEvent::Kind::kFirstFix, 0.0)}, "servicer", "target");
  twins::PacketEncoder encoder(1, 0);
  telemetry_gnss telemetry{};
  telemetry.tracked = 12;
  const auto step = [&](std::uint32_t number, double s) {
    const std::vector<pil::Packet> outputs{*encoder.encode(at(s), telemetry)};
    schedule.on_step(number, at(s), {}, outputs);
  };
  step(0, 10.0);
  EXPECT_TRUE(schedule.faults()[0].awaited.has_value());
  telemetry.fixed = 12;
  step(1, 20.0);
  EXPECT_EQ(schedule.faults()[0].begin, at(20.0));
}

// It is burn N itself that such a fault concerns first.
TEST(FaultSchedule, BurnsAreCountedAtTheirIgnition) {
  Fault fault = awaiting(FaultEvent::Kind::kBurn, 2.0);
  fault.kind = FaultKind::kThrustScale;
  fault.value = 0.5;
  const auto schedule = std::make_shared<FaultSchedule>(std::vector<Fault>{fault}, "servicer", "target");
  FaultyThruster thruster(
      std::make_unique<twins::IdealThruster>(twins::IdealThruster::Settings{}, engine::RandomStream(1, "thruster")),
      schedule);
  maneuver_command command{};
  command.dv_rtn[1] = 1.0;
  EXPECT_EQ(thruster.execute(command, at(10.0), at(10.0)).maneuver.dv_rtn[1], 1.0);
  EXPECT_EQ(thruster.execute(command, at(15.0), at(16.0)).maneuver.accepted, 0) << "too late: no burn";
  EXPECT_EQ(thruster.execute(command, at(20.0), at(20.0)).maneuver.dv_rtn[1], 0.5);
  EXPECT_EQ(schedule->faults()[0].begin, at(20.0));
}

TEST(FaultSchedule, AStuckThrusterPushesFromItsEventOn) {
  Fault fault = awaiting(FaultEvent::Kind::kRangeBelow, 10.0, 5.0);
  fault.kind = FaultKind::kThrustUncommanded;
  fault.value = 1e-3;
  fault.duration = fsw::nearest_duration(2.5);
  fault.direction_rtn = fsw::Vector3::UnitY();
  const auto schedule = std::make_shared<FaultSchedule>(std::vector<Fault>{fault}, "servicer", "target");
  UncommandedImpulses impulses(schedule);
  EXPECT_TRUE(impulses.take().empty());
  schedule->on_truth(pair_at(60.0, 9.0));
  const std::vector<UncommandedImpulse> taken = impulses.take();
  ASSERT_EQ(taken.size(), 3U);
  EXPECT_EQ(taken[0].time, at(65.5));
  EXPECT_EQ(taken[2].time, at(67.25));
  EXPECT_DOUBLE_EQ(taken[0].dv_rtn.y() + taken[1].dv_rtn.y() + taken[2].dv_rtn.y(), 2.5e-3);
  EXPECT_TRUE(impulses.take().empty()) << "once";
}

}  // namespace

// The a-priori orbit that a restarted flight computer is sent: that of its last telemetry, not that of the start.

namespace {

constexpr fsw::orbit::QnsElements kServicer{.a = 7e6, .ex = 1e-3, .ey = 0.0, .i = 1.7, .raan = 0.3, .u = 0.0};

fsw::GpsTime time_at(double s) {
  return fsw::GpsTime{} + fsw::nearest_duration(1000.0 + s);
}

telemetry_navigation navigation() {
  const auto state = fsw::orbit::cartesian_from_qns(kServicer).value();
  telemetry_navigation reported{};
  reported.valid = 1;
  for (int k = 0; k < 3; ++k) {
    reported.servicer_position_eci[k] = state.position_eci(k);
    reported.servicer_velocity_eci[k] = state.velocity_eci(k);
  }
  for (int k = 0; k < 6; ++k) reported.a_roe_mean_m[k] = 10.0 * (k + 1);
  return reported;
}

class ReportedStateTest : public testing::Test {
 protected:
  void report(double s, const telemetry_navigation& navigation) {
    const std::vector<pil::Packet> packets{*encoder_.encode(time_at(s), navigation)};
    reported_.take(packets);
  }
  /// The second of two telecommands, of which the first is none of the orbit's.
  std::pair<fsw::GpsTime, target_apriori> sent(double now_s) {
    target_apriori of_the_start{};
    of_the_start.mean_a_roe_m[0] = -1.0;
    std::vector<pil::Packet> telecommands{*encoder_.encode(time_at(-1000.0), earth_configuration{}),
                                          *encoder_.encode(time_at(-1000.0), of_the_start)};
    const auto applied = reported_.applied_to(telecommands, time_at(now_s));
    EXPECT_EQ(applied.size(), 2U);
    EXPECT_EQ(applied[0], telecommands[0]);
    const auto packet = fsw::packets::parse_packet(applied[1]).value();
    return {packet.header.time, fsw::packets::decode<target_apriori>(packet).value()};
  }

  twins::PacketEncoder encoder_{1, 0};
  ReportedState reported_;
};

TEST_F(ReportedStateTest, IsThatOfTheLastTelemetry) {
  report(0.0, telemetry_navigation{});
  telemetry_navigation first = navigation();
  first.a_roe_mean_m[0] = 5.0;
  report(10.0, first);
  report(20.0, navigation());
  const auto [time, apriori] = sent(80.0);
  EXPECT_EQ(time, time_at(20.0));
  EXPECT_EQ(apriori.kind, target_apriori::kKindRoe);
  for (int k = 0; k < 6; ++k) EXPECT_EQ(apriori.mean_a_roe_m[k], 10.0 * (k + 1)) << k;
}

TEST_F(ReportedStateTest, AnInvalidEstimateIsNotSent) {
  telemetry_navigation invalid = navigation();
  invalid.valid = 0;
  report(20.0, invalid);
  EXPECT_EQ(sent(80.0).second.mean_a_roe_m[0], -1.0);
}

TEST_F(ReportedStateTest, AnOldReportIsNotSent) {
  report(0.0, navigation());
  EXPECT_EQ(sent(540.0).second.mean_a_roe_m[0], 10.0);
  EXPECT_EQ(sent(541.0).second.mean_a_roe_m[0], -1.0);
}

TEST_F(ReportedStateTest, WhatIsNoOrbitIsNotSent) {
  telemetry_navigation still = navigation();
  for (double& v : still.servicer_velocity_eci) v = 0.0;
  report(20.0, still);
  EXPECT_EQ(sent(80.0).second.mean_a_roe_m[0], -1.0);
}

TEST_F(ReportedStateTest, ARetreatInForceIsCommandedAgain) {
  const auto mode_after = [&](std::int8_t reported_mode) {
    telemetry_control control{};
    control.mode = reported_mode;
    reported_.take(std::vector<pil::Packet>{*encoder_.encode(time_at(20.0), control)});
    const auto applied = reported_.applied_to(
        {*encoder_.encode(time_at(-1000.0), mode_command{.mode = mode_command::kModeApproach})}, time_at(1000.0));
    return fsw::packets::decode<mode_command>(fsw::packets::parse_packet(applied.at(0)).value()).value().mode;
  };
  EXPECT_EQ(mode_after(mode_command::kModeHold), mode_command::kModeApproach);
  EXPECT_EQ(mode_after(mode_command::kModeRetreat), mode_command::kModeRetreat);
  EXPECT_EQ(mode_after(mode_command::kModeApproach), mode_command::kModeApproach);
}

// At the node of the orbit, where sines and cosines of u are 0 and 1, by hand.
TEST_F(ReportedStateTest, SigmasBoundThoseOfTheElements) {
  telemetry_navigation reported = navigation();
  const double n = fsw::orbit::mean_motion(kServicer.a);
  const double sigma[6] = {0.1, 0.5, 0.2, 0.02 * n, 0.03 * n, 0.04 * n};
  for (int k = 0; k < 6; ++k) reported.sigma_rtn[k] = sigma[k];
  const auto apriori = apriori_of(reported);
  ASSERT_TRUE(apriori);
  const double expected[6] = {4.0 * 0.1 + 2.0 * 0.03, 0.5 + 2.0 * 0.02, 3.0 * 0.1 + 2.0 * 0.03, 0.02, 0.04, 0.2};
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(apriori->sigma_a_roe_m[k], expected[k], 1e-6) << k;
}

}  // namespace

}  // namespace vbar::faults
