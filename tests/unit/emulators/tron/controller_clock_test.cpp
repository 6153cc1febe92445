// Two robots on one clock, with the clients of the computer.

#include <cmath>
#include <functional>
#include <future>
#include <thread>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_future.hpp>
#include <boost/asio/write.hpp>
#include <gtest/gtest.h>

#include "hil_drivers/tron/protocols/eki.h"
#include "hil_drivers/tron/protocols/rsi_client.h"
#include "tests/unit/emulators/tron/one_robot.h"

namespace vbar::tron::bench {
namespace {

using namespace std::chrono_literals;
constexpr auto kPatience = 60s;  // of what must come, on any machine

/// Both robots in a thread of their own, and the computer's clients in that of the test.
class TwoRobots {
 public:
  explicit TwoRobots(ClockKind kind) {
    const TestbedDesign bench = nominal_bench();
    camera_rsi = std::make_unique<rsi::Client>(client_of(bench, kCameraRobot));
    target_rsi = std::make_unique<rsi::Client>(client_of(bench, kTargetRobot));
    ControllerSettings camera_settings = camera_robot(camera_rsi->port());
    ControllerSettings target_settings{"target robot", bench.target_robot, std::nullopt,
                                       robot_files(kTargetRobot).ethernet, robot_files(kTargetRobot).context};
    target_settings.ethernet.address = "127.0.0.1";
    target_settings.ethernet.port = target_rsi->port();
    target_settings.flange_pose = flange_of;
    // No test depends on the speed of the machine.
    if (kind == ClockKind::kReal)
      camera_settings.context.timeout_cycles = target_settings.context.timeout_cycles = 100'000;
    camera = std::make_unique<Controller>(context_, camera_settings);
    target = std::make_unique<Controller>(context_, target_settings);
    clock = std::make_unique<CycleClock>(context_, ClockSettings{kind, std::chrono::minutes(1), true},
                                         std::vector<Controller*>{camera.get(), target.get()});
    clock->start();
    thread_ = std::thread([this] { context_.run(); });
  }
  ~TwoRobots() { stop(); }
  TwoRobots(const TwoRobots&) = delete;
  TwoRobots& operator=(const TwoRobots&) = delete;

  /// Runs `function` in the emulator's thread, and waits for it.
  void in_emulator(const std::function<void()>& function) {
    boost::asio::post(context_, boost::asio::use_future(function)).get();
  }
  void stop() {
    context_.stop();
    if (thread_.joinable()) thread_.join();
  }

  [[nodiscard]] static eki::ClientSettings eki_of(const Controller& controller) {
    return {controller.settings().name, controller.settings().robot.line.address, controller.eki_port(), kPatience,
            kPatience};
  }

 private:
  boost::asio::io_context context_;  // outlives what has sockets in it

 public:
  std::unique_ptr<rsi::Client> camera_rsi, target_rsi;
  std::unique_ptr<Controller> camera, target;
  std::unique_ptr<CycleClock> clock;

 private:
  static rsi::ClientSettings client_of(const TestbedDesign& bench, const char* name) {
    const bool is_camera = std::string_view(name) == kCameraRobot;
    rsi::ClientSettings settings = rsi::client_settings(name, is_camera ? bench.camera_robot : bench.target_robot,
                                                        is_camera ? &bench.track : nullptr, robot_files(name));
    settings.port = 0;
    return settings;
  }

