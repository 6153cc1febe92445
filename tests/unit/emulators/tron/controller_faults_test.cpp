// Clamps, monitors and stop states of an emulated controller.

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/emulators/tron/one_robot.h"

namespace vbar::tron::bench {
namespace {

/// Answers `cycles` cycles with corrections of all axes that follow (1 - cos) / 2 from 0 to `degrees` of A4.
void move_a4(OneRobot& bench, double degrees, int cycles, int stop_at = -1) {
  for (int k = 1; k <= cycles && k != stop_at; ++k) {
    rsi::Sen sen = bench.answer_to(bench.receive());
    sen.axes_deg[3] = degrees * 0.5 * (1.0 - std::cos(3.14159265358979 * k / cycles));
    bench.send(sen);
    bench.finish_cycle();
  }
}

void answer(OneRobot& bench, std::size_t axis, double degrees) {
  rsi::Sen sen = bench.answer_to(bench.receive());
  sen.axes_deg[axis] = degrees;
  bench.send(sen);
  bench.finish_cycle();
}

/// KUKA's defaults: corrections +-5 deg, monitor 6 deg.
ControllerSettings with_defaults_of_kuka() {
  ControllerSettings settings = camera_robot(0);
  const rsi::ContextXml preset;
  for (std::size_t k = 0; k < rsi::kWireAxes; ++k) {
    settings.context.axes[k].lower = preset.axes[k].lower;
    settings.context.axes[k].upper = preset.axes[k].upper;
  }
  settings.context.monitor_deg = preset.monitor_deg;
  return settings;
}

TEST(ControllerLimits, CorrectionsAreClampedSilently) {
  OneRobot bench(with_defaults_of_kuka());
  (void)bench.command(eki::Action::kStart);
  move_a4(bench, 5.5, 200);
  for (int k = 0; k < 30; ++k) answer(bench, 3, 5.5);
  EXPECT_DOUBLE_EQ(5.0, bench.receive().axes_deg[3]);
  EXPECT_GT(bench.controller.statistics().clamps, 30U);
  EXPECT_EQ("", bench.controller.state().message);
  EXPECT_TRUE(bench.controller.rsi_is_on());
}

TEST(ControllerLimits, TheOverallMonitorEndsRsi) {
  ControllerSettings settings = with_defaults_of_kuka();
  settings.context.axes[3].upper = 20.0;
  OneRobot bench(settings);
  (void)bench.command(eki::Action::kStart);
  for (int k = 1; bench.controller.rsi_is_on() && k < 1000; ++k) answer(bench, 3, 0.01 * k);
  const eki::State state = bench.controller.state();
  EXPECT_EQ("KSS29000: overall correction of A4: 6.0100 of 6.0000", state.message);
  EXPECT_TRUE(state.stopped);
  EXPECT_TRUE(state.drives_powered);
}

TEST(ControllerLimits, SpeedSwitchesTheDrivesOff) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  answer(bench, 0, 0.0);
  answer(bench, 0, 1.21);  // 300 deg/s are 1.2 deg a cycle
  const eki::State state = bench.controller.state();
  EXPECT_FALSE(state.drives_powered);
  EXPECT_FALSE(state.rsi_on);
  EXPECT_EQ("speed of A1 above its limit: 302.5000 of 300.0000 a second", state.message);
  EXPECT_EQ(1U, bench.controller.statistics().limit_trips);
}

TEST(ControllerLimits, AccelerationSwitchesTheDrivesOff) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  answer(bench, 1, 0.0);
  answer(bench, 1, 0.002);  // 125 deg/s2 = 2.18 rad/s2; A2 has 1.73, and rounding may have made 0.22 of it
  EXPECT_EQ("acceleration of A2 above its limit: 125.0000 of 99.1217 a second squared",
            bench.controller.state().message);
}

TEST(ControllerLimits, ASoftwareLimitSwitchesTheDrivesOff) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  for (int k = 1; bench.controller.rsi_is_on() && k < 10000; ++k) answer(bench, 3, 0.02 * k * std::min(1.0, k / 100.0));
  EXPECT_THAT(bench.controller.state().message, testing::StartsWith("software limit of A4: 185.0"));
  EXPECT_FALSE(bench.controller.state().drives_powered);
  EXPECT_NEAR(185.0, bench.controller.position().axes_rad[3] * rsi::kDegreesPerRadian, 0.2);
}

TEST(ControllerStops, AnEmergencyStopBrakesAndHasToBeAcknowledged) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  move_a4(bench, 40.0, 200, 100);
  bench.controller.set_emergency_stop(true);
  eki::State state = bench.controller.state();
  EXPECT_TRUE(state.emergency_stop);
  EXPECT_FALSE(state.drives_powered);
  EXPECT_FALSE(state.rsi_on);
  EXPECT_EQ("emergency stop", state.message);
  // Bench time goes on until the axes stand, and then stands still.
  while (!bench.controller.stands()) bench.context.run_one();
  // From 78.5 deg/s of A4, whose 381 deg/s last 0.3 s: 2.43 deg behind the command of 19.7 deg.
  const double stands_at = bench.controller.position().axes_rad[3] * rsi::kDegreesPerRadian;
  EXPECT_NEAR(19.7 + 2.43, stands_at, 0.2);
  const std::uint64_t cycle = bench.clock.cycle();
  bench.context.poll();
  EXPECT_EQ(cycle, bench.clock.cycle());

  EXPECT_EQ("start refused: emergency stop", bench.command(eki::Action::kStart).message);
  EXPECT_EQ("reset refused: emergency stop", bench.command(eki::Action::kReset).message);
  bench.controller.set_emergency_stop(false);
  EXPECT_EQ("start refused: not acknowledged: emergency stop", bench.command(eki::Action::kStart).message);
  state = bench.command(eki::Action::kReset);
  EXPECT_TRUE(state.drives_powered);
  EXPECT_EQ("", state.message);
  bench.discard();
  EXPECT_TRUE(bench.command(eki::Action::kStart).rsi_on);
  // Corrections count from here.
  EXPECT_NEAR(stands_at, bench.receive().axes_deg[3], 5e-5);
  for (int k = 0; k < 20; ++k) answer(bench, 3, 0.0);
  EXPECT_NEAR(stands_at, bench.receive().axes_deg[3], 5e-5);
}

