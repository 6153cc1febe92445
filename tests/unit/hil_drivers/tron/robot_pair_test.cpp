// Both robots through their emulated controllers: motion, and the faults of TRON.md, section 8.

#include "hil_drivers/tron/robot/robot_pair.h"

#include <atomic>
#include <cmath>
#include <functional>
#include <thread>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_future.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "emulators/tron/controller/cycle_clock.h"
#include "hil_drivers/tron/robot/robot_files.h"
#include "host_sim/mission/data_file.h"

namespace vbar::tron {
namespace {

using namespace std::chrono_literals;
using bench::Controller;

RobotPairSettings pair_settings(const TestbedDesign& bench) {
  RobotPairSettings settings;
  settings.camera_rsi =
      rsi::client_settings("camera robot", bench.camera_robot, &bench.track, robot_files(kCameraRobot));
  settings.target_rsi = rsi::client_settings("target robot", bench.target_robot, nullptr, robot_files(kTargetRobot));
  settings.camera_rsi.port = settings.target_rsi.port = 0;
  settings.track_home_m = bench.track.home_m;
  settings.start_patience = 60s;
  settings.silence_patience = 50ms;  // 1 s with the virtual clock
  return settings;
}

bench::ControllerSettings controller_settings(const TestbedDesign& bench, bool is_camera, std::uint16_t port) {
  const rsi::RobotFiles files = robot_files(is_camera ? kCameraRobot : kTargetRobot);
  bench::ControllerSettings settings{is_camera ? "camera robot" : "target robot",
                                     is_camera ? bench.camera_robot : bench.target_robot, std::nullopt, files.ethernet,
                                     files.context};
  if (is_camera) settings.track = bench.track;
  settings.ethernet.address = "127.0.0.1";
  settings.ethernet.port = port;
  settings.flange_pose = [](const rsi::AxisPositions&) { return bench::CartesianPose{}; };
  return settings;
}

/// The driver's end in the thread of the test, the controllers in one of their own.
class Laboratory {
 public:
  Laboratory()
      : bench_(read_testbed_design(mission::data_directory() / "benches" / "tron.toml")),
        pair(pair_settings(bench_)),
        camera(context_, controller_settings(bench_, true, pair.camera_rsi_port())),
        target(context_, controller_settings(bench_, false, pair.target_rsi_port())),
        clock(context_, {bench::ClockKind::kVirtual, 1s, true}, {&camera, &target}) {
    clock.before_cycle([this](std::uint64_t cycle) {
      if (fault && cycle == fault_cycle) fault();
    });
    clock.start();
    thread_ = std::thread([this] { context_.run(); });
    pair.open(eki_of(camera), eki_of(target), true);
  }
  ~Laboratory() {
    pair.close();
    context_.stop();
    thread_.join();
  }
  Laboratory(const Laboratory&) = delete;
  Laboratory& operator=(const Laboratory&) = delete;

  void in_emulator(const std::function<void()>& function) {
    boost::asio::post(context_, boost::asio::use_future(function)).get();
  }
  /// `function` runs in the emulator, `cycles` from now.
  void set_fault(std::uint64_t cycles, const std::function<void()>& function) {
    in_emulator([&] {
      fault_cycle = clock.cycle() + cycles;
      fault = function;
    });
  }
  rsi::AxisPositions position_of(const Controller& robot) {
    rsi::AxisPositions position;
    in_emulator([&] { position = robot.position(); });
    return position;
  }

 private:
  static eki::ClientSettings eki_of(const Controller& robot) {
    return {robot.settings().name, robot.settings().robot.line.address, robot.eki_port(), 60s, 60s};
  }
  TestbedDesign bench_;
  boost::asio::io_context context_;

 public:
  RobotPair pair;
  Controller camera, target;
  bench::CycleClock clock;

