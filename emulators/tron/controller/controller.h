#pragma once
// An emulated KUKA controller of one robot: RSI (client of UDP, owner of the IPOC, strict about answers), Ethernet KRL
// (server of TCP), drives, limits, stop states. It is driven by a CycleClock.
//
// An answer counts if it arrives in its cycle, decodes, has the configured Type and the text of the IPOC sent. In a
// cycle without such an answer Delay rises by one and the values hold (HOLDON 1) or fall to zero; `Timeout` such cycles
// in a row end RSI. Corrections are absolute to the pose commanded at RSI_ON; they are clamped silently at the limits
// of the context, and the overall monitor ends RSI (KSS29000). A command beyond a software limit, or above the speed or
// acceleration of an axis, switches the drives off. Speed and acceleration are judged on successive valid answers; over
// a gap only the mean speed is, for at most three cycles.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>

#include "emulators/tron/controller/axis_servo.h"
#include "hil_drivers/tron/geometry/testbed_design.h"
#include "hil_drivers/tron/protocols/eki.h"
#include "hil_drivers/tron/protocols/rsi_messages.h"

namespace vbar::tron::bench {

/// Flange in the robot's base as KUKA gives it: X Y Z in mm, A B C in deg (about z, y', x'').
using CartesianPose = std::array<double, 6>;

struct ControllerSettings {
  std::string name;            ///< "camera robot"
  Robot robot;                 ///< limits, home, address
  std::optional<Track> track;  ///< track that carries the robot; none: it stands
  rsi::EthernetXml ethernet;   ///< address and port of the computer included
  rsi::ContextXml context;
  std::uint64_t first_ipoc = 1;  ///< time stamp of the first cycle; + 4 each
  std::uint16_t eki_port = 0;    ///< on robot.line.address; 0: any free one
  /// Computes forward kinematics as the controller has them; required.
  std::function<CartesianPose(const AxisPositions&)> flange_pose = {};
};

struct ControllerStatistics {
  std::uint64_t cycles = 0;   ///< with RSI on
  std::uint64_t answers = 0;  ///< valid ones
  std::uint64_t cycles_without_answer = 0;
  std::uint64_t bad_answers = 0;       ///< datagrams that did not count: broken, wrong Type or IPOC
  std::uint64_t repeated_answers = 0;  ///< further datagrams with the IPOC of a cycle that was answered
  std::uint64_t clamps = 0;            ///< cycles in which a correction was clamped
  std::uint64_t limit_trips = 0;       ///< speed, acceleration, software limit
  std::uint64_t rsi_starts = 0;
  AxisArray max_speed{}, max_acceleration{};  ///< commanded by valid answers: rad/s, rad/s2 (m)
  std::uint64_t answers_within_1ms = 0;       ///< answers within 1 ms of wall clock since the request
  double max_answer_time_s = 0.0;
  std::string last_bad_answer;  ///< why it did not count
};

class Controller {
 public:
  /// Begins at home with the drives on. Throws std::runtime_error if an address is not available.
  Controller(boost::asio::io_context& context, ControllerSettings settings);
  ~Controller();
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;

  // ---- for the world
  /// Returns the position as the motors measure it (AIPos, EIPos); of a frozen controller the real place.
  [[nodiscard]] AxisPositions position() const;
  /// Returns position() with the errors of the last standstill: where the axes really are.
  [[nodiscard]] AxisPositions true_position() const;
  /// Registers the call at a standstill of the axes; it returns the repeatability errors that hold until the next one.
  void on_standstill(std::function<AxisPositions()> errors);
  [[nodiscard]] bool stands() const;

  // ---- faults
  void set_emergency_stop(bool is_pressed);
  void switch_drives_off(const std::string& message);
  /// Freezes AIPos and EIPos: they keep their values while the arm moves.
  void set_frozen(bool is_frozen);
  /// Sends nothing for this number of cycles, or until RSI is started again.
  void be_silent(std::uint64_t cycles);
  /// Loses the answers to this number of cycles, or until RSI is started again.
  void lose_answers(std::uint64_t cycles);
  void set_ipoc_back(std::uint64_t milliseconds);
  /// Breaks RSI off.
  void drop_rsi();

  /// Executes a command as from Ethernet KRL, of the operator at the controller.
  eki::Reply execute(const eki::Command& command);

  // ---- state
  [[nodiscard]] bool rsi_is_on() const;
  [[nodiscard]] eki::State state() const;
  [[nodiscard]] std::uint16_t eki_port() const;
  [[nodiscard]] const ControllerStatistics& statistics() const;
  [[nodiscard]] const ControllerSettings& settings() const;

 private:
  friend class CycleClock;
  struct Core;
  std::unique_ptr<Core> core_;
};

}  // namespace vbar::tron::bench