TEST(ControllerStops, TheStopSignalEndsRsiOnItsRisingEdge) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  rsi::Sen sen = bench.answer_to(bench.receive());
  sen.stop = true;
  bench.send(sen);
  bench.finish_cycle();
  const eki::State state = bench.controller.state();
  EXPECT_FALSE(state.rsi_on);
  EXPECT_FALSE(state.stopped);
  EXPECT_EQ("RSI ended by the stop signal", state.message);
  EXPECT_TRUE(bench.command(eki::Action::kStart).rsi_on);
}

TEST(ControllerStops, RsiStartsAgainAfterSilenceWithoutAJump) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  move_a4(bench, 40.0, 200, 100);
  const double held = bench.controller.position().axes_rad[3];
  while (bench.controller.rsi_is_on()) bench.finish_cycle();
  EXPECT_EQ("RSITimeout: 100 cycles in a row without a valid answer", bench.controller.state().message);
  bench.discard();
  while (!bench.controller.stands()) bench.context.run_one();
  const AxisPositions before = bench.controller.position();
  EXPECT_NEAR(held, before.axes_rad[3], 0.02);  // 8 ms of 78 deg/s
  (void)bench.command(eki::Action::kReset);
  (void)bench.command(eki::Action::kStart);
  for (int k = 0; k < 100; ++k) {
    answer(bench, 3, 0.0);
    EXPECT_LT((bench.controller.position().axes_rad - before.axes_rad).norm(), 1e-6);
  }
  EXPECT_EQ("", bench.controller.state().message);
  EXPECT_EQ(2U, bench.controller.statistics().rsi_starts);
}

TEST(ControllerFaults, FrozenPositionsStayWhileTheArmMoves) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  (void)bench.receive();
  bench.controller.set_frozen(true);
  for (int k = 0; k < 50; ++k) {
    bench.send(bench.answer_to(bench.receive()));
    bench.finish_cycle();
  }
  move_a4(bench, 10.0, 200);
  EXPECT_DOUBLE_EQ(0.0, bench.receive().axes_deg[3]);
  EXPECT_GT(bench.controller.position().axes_rad[3], 0.17);
}

TEST(ControllerFaults, ASilentRobotSendsNothingAndCountsOn) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  bench.send(bench.answer_to(bench.receive()));
  bench.controller.be_silent(20);
  bench.finish_cycle();
  const std::uint64_t silent_from = bench.clock.cycle();
  const rsi::Rob rob = bench.receive();
  EXPECT_EQ(silent_from + 20, bench.clock.cycle());
  EXPECT_EQ(20U, rob.delay);
  EXPECT_TRUE(bench.controller.rsi_is_on());
}

TEST(ControllerFaults, TheIpocJumpsBackAndTheAnswerMustFollowIt) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  const rsi::Rob first = bench.receive();
  bench.send(bench.answer_to(first));
  bench.controller.set_ipoc_back(1000);
  bench.finish_cycle();
  const rsi::Rob second = bench.receive();
  EXPECT_EQ(first.ipoc.value - 996, second.ipoc.value);
  bench.send(bench.answer_to(second));
  bench.finish_cycle();
  EXPECT_EQ(2U, bench.controller.statistics().answers);
}

TEST(ControllerFaults, DroppedRsiAndDrives) {
  OneRobot bench;
  (void)bench.command(eki::Action::kStart);
  bench.controller.drop_rsi();
  EXPECT_EQ("RSIBad: the connection is interrupted", bench.controller.state().message);
  EXPECT_TRUE(bench.controller.state().drives_powered);
  (void)bench.command(eki::Action::kReset);
  bench.controller.switch_drives_off("guard stop");
  EXPECT_FALSE(bench.controller.state().drives_powered);
  EXPECT_EQ("guard stop", bench.controller.state().message);
}

TEST(ControllerWorld, EachStandstillHasErrorsOfItsOwn) {
  OneRobot bench;
  int standstills = 0;
  bench.controller.on_standstill([&] {
    AxisPositions error;
    error.axes_rad[2] = 1e-5 * ++standstills;
    return error;
  });
  (void)bench.command(eki::Action::kStart);
  for (int move = 1; move <= 2; ++move) {
    for (int k = 1; k <= 200; ++k) answer(bench, 3, 10.0 * (move - 0.5 - 0.5 * std::cos(3.14159265358979 * k / 200)));
    for (int k = 0; k < 50; ++k) answer(bench, 3, 10.0 * move);
    EXPECT_EQ(move, standstills);
    EXPECT_NEAR(1e-5 * move, bench.controller.true_position().axes_rad[2] - bench.controller.position().axes_rad[2],
                1e-15);
  }
}

}  // namespace
}  // namespace vbar::tron::bench