 private:
  std::function<void()> fault;
  std::uint64_t fault_cycle = 0;
  std::thread thread_;
};

/// From one posture to another along a straight line of the joints, (1 - cos) / 2 of the way.
Motion line(const Posture& from, const Posture& to, int cycles) {
  const auto at = [=](double share) {
    const double way = 0.5 * (1.0 - std::cos(3.14159265358979 * share));
    Posture posture = from;
    posture.camera_rad += way * (to.camera_rad - from.camera_rad);
    posture.target_rad += way * (to.target_rad - from.target_rad);
    posture.carriage_m += way * (to.carriage_m - from.carriage_m);
    return posture;
  };
  Motion motion;
  motion.cycles = cycles;
  motion.at = [=](int cycle) { return at(static_cast<double>(cycle) / cycles); };
  // Slows down over 100 cycles: the cycle that the path is at advances by 1 - j / 100 each.
  motion.stop_after = [=](int cycle) {
    Motion stop;
    stop.cycles = 100;
    stop.at = [=](int j) { return at((cycle + j - 0.005 * j * j) / cycles); };
    return stop;
  };
  return motion;
}

Posture moved(Posture posture) {
  posture.camera_rad[0] += 0.5;
  posture.camera_rad[3] -= 0.7;
  posture.target_rad[5] += 1.0;
  posture.carriage_m += 0.3;
  return posture;
}

void expect_at(const Posture& expected, const Posture& posture) {
  // Four decimals of a degree and of a millimetre each way.
  EXPECT_LT((expected.camera_rad - posture.camera_rad).norm(), 1e-5);
  EXPECT_LT((expected.target_rad - posture.target_rad).norm(), 1e-5);
  EXPECT_NEAR(expected.carriage_m, posture.carriage_m, 1e-6);
}

TEST(RobotPair, FollowsAMotionWithoutLateAnswersClampsOrTrips) {
  Laboratory laboratory;
  const Posture start = laboratory.pair.posture(), goal = moved(start);
  EXPECT_EQ(MotionEnd::kArrived, laboratory.pair.follow(line(start, goal, 500)));
  expect_at(goal, laboratory.pair.rest_posture());
  EXPECT_EQ(MotionEnd::kArrived, laboratory.pair.hold(25));
  laboratory.in_emulator([&] {
    for (const Controller* robot : {&laboratory.camera, &laboratory.target}) {
      EXPECT_EQ(0U, robot->statistics().cycles_without_answer);
      EXPECT_EQ(0U, robot->statistics().clamps);
      EXPECT_EQ(0U, robot->statistics().limit_trips);
      EXPECT_EQ("", robot->state().message);
    }
  });
}

TEST(RobotPair, AnEmergencyStopHaltsTheOtherArmAndIsRecoveredFrom) {
  Laboratory laboratory;
  const Posture start = laboratory.pair.posture(), goal = moved(start);
  laboratory.set_fault(250, [&] { laboratory.camera.set_emergency_stop(true); });
  EXPECT_EQ(MotionEnd::kInterrupted, laboratory.pair.follow(line(start, goal, 500)));
  // The other arm has been halted on its path, half a second of bench time later at most.
  double stopped_at = 0.0;
  laboratory.in_emulator([&] {
    EXPECT_TRUE(laboratory.target.rsi_is_on());
    EXPECT_EQ(0U, laboratory.target.statistics().limit_trips);
    EXPECT_LE(laboratory.clock.cycle(), 250U + 125U + 50U);
    stopped_at = laboratory.target.position().axes_rad[5];
  });
  EXPECT_GT(stopped_at, 0.4);
  EXPECT_LT(stopped_at, 0.9);
  int reports = 0;
  laboratory.pair.recover([&](const std::string& report) {
    ++reports;
    EXPECT_THAT(report, testing::HasSubstr("camera robot: emergency stop"));
    laboratory.in_emulator([&] { laboratory.camera.set_emergency_stop(false); });
  });
  EXPECT_EQ(1, reports);
  // No jump but the 8 ms by which the drives lag behind the last commands, and the run goes on.
  EXPECT_NEAR(stopped_at, laboratory.position_of(laboratory.target).axes_rad[5], 2e-4);
  EXPECT_EQ(MotionEnd::kArrived, laboratory.pair.follow(line(laboratory.pair.command(), goal, 500)));
  expect_at(goal, laboratory.pair.rest_posture());
}

TEST(RobotPair, RsiThatBreaksOffIsRestartedOnce) {
  Laboratory laboratory;
  const Posture start = laboratory.pair.posture(), goal = moved(start);
  laboratory.set_fault(250, [&] { laboratory.target.drop_rsi(); });
  EXPECT_EQ(MotionEnd::kInterrupted, laboratory.pair.follow(line(start, goal, 500)));
  const double stood_at = laboratory.position_of(laboratory.target).axes_rad[5];
  laboratory.pair.recover(nullptr);
  EXPECT_EQ(1U, laboratory.pair.counts().rsi_restarts);
  EXPECT_EQ(MotionEnd::kArrived, laboratory.pair.hold(25));
  EXPECT_NEAR(stood_at, laboratory.position_of(laboratory.target).axes_rad[5], 1e-5);
  EXPECT_EQ(MotionEnd::kArrived, laboratory.pair.follow(line(laboratory.pair.command(), goal, 500)));
  expect_at(goal, laboratory.pair.rest_posture());
}

TEST(RobotPair, AnswersThatAreLostEndRsiAndItIsRestarted) {
  Laboratory laboratory;
  const Posture start = laboratory.pair.posture();
  laboratory.set_fault(10, [&] { laboratory.camera.lose_answers(100); });
  EXPECT_EQ(MotionEnd::kInterrupted, laboratory.pair.hold(300));
  laboratory.pair.recover(nullptr);
  EXPECT_EQ(1U, laboratory.pair.counts().rsi_restarts);
  EXPECT_EQ(MotionEnd::kArrived, laboratory.pair.hold(25));
  expect_at(start, laboratory.pair.rest_posture());
}

TEST(RobotPair, ASilentRobotIsRestarted) {
  Laboratory laboratory;
  const Posture start = laboratory.pair.posture();
  laboratory.set_fault(10, [&] { laboratory.camera.be_silent(50); });
  EXPECT_EQ(MotionEnd::kInterrupted, laboratory.pair.hold(100));
  laboratory.pair.recover(nullptr);
  EXPECT_EQ(MotionEnd::kArrived, laboratory.pair.hold(100));
  expect_at(start, laboratory.pair.rest_posture());
}

TEST(RobotPair, AnIpocThatJumpsBackInterruptsTheMotion) {
  Laboratory laboratory;
  laboratory.set_fault(10, [&] { laboratory.camera.set_ipoc_back(1); });
  EXPECT_EQ(MotionEnd::kArrived, laboratory.pair.hold(50));  // 3 ms on in place of 4: still newer
  laboratory.set_fault(10, [&] { laboratory.camera.set_ipoc_back(40); });
  EXPECT_EQ(MotionEnd::kInterrupted, laboratory.pair.hold(50));
  laboratory.pair.recover(nullptr);
  EXPECT_EQ(MotionEnd::kArrived, laboratory.pair.hold(50));
}

}  // namespace
}  // namespace vbar::tron
