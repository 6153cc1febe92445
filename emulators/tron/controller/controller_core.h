#pragma once
// Program and drives of an emulated controller, cycle by cycle. Used by the controller's own files only.

#include <string>

#include "emulators/tron/controller/axis_servo.h"
#include "emulators/tron/controller/controller.h"
#include "emulators/tron/controller/controller_links.h"

namespace vbar::tron::bench {

struct Controller::Core {
  Core(boost::asio::io_context& context, ControllerSettings given);

  // ---- a cycle, called by the clock
  /// Processes the answer to the last state, and moves the axes.
  void move();
  /// Sends the state of this cycle to the computer, once, if RSI is on.
  void send_state();

  // ---- Ethernet KRL
  eki::Reply handle(const eki::Command& command);
  [[nodiscard]] eki::State state() const;
  [[nodiscard]] eki::RobotState pose() const;
  /// Sends the state, unsolicited, if it has changed.
  void announce();

  // ---- program
  /// Returns why RSI cannot be started, or empty.
  [[nodiscard]] std::string start_problem() const;
  void start_rsi();
  void end_rsi();
  /// Ends RSI with a message that has to be acknowledged.
  void stop_with(const std::string& text);
  void trip(const std::string& text);
  [[nodiscard]] std::string reset();
  [[nodiscard]] const AxisPositions& reported() const { return is_frozen ? frozen : measured; }

  ControllerSettings settings;
  Servo servo;
  AxisMonitor monitor;
  Correction correction;
  RsiLink link;
  EkiServer server;
  ControllerStatistics statistics;
  std::function<AxisPositions()> on_standstill;
  std::function<void()> on_datagram;   ///< callback of the clock
  std::function<void()> on_rsi_start;  ///< callback of the clock

  std::uint64_t cycles = 0;  ///< since the program began
  std::uint64_t ipoc;
  std::uint64_t silent_cycles = 0, lost_answers = 0, delay = 0;
  int cycles_since_answer = 1, missing_in_row = 0;
  bool rsi_on = false, drives_on = true, emergency_stop = false, stopped = false, stood = true;
  bool sent_in_cycle = false;
  bool is_first_cycle = false;  ///< RSI was switched on and has sent nothing yet
  /// Place at which RSI was switched on: corrections do not move the programmed set point (RSol, ASPos).
  rsi::SixValues cartesian_setpoint{}, axes_setpoint_deg{};
  std::string message;
  bool is_frozen = false;
  AxisPositions measured, frozen, standstill_error;
  eki::State announced;

 private:
  void take_answer();
  void count_answer(bool is_valid);
  void follow(bool has_answer);
  void notice_standstill();
  [[nodiscard]] rsi::Rob rob() const;
};

}  // namespace vbar::tron::bench
