#pragma once
// vbar_tron_bench as a process, and a driver of its robots.

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "hil_drivers/tron/geometry/testbed_design.h"
#include "hil_drivers/tron/protocols/eki.h"
#include "hil_drivers/tron/protocols/rsi_client.h"
#include "hil_drivers/tron/robot/robot_files.h"
#include "host_sim/io/child_process.h"
#include "host_sim/mission/data_file.h"
#include "tests/support/paths.h"

namespace vbar::tron::bench::test {

namespace fs = std::filesystem;

inline constexpr std::chrono::seconds kPatience{120};

class TestDirectory {
 public:
  TestDirectory() : path_(fs::path(testing::TempDir()) / ("vbar_tron_bench_" + std::to_string(::getpid()))) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~TestDirectory() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TestDirectory(const TestDirectory&) = delete;
  TestDirectory& operator=(const TestDirectory&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Both robots of a bench, answered in step.
class TwoRobots {
 public:
  TwoRobots()
      : laboratory_(read_testbed_design(mission::data_directory() / "benches" / "tron.toml")),
        camera_(settings_of("camera robot", kCameraRobot, laboratory_.camera_robot, &laboratory_.track)),
        target_(settings_of("target robot", kTargetRobot, laboratory_.target_robot, nullptr)) {}

  [[nodiscard]] rsi::Client& camera() { return camera_; }
  [[nodiscard]] rsi::Client& target() { return target_; }
  [[nodiscard]] eki::Client& camera_eki() { return *camera_eki_; }
  [[nodiscard]] eki::Client& target_eki() { return *target_eki_; }

  void open(const nlohmann::json& addresses) {
    camera_eki_.emplace(eki_settings("camera robot", addresses.at("camera_robot").at("eki")));
    target_eki_.emplace(eki_settings("target robot", addresses.at("target_robot").at("eki")));
    ASSERT_TRUE(camera_eki_->start().rsi_on);
    ASSERT_TRUE(target_eki_->start().rsi_on);
    ASSERT_NO_FATAL_FAILURE(receive());
  }

  /// Waits for the states of a cycle.
  void receive() {
    const auto camera = camera_.receive(kPatience), target = target_.receive(kPatience);
    ASSERT_TRUE(camera && target);
    camera_state = *camera;
    target_state = *target;
  }

  /// A smooth step of one axis of each robot (A1 to A6: 0 to 5; the track: 6).
  void move(int cycles, std::size_t camera_axis, double camera_by, std::size_t target_axis, double target_by) {
    move_to(cycles, moved(camera_.last_command(), camera_axis, camera_by),
            moved(target_.last_command(), target_axis, target_by));
  }
  /// All axes, from rest to rest.
  void move_to(int cycles, const rsi::AxisPositions& camera, const rsi::AxisPositions& target) {
    const rsi::AxisPositions camera_begin = camera_.last_command(), target_begin = target_.last_command();
    for (int cycle = 1; cycle <= cycles; ++cycle) {
      const double x = static_cast<double>(cycle) / cycles;
      const double step = x * x * x * (10.0 + x * (6.0 * x - 15.0));
      answer(between(camera_begin, camera, step), between(target_begin, target, step));
      ASSERT_NO_FATAL_FAILURE(receive());
    }
  }
  void hold(int cycles) { move(cycles, 0, 0.0, 0, 0.0); }
  void answer(const rsi::AxisPositions& camera, const rsi::AxisPositions& target) {
    camera_.answer(camera);
    target_.answer(target);
  }

  rsi::State camera_state, target_state;

 private:
  static rsi::ClientSettings settings_of(const std::string& name, const char* files, const Robot& robot,
                                         const Track* track) {
    rsi::ClientSettings settings = rsi::client_settings(name, robot, track, robot_files(files));
    settings.port = 0;
    return settings;
  }
  static eki::ClientSettings eki_settings(const std::string& name, const std::string& address) {
    eki::ClientSettings settings;
    settings.name = name;
    settings.host = address.substr(0, address.find(':'));
    settings.port = static_cast<std::uint16_t>(std::stoi(address.substr(address.find(':') + 1)));
    settings.connect_limit = settings.answer_limit = kPatience;
    return settings;
  }
  static rsi::AxisPositions between(const rsi::AxisPositions& from, const rsi::AxisPositions& to, double share) {
    return {from.axes_rad + share * (to.axes_rad - from.axes_rad), from.track_m + share * (to.track_m - from.track_m)};
  }
  static rsi::AxisPositions moved(rsi::AxisPositions from, std::size_t axis, double by) {
    if (axis < kJoints)
      from.axes_rad[static_cast<int>(axis)] += by;
    else
      from.track_m += by;
    return from;
  }

  TestbedDesign laboratory_;
  rsi::Client camera_, target_;
  std::optional<eki::Client> camera_eki_, target_eki_;
};

class BenchProcessTest : public ::testing::Test {
 protected:
  /// With the driver's ports and `more` arguments.
  void start(TwoRobots& robots, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{tests::build_path("vbar_tron_bench"),
                                       (mission::data_directory() / "benches/tron_emulated.toml").string(),
                                       "--directory",
                                       directory.path().string(),
                                       "--camera-rsi-port",
                                       std::to_string(robots.camera().port()),
                                       "--target-rsi-port",
                                       std::to_string(robots.target().port())};
    arguments.insert(arguments.end(), more.begin(), more.end());
    process.emplace(arguments, std::vector<io::FileDescriptor>{});
    const auto until = std::chrono::steady_clock::now() + kPatience;
    const fs::path file = directory.path() / "addresses.json";
    while (!fs::exists(file)) {
      ASSERT_TRUE(std::chrono::steady_clock::now() < until && !process->has_ended()) << process->output_tail();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    addresses = nlohmann::json::parse(std::ifstream(file));
  }
  void end() {
    process->terminate(kPatience);
    process.reset();
  }
  /// One line to the control socket, one line back.
  std::string control(const std::string& line) {
    const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string path = addresses.at("control").get<std::string>();
    path.copy(address.sun_path, sizeof(address.sun_path) - 1);
    EXPECT_EQ(::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    const std::string text = line + "\n";
    EXPECT_EQ(::write(socket, text.data(), text.size()), static_cast<ssize_t>(text.size()));
    std::string answer;
    for (char c = 0; ::read(socket, &c, 1) == 1 && c != '\n';) answer += c;
    ::close(socket);
    return answer;
  }
  [[nodiscard]] std::string text_of(const char* name) const {
    std::ifstream in(directory.path() / name);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }

  TestDirectory directory;
  std::optional<io::ChildProcess> process;
  nlohmann::json addresses;
};

}  // namespace vbar::tron::bench::test
