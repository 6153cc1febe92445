// Reports of burns against their commands: each kind of failure by its own fault.

#include "fsw/fdir/burn_monitor.h"

#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/fsw/gnc/small_world.h"
#include "tests/unit/fsw/messaging/configurations.h"

namespace vbar::fsw::fdir {
namespace {

using gnc::test::at;

class BurnMonitorTest : public ::testing::Test {
 protected:
  /// A report for the next step.
  void report(std::int32_t id, GpsTime time, const Vector3& dv_rtn, bool accepted = true) {
    executed_maneuver message{};
    message.maneuver_id = id;
    message.accepted = accepted ? 1 : 0;
    for (int k = 0; k < 3; ++k) message.dv_rtn[k] = dv_rtn(k);
    ASSERT_EQ(inbox_.receive(gnc::test::packet_of(time, message, sequence_++, kServicer)), Status::kOk);
  }
  /// The faults that the step raised.
  std::int32_t step(GpsTime now) {
    faults_.clear(now, ~0);
    faults_.forget_transitions();
    monitor_.update(now, inbox_, faults_);
    inbox_.clear(now);
    std::int32_t raised = 0;
    for (const faults::Transition& transition : faults_.transitions()) raised |= transition.fault;
    return raised;
  }

  static constexpr std::uint8_t kServicer = 1;
  messaging::Inbox inbox_{kServicer};
  faults::FaultMonitor faults_;
  BurnMonitor monitor_;
  std::uint16_t sequence_ = 0;
};

const Vector3 kBurn(0.0, 2e-3, 1e-3);

TEST_F(BurnMonitorTest, ABurnAsCommandedRaisesNothing) {
  monitor_.expect(3, at(100), kBurn);
  report(3, at(100), kBurn);
  EXPECT_EQ(step(at(120)), 0);
  EXPECT_EQ(monitor_.executed(), 1);
  EXPECT_NEAR(monitor_.scale().scale(), 1.0, 1e-12);
  EXPECT_EQ(step(at(2000)), 0) << "it has been reported";
}

TEST_F(BurnMonitorTest, ARefusedBurn) {
  monitor_.expect(3, at(100), kBurn);
  report(3, at(100), Vector3::Zero(), false);
  EXPECT_EQ(step(at(120)), telemetry_health::kFaultBurnRefused);
  EXPECT_EQ(monitor_.executed(), 0);
}

TEST_F(BurnMonitorTest, ALateBurn) {
  monitor_.expect(3, at(100), kBurn);
  report(3, at(109), kBurn);
  EXPECT_EQ(step(at(120)), telemetry_health::kFaultBurnLate);
  EXPECT_DOUBLE_EQ(faults_.transitions().front().argument, 9.0);
}

TEST_F(BurnMonitorTest, ABurnOfAnotherSizeStatesTheRatio) {
  for (const double ratio : {0.8, 1.3}) {
    monitor_.expect(3, at(100), kBurn);
    report(3, at(100), ratio * kBurn);
    EXPECT_EQ(step(at(120)), telemetry_health::kFaultBurnSize) << ratio;
    EXPECT_NEAR(faults_.transitions().front().argument, ratio, 1e-12);
  }
}

TEST_F(BurnMonitorTest, ABurnInAnotherDirection) {
  monitor_.expect(3, at(100), {0.0, 2e-3, 0.0});
  report(3, at(100), {0.4e-3, 2e-3, 0.0});
  EXPECT_EQ(step(at(120)), telemetry_health::kFaultBurnSize);
}

TEST_F(BurnMonitorTest, BurnsOfTheLeastImpulseMayDifferByIt) {
  monitor_.expect(3, at(100), {0.0, 2e-5, 0.0});
  report(3, at(100), {0.0, 1.2e-5, 0.0});
  EXPECT_EQ(step(at(120)), 0);
}

// A tenth of each is missing. The impulse that a thruster errs by is 2 um/s: of the smallest burn, 5 um/s are missing.
TEST_F(BurnMonitorTest, BurnsTooShortAreReportedAtTheThirdAtTheLatest) {
  for (const double size : {50e-6, 100e-6, 0.2e-3, 2e-3, 20e-3}) {
    BurnMonitor monitor;
    faults::FaultMonitor faults;
    for (int id = 1; id <= 3; ++id) {
      monitor.expect(id, at(100 * id), {0.0, size, 0.0});
      report(id, at(100 * id), {0.0, 0.9 * size, 0.0});
      monitor.update(at(100 * id + 20), inbox_, faults);
      inbox_.clear(at(100 * id + 20));
    }
    EXPECT_EQ(faults.latched(), telemetry_health::kFaultBurnSize) << size;
    EXPECT_NEAR(monitor.scale().scale(), 0.9, 2.5 * monitor.scale().sigma()) << size;
  }
}

/// Small burns, which cannot show it, count neither for it nor against it.
TEST_F(BurnMonitorTest, AThrusterThatLosesATenthIsReportedAtTheFirstBurnThatShowsIt) {
  int id = 0;
  const auto burn = [&](double size, double ratio) {
    ++id;
    monitor_.expect(id, at(100 * id), {0.0, size, 0.0});
    report(id, at(100 * id), {0.0, ratio * size, 0.0});
    return step(at(100 * id + 20));
  };
  for (const double size : {1.8e-3, 1.5e-3, 200e-6, 20e-6, 16e-6}) EXPECT_EQ(burn(size, 1.0), 0) << size;
  for (const double size : {41e-6, 77e-6}) EXPECT_EQ(burn(size, 0.9), 0) << size;
  EXPECT_EQ(burn(191e-6, 0.9), telemetry_health::kFaultBurnSize);
  EXPECT_NEAR(monitor_.scale().scale(), 0.9, 0.01);
}

/// Errors of 2 um/s and of 1 %, one sigma, are the thruster's own.
TEST_F(BurnMonitorTest, BurnsWithTheErrorsOfAThrusterRaiseNothing) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int id = 1; id <= 400; ++id) {
    const double size = id % 2 == 0 ? 40e-6 : 1e-3;
    monitor_.expect(id, at(100 * id), {0.0, size, 0.0});
    const double across = 2e-6 * normal(random);
    report(id, at(100 * id), {across, size * (1.0 + 0.01 * normal(random)) + 2e-6 * normal(random), 0.0});
    EXPECT_EQ(step(at(100 * id + 20)), 0) << id;
  }
}

