#pragma once
// A controller, its clock and the computer's ends of its lines in one thread: the event loop runs when the test lets
// it, so nothing depends on the speed of the machine.

#include <string>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

#include "emulators/tron/controller/controller.h"
#include "emulators/tron/controller/cycle_clock.h"
#include "hil_drivers/tron/geometry/testbed_design.h"
#include "hil_drivers/tron/protocols/rsi_messages.h"
#include "hil_drivers/tron/robot/robot_files.h"
#include "host_sim/mission/data_file.h"

namespace vbar::tron::bench {

/// Any function of the axes will do where kinematics are not the subject.
inline CartesianPose flange_of(const AxisPositions& positions) {
  return {positions.track_m, positions.axes_rad[0], 0.0, 1.0, 2.0, 3.0};
}

inline TestbedDesign nominal_bench() {
  return read_testbed_design(mission::data_directory() / "benches" / "tron.toml");
}

inline ControllerSettings camera_robot(std::uint16_t rsi_port) {
  const TestbedDesign bench = nominal_bench();
  const rsi::RobotFiles files = robot_files(kCameraRobot);
  ControllerSettings settings{"camera robot", bench.camera_robot, bench.track, files.ethernet, files.context};
  settings.ethernet.address = "127.0.0.1";
  settings.ethernet.port = rsi_port;
  settings.first_ipoc = 123456;
  settings.flange_pose = flange_of;
  return settings;
}

/// The computer's socket without a client's checks.
class RawComputer {
 public:
  RawComputer() : socket_(context_, {boost::asio::ip::address_v4::loopback(), 0}) { socket_.non_blocking(true); }
  [[nodiscard]] std::uint16_t port() const { return socket_.local_endpoint().port(); }
  /// The next datagram, or empty.
  std::string receive() {
    boost::system::error_code error;
    std::string text(65536, '\0');
    text.resize(socket_.receive_from(boost::asio::buffer(text), robot_, 0, error));
    return error ? "" : text;
  }
  void send(const std::string& text) { socket_.send_to(boost::asio::buffer(text), robot_); }
  [[nodiscard]] auto robot() const { return robot_; }

 private:
  boost::asio::io_context context_;
  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint robot_;
};

/// One robot on the virtual clock, which waits `kPatience` for a cycle without a valid answer.
class OneRobot {
 public:
  inline static constexpr std::chrono::milliseconds kPatience{1};

  explicit OneRobot(ControllerSettings settings, std::uint16_t computer_port = 0)
      : settings_(with_port(std::move(settings), computer_port == 0 ? computer.port() : computer_port)),
        controller(context, settings_),
        clock(context, {ClockKind::kVirtual, kPatience, false}, {&controller}),
        decoder_(settings_.ethernet) {
    clock.start();
  }
  OneRobot() : OneRobot(camera_robot(0)) {}

  eki::State command(eki::Action action) { return std::get<eki::State>(controller.execute({1, action})); }

  /// Lets the event loop run until bench time has reached `cycle`.
  void run_to(std::uint64_t cycle) {
    while (clock.cycle() < cycle) context.run_one();
  }
  /// The state of the cycle; waits for it.
  rsi::Rob receive() {
    rsi::Rob rob;
    last_text = computer.receive();
    for (; last_text.empty(); last_text = computer.receive()) context.run_one();
    is_readable = decoder_.decode(last_text, rob);
    return rob;
  }
  /// States without an answer.
  void discard() {
    while (!computer.receive().empty()) {
    }
  }
  [[nodiscard]] rsi::Sen answer_to(const rsi::Rob& rob) const {
    rsi::Sen sen;
    sen.type = settings_.ethernet.sen_type;
    sen.ipoc = rob.ipoc.text;
    sen.stop = false;
    for (auto& axis : sen.axes_deg) axis = 0.0;
    sen.track_mm = 0.0;
    return sen;
  }
  [[nodiscard]] std::string text_of(const rsi::Sen& sen) const {
    std::string text;
    return rsi::encode(sen, settings_.ethernet, text) ? text : "";
  }
  void send(const rsi::Sen& sen) { computer.send(text_of(sen)); }
  /// Runs until the cycle in progress is over.
  void finish_cycle() { run_to(clock.cycle() + 1); }

  RawComputer computer;
  boost::asio::io_context context;

 private:
  static ControllerSettings with_port(ControllerSettings settings, std::uint16_t port) {
    settings.ethernet.port = port;
    return settings;
  }
  ControllerSettings settings_;

 public:
  Controller controller;
  CycleClock clock;
  std::string last_text;
  bool is_readable = false;

 private:
  rsi::Decoder decoder_;
};

}  // namespace vbar::tron::bench