  std::thread thread_;
};

TEST(CycleClock, BothRobotsMoveInStepOnTheVirtualClock) {
  TwoRobots bench(ClockKind::kVirtual);
  eki::Client camera_eki(TwoRobots::eki_of(*bench.camera)), target_eki(TwoRobots::eki_of(*bench.target));
  EXPECT_FALSE(camera_eki.last_state().rsi_on);
  EXPECT_TRUE(camera_eki.start().rsi_on);
  EXPECT_TRUE(target_eki.start().rsi_on);
  constexpr int kCycles = 500;
  for (int k = 1; k <= kCycles; ++k) {
    const auto camera = bench.camera_rsi->receive(kPatience);
    const auto target = bench.target_rsi->receive(kPatience);
    ASSERT_TRUE(camera && target);
    EXPECT_EQ(0U, camera->delay);
    EXPECT_EQ(static_cast<std::uint64_t>(k - 1), camera->cycle);
    const double way = 0.5 * (1.0 - std::cos(3.14159265358979 * std::min(k, 400) / 400.0));
    rsi::AxisPositions camera_command = bench.camera_rsi->zero(), target_command = bench.target_rsi->zero();
    camera_command.axes_rad[0] += 0.3 * way;
    camera_command.track_m -= 0.05 * way;
    target_command.axes_rad[5] += 0.4 * way;
    bench.camera_rsi->answer(camera_command);
    bench.target_rsi->answer(target_command);
  }
  const auto camera = bench.camera_rsi->receive(kPatience);
  const auto target = bench.target_rsi->receive(kPatience);
  ASSERT_TRUE(camera && target);
  EXPECT_NEAR(0.3, camera->measured.axes_rad[0], 1e-6);
  EXPECT_NEAR(-0.05, camera->measured.track_m, 1e-7);
  EXPECT_NEAR(0.4, target->measured.axes_rad[5], 1e-6);
  // No answer arrives: bench time stands still, and Ethernet KRL works.
  const eki::RobotState pose = camera_eki.pose();
  EXPECT_NEAR(0.3 * rsi::kDegreesPerRadian, pose.axes_deg[0], 1e-4);
  EXPECT_NEAR(-50.0, pose.track_mm, 1e-4);
  EXPECT_EQ(pose.time_ms, camera_eki.pose().time_ms);
  bench.stop();
  EXPECT_EQ(static_cast<std::uint64_t>(kCycles), bench.camera->statistics().answers);
  EXPECT_EQ(static_cast<std::uint64_t>(kCycles), bench.target->statistics().answers);
  for (const Controller* controller : {bench.camera.get(), bench.target.get()}) {
    EXPECT_EQ(0U, controller->statistics().cycles_without_answer);
    EXPECT_EQ(0U, controller->statistics().clamps);
    EXPECT_EQ(0U, controller->statistics().limit_trips);
  }
}

TEST(CycleClock, ARobotWithoutRsiDoesNotHoldTheOther) {
  TwoRobots bench(ClockKind::kVirtual);
  eki::Client camera_eki(TwoRobots::eki_of(*bench.camera)), target_eki(TwoRobots::eki_of(*bench.target));
  (void)camera_eki.start();
  for (int k = 0; k < 50; ++k) {
    ASSERT_TRUE(bench.camera_rsi->receive(kPatience));
    bench.camera_rsi->answer(bench.camera_rsi->zero());
  }
  // The other one joins the cycle that waits.
  ASSERT_TRUE(bench.camera_rsi->receive(kPatience));
  (void)target_eki.start();
  for (int k = 0; k < 50; ++k) {
    const auto target = bench.target_rsi->receive(kPatience);
    ASSERT_TRUE(target);
    EXPECT_EQ(0U, target->delay);
    bench.target_rsi->answer(bench.target_rsi->zero());
    bench.camera_rsi->answer(bench.camera_rsi->zero());
    ASSERT_TRUE(bench.camera_rsi->receive(kPatience));
  }
  EXPECT_FALSE(camera_eki.stop().rsi_on);
  // The clock waits for one answer only, and the camera's robot is not asked any more.
  for (int k = 0; k < 50; ++k) {
    ASSERT_TRUE(bench.target_rsi->receive(kPatience));
    bench.target_rsi->answer(bench.target_rsi->zero());
  }
  EXPECT_FALSE(bench.camera_rsi->receive(0ms));
}

TEST(CycleClock, FunctionsOfACycleRunBeforeAndAfterTheMotion) {
  OneRobot bench;
  std::vector<std::string> order;
  bench.clock.before_cycle([&](std::uint64_t cycle) {
    order.push_back("before " + std::to_string(cycle) + ": " +
                    std::to_string(std::lround(bench.controller.position().axes_rad[3] * 1e6)));
  });
  bench.clock.after_motion([&](std::uint64_t cycle) {
    order.push_back("after " + std::to_string(cycle) +
                    (bench.controller.position().axes_rad[3] > 0.0 ? ": moved" : ": at rest"));
    EXPECT_EQ("", bench.computer.receive());  // the state of the cycle is not sent yet
  });
  (void)bench.command(eki::Action::kStart);
  const std::uint64_t start = bench.clock.cycle();
  rsi::Sen sen = bench.answer_to(bench.receive());
  sen.axes_deg[3] = 0.01;
  bench.send(sen);
  bench.finish_cycle();
  const std::string next = std::to_string(start + 1);
  ASSERT_EQ(2U, order.size());
  EXPECT_EQ("before " + next + ": 0", order[0]);
  EXPECT_EQ("after " + next + ": moved", order[1]);
}

TEST(EthernetXml, DriverAndEmulatorUseTheNamesOfTheFile) {
  ControllerSettings settings = camera_robot(0);
  settings.ethernet.sen_type = "ImFree";
  settings.ethernet.axis_element = "AKorr";
  settings.ethernet.track_element = "EKorr";
  settings.ethernet.stop_element = "Halt";
  const TestbedDesign bench_file = nominal_bench();
  rsi::RobotFiles files{settings.ethernet, settings.context};
  rsi::ClientSettings client_settings =
      rsi::client_settings("camera robot", bench_file.camera_robot, &bench_file.track, files);
  client_settings.port = 0;
  rsi::Client client(client_settings);
  OneRobot bench(settings, client.port());
  (void)bench.command(eki::Action::kStart);
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(client.receive(kPatience));
    rsi::AxisPositions command = client.last_command();
    command.axes_rad[3] += 1e-4;
    command.track_m += 1e-6;
    client.answer(command);
    bench.finish_cycle();
  }
  EXPECT_EQ(20U, bench.controller.statistics().answers);
  EXPECT_EQ("", bench.controller.statistics().last_bad_answer);
  EXPECT_GT(bench.controller.position().axes_rad[3], 1e-3);
  EXPECT_GT(bench.controller.position().track_m, 1e-5);
}

TEST(CycleClock, UnsolicitedStatesReachTheClient) {
  TwoRobots bench(ClockKind::kVirtual);
  eki::Client client(TwoRobots::eki_of(*bench.camera));
  (void)client.start();
  ASSERT_TRUE(bench.camera_rsi->receive(kPatience));
  bench.camera_rsi->answer_stop();
  while (client.unsolicited() == 0) client.poll();
  EXPECT_FALSE(client.last_state().rsi_on);
  EXPECT_EQ(0U, client.last_state().seq);
  EXPECT_EQ("RSI ended by the stop signal", client.last_state().message);
}

TEST(CycleClock, RunsInRealTime) {
  TwoRobots bench(ClockKind::kReal);
  eki::Client client(TwoRobots::eki_of(*bench.camera));
  (void)client.start();
  std::uint64_t cycles = 0;
  for (; cycles < 50; ++cycles) {
    ASSERT_TRUE(bench.camera_rsi->receive(kPatience));
    bench.camera_rsi->answer(bench.camera_rsi->zero());
  }
  EXPECT_EQ(50U, cycles);
  EXPECT_TRUE(client.status().rsi_on);
}

// TRON.md, section 8: RSI broken off: restarted once through Ethernet KRL, and on from the pose reported.
TEST(CycleClock, RsiThatBrokeOffIsRestartedWithoutAJump) {
  TwoRobots bench(ClockKind::kVirtual);
  eki::Client camera_eki(TwoRobots::eki_of(*bench.camera)), target_eki(TwoRobots::eki_of(*bench.target));
  (void)target_eki.start();
  (void)camera_eki.start();
  for (int k = 1; k <= 200; ++k) {
    // The target's state of a cycle is sent after the camera's: when it is here, so is the other.
    ASSERT_TRUE(bench.camera_rsi->receive(kPatience));
    rsi::AxisPositions command = bench.camera_rsi->last_command();
    command.axes_rad[3] += 2e-5 * std::min(k, 100);  // up to 0.5 rad/s
    bench.camera_rsi->answer(command);
    ASSERT_TRUE(bench.target_rsi->receive(kPatience));
    bench.target_rsi->answer(bench.target_rsi->last_command());
  }
  bench.in_emulator([&] { bench.camera->drop_rsi(); });
  while (camera_eki.last_state().rsi_on) camera_eki.poll();
  EXPECT_EQ("RSIBad: the connection is interrupted", camera_eki.last_state().message);
  // The arm brakes while the other robot takes answers; until then RSI does not start.
  EXPECT_EQ("start refused: not acknowledged: RSIBad: the connection is interrupted", camera_eki.start().message);
  EXPECT_FALSE(camera_eki.reset().stopped);
  EXPECT_EQ("start refused: the axes move", camera_eki.start().message);
  for (int k = 0; k < 100; ++k) {
    // A state of the camera's robot may have come before RSI broke off: to hold still at full speed would be refused.
    ASSERT_TRUE(bench.target_rsi->receive(kPatience));
    bench.target_rsi->answer(bench.target_rsi->last_command());
  }
  AxisPositions before;
  bench.in_emulator([&] { before = bench.camera->position(); });
  bench.camera_rsi->restart();
  EXPECT_TRUE(camera_eki.start().rsi_on);
  const auto first = bench.camera_rsi->receive(kPatience);
  ASSERT_TRUE(first);
  EXPECT_EQ(0U, first->cycle);
  EXPECT_LT((bench.camera_rsi->zero().axes_rad - before.axes_rad).norm(), 1e-6);
  bench.camera_rsi->answer(bench.camera_rsi->zero());
  ASSERT_TRUE(bench.target_rsi->receive(kPatience));
  bench.target_rsi->answer(bench.target_rsi->last_command());
  for (int k = 0; k < 50; ++k) {
    ASSERT_TRUE(bench.camera_rsi->receive(kPatience));
    ASSERT_TRUE(bench.target_rsi->receive(kPatience));
    bench.camera_rsi->answer(bench.camera_rsi->zero());
    bench.target_rsi->answer(bench.target_rsi->last_command());
  }
  bench.in_emulator([&] {
    // Rounding to four decimals of a degree, and nothing else.
    EXPECT_LT((bench.camera->position().axes_rad - before.axes_rad).norm(), 1e-6);
    EXPECT_EQ(0U, bench.camera->statistics().limit_trips);
  });
}

TEST(EkiServer, HostileBytesCloseTheLineAndASecondClientIsRefused) {
  TwoRobots bench(ClockKind::kVirtual);
  const eki::ClientSettings address = TwoRobots::eki_of(*bench.camera);
  boost::asio::io_context context;
  const boost::asio::ip::tcp::endpoint server(boost::asio::ip::make_address_v4(address.host), address.port);
  char byte = 0;
  boost::system::error_code error;
  {
    boost::asio::ip::tcp::socket hostile(context);
    hostile.connect(server);
    boost::asio::write(hostile, boost::asio::buffer(std::string("GET / HTTP/1.1\r\n")));
    (void)hostile.read_some(boost::asio::buffer(&byte, 1), error);
    EXPECT_TRUE(error);
  }
  eki::Client client(address);
  boost::asio::ip::tcp::socket second(context);
  second.connect(server);
  (void)second.read_some(boost::asio::buffer(&byte, 1), error);
  EXPECT_TRUE(error);
  EXPECT_TRUE(client.status().drives_powered);
}

}  // namespace
}  // namespace vbar::tron::bench