TEST_F(BurnMonitorTest, TwoMissedBurnsInARowAreTheThrusters) {
  for (int k = 0; k < 2; ++k) {
    monitor_.expect(k, at(100 + k), kBurn);
    report(k, at(100 + k), Vector3::Zero());
  }
  EXPECT_EQ(step(at(120)), int{telemetry_health::kFaultBurnMissed} | int{telemetry_health::kFaultThruster});
}

TEST_F(BurnMonitorTest, ABurnThatNobodyReportsIsMissed) {
  monitor_.expect(3, at(100), kBurn);
  EXPECT_EQ(step(at(400)), 0);
  EXPECT_EQ(step(at(401)), telemetry_health::kFaultBurnMissed);
  EXPECT_EQ(step(at(402)), 0) << "once";
}

TEST_F(BurnMonitorTest, ABurnThatNobodyCommanded) {
  report(77, at(100), {0.0, 1e-2, 0.0});
  EXPECT_EQ(step(at(120)), telemetry_health::kFaultBurnUncommanded);
  EXPECT_DOUBLE_EQ(faults_.transitions().front().argument, 1e-2);
  report(-1, at(130), kBurn);
  EXPECT_EQ(step(at(140)), 0) << "negative numbers are the ground's own burns";
}

// Every burn 10 % short, with the scatter of a thruster of 1 %: after ten burns the scale is known to a part in a
// hundred, and no better than its own sigma states.
TEST_F(BurnMonitorTest, TheScaleIsEstimated) {
  const std::array<double, 10> scatter{0.004, -0.011, 0.002, 0.007, -0.003, 0.012, -0.008, 0.001, -0.005, 0.009};
  for (std::size_t k = 0; k < scatter.size(); ++k) {
    const auto id = static_cast<std::int32_t>(k);
    monitor_.expect(id, at(100 + id), kBurn);
    report(id, at(100 + id), (0.9 + scatter[k]) * kBurn);
    step(at(101 + id));
  }
  EXPECT_NEAR(monitor_.scale().scale(), 0.9, 0.01);
  EXPECT_LT(monitor_.scale().sigma(), 0.01);
  EXPECT_LT(std::abs(monitor_.scale().scale() - 0.9), 3.0 * monitor_.scale().sigma());
}

}  // namespace
}  // namespace vbar::fsw::fdir
