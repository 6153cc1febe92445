// The bench as its driver meets it: a process behind wire protocols.

#include "tests/unit/emulators/tron/process/bench_process.h"

#include <gmock/gmock.h>

namespace vbar::tron::bench {
namespace {

using test::kPatience;
using test::TwoRobots;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;

constexpr double kDegree = std::numbers::pi / 180.0;

using TronBench = test::BenchProcessTest;

TEST_F(TronBench, ListsItsAddressesAndRemovesThemAtTheEnd) {
  TwoRobots robots;
  ASSERT_NO_FATAL_FAILURE(start(robots));
  EXPECT_EQ(addresses.at("clock"), "virtual");
  EXPECT_EQ(addresses.at("camera_robot").at("rsi_port"), robots.camera().port());
  EXPECT_EQ(addresses.at("target_robot").at("rsi_port"), robots.target().port());
  EXPECT_THAT(addresses.at("camera").get<std::string>(), HasSubstr("127.0.21."));
  end();
  EXPECT_FALSE(test::fs::exists(directory.path() / "addresses.json"));
  EXPECT_FALSE(test::fs::exists(directory.path() / "control.sock"));
}

TEST_F(TronBench, AJointMovesWhereItIsCommandedAndEkiSaysSo) {
  TwoRobots robots;
  ASSERT_NO_FATAL_FAILURE(start(robots));
  ASSERT_NO_FATAL_FAILURE(robots.open(addresses));
  const double begin = robots.camera_state.measured.axes_rad[4];
  ASSERT_NO_FATAL_FAILURE(robots.move(200, 4, 20.0 * kDegree, 0, -5.0 * kDegree));
  ASSERT_NO_FATAL_FAILURE(robots.hold(50));
  EXPECT_NEAR(robots.camera_state.measured.axes_rad[4] - begin, 20.0 * kDegree, 1e-6);
  const eki::RobotState pose = robots.camera_eki().pose();
  EXPECT_NEAR(pose.axes_deg[4], 20.0, 1e-3);
  // Home is [0, -120, 120, 0, 0, 0] deg: the forearm is level, the flange 25 - 560/2 + 35*0 + 515 ... mm ahead.
  const double wrist_x = 25.0 + 560.0 * std::cos(120.0 * kDegree) + 515.0;
  EXPECT_NEAR(pose.cartesian[0], wrist_x + 80.0 * std::cos(20.0 * kDegree), 1e-2);
  EXPECT_NEAR(robots.target_eki().pose().axes_deg[0], -5.0, 1e-3);
  end();
  const auto summary = nlohmann::json::parse(text_of("summary.json"));
  for (const char* robot : {"camera_robot", "target_robot"}) {
    EXPECT_EQ(summary.at(robot).at("late_answers"), 0) << robot;
    EXPECT_EQ(summary.at(robot).at("clamps"), 0) << robot;
    EXPECT_EQ(summary.at(robot).at("limit_trips"), 0) << robot;
  }
  // Peak speed of the step: 1.875 of the mean; A5 turns up to 311 deg/s.
  EXPECT_NEAR(summary.at("camera_robot").at("max_speed_ratio").at(4).get<double>(), 1.875 * 20.0 / 0.8 / 311.0, 1e-3);
}

TEST_F(TronBench, AnEmergencyStopFromAFileStopsTheRobotAndIsAcknowledged) {
  const std::string faults = directory.path() / "faults_given.jsonl";
  std::ofstream(faults) << R"({"kind": "emergency_stop", "robot": "target", "at_cycle": 40, "duration_s": 0.2})"
                        << "\n";
  TwoRobots robots;
  ASSERT_NO_FATAL_FAILURE(start(robots, {"--faults", faults, "--set", "clock.patience_s=0.2"}));
  ASSERT_NO_FATAL_FAILURE(robots.open(addresses));
  for (int cycle = 0; cycle < 38; ++cycle) {
    robots.answer(robots.camera().last_command(), robots.target().last_command());
    ASSERT_NO_FATAL_FAILURE(robots.receive());
  }
  for (int tries = 0; tries < 3 && !robots.target_eki().last_state().emergency_stop; ++tries) {
    robots.camera().answer(robots.camera().last_command());
    if (tries == 0) robots.target().answer(robots.target().last_command());
    ASSERT_TRUE(robots.camera().receive(kPatience));
    (void)robots.target_eki().status();
  }
  EXPECT_TRUE(robots.target_eki().last_state().emergency_stop);
  EXPECT_THAT(text_of("faults.jsonl"), HasSubstr(R"({"kind":"emergency_stop","image":0,"cycle":40,"robot":"target"})"));
  // Released after its time.
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (robots.target_eki().status().emergency_stop && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(robots.target_eki().last_state().emergency_stop);
  EXPECT_TRUE(robots.target_eki().reset().drives_powered);
}

TEST_F(TronBench, ControlLineMountsInjectsAndRefuses) {
  TwoRobots robots;
  ASSERT_NO_FATAL_FAILURE(start(robots));
  EXPECT_EQ(control(R"({"do": "mount", "what": "board"})"), R"({"mounted":"board"})");
  EXPECT_THAT(control(R"({"do": "mount", "what": "chair"})"), HasSubstr("error"));
  EXPECT_THAT(control(R"({"do": "dance"})"), HasSubstr("error"));
  EXPECT_THAT(control("nothing"), HasSubstr("error"));
  EXPECT_EQ(control(R"({"kind": "drives_off", "robot": "camera"})"),
            R"({"injected":{"kind":"drives_off","image":0,"cycle":0,"robot":"camera"}})");
  EXPECT_EQ(nlohmann::json::parse(control(R"({"do": "summary"})")).at("images"), 0);
}

TEST_F(TronBench, BenchExitEndsItAtOnceWithItsOwnCode) {
  TwoRobots robots;
  ASSERT_NO_FATAL_FAILURE(start(robots));
  (void)control(R"({"kind": "bench_exit"})");
  ASSERT_TRUE(process->wait_for_end(kPatience));
  EXPECT_EQ(process->status_text(), "exit status 3");
  EXPECT_THAT(text_of("faults.jsonl"), HasSubstr("bench_exit"));
}

TEST_F(TronBench, AWrongFileIsOneErrorWithItsPlace) {
  TwoRobots robots;
  process.emplace(std::vector<std::string>{tests::build_path("vbar_tron_bench"),
                                           (mission::data_directory() / "benches/tron.toml").string(), "--directory",
                                           directory.path().string()},
                  std::vector<io::FileDescriptor>{});
  ASSERT_TRUE(process->wait_for_end(kPatience));
  EXPECT_EQ(process->status_text(), "exit status 2");
  EXPECT_THAT(process->output_tail(), HasSubstr("tron.toml"));
}

}  // namespace
}  // namespace vbar::tron::bench
