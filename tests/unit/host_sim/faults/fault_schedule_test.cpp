// Faults that begin with events.

#include "host_sim/faults/fault_schedule.h"

#include <gtest/gtest.h>

#include "fsw/packets/messages.h"
#include "host_sim/faults/faulty_thruster.h"
#include "host_sim/twins/ideal_thruster.h"
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
}  // namespace vbar::faults
