#pragma once
// Both robots, driven cycle by cycle through RSI, their states through Ethernet KRL. There is no wall clock in the
// control path: a cycle lasts from the answers to the next states. With the virtual clock of an emulator time
// stands still between the calls; with a real one a thread holds the arms where they are.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "hil_drivers/tron/geometry/kinematics.h"
#include "hil_drivers/tron/geometry/testbed_design.h"
#include "hil_drivers/tron/protocols/eki.h"
#include "hil_drivers/tron/protocols/rsi_client.h"

namespace vbar::tron {

struct RobotPairSettings {
  rsi::ClientSettings camera_rsi, target_rsi;
  eki::ClientSettings camera_eki, target_eki;  ///< host and port may be set later, before open()
  double track_home_m = 0.0;
  bool is_virtual = true;                           ///< the clock of the testbed
  std::chrono::milliseconds start_patience{5000};   ///< wall clock, for the first state after RSI was started
  std::chrono::milliseconds silence_patience{500};  ///< silence in a cycle; virtual clock: 20 times as much
  double settle_limit_s = 5.0;                      ///< bench time
  double operator_timeout_s = 600.0;                ///< bench time
  /// Called after each cycle with their number, also by the thread that holds the arms.
  std::function<void(std::uint64_t cycles)> on_cycle = {};
};

struct RobotPairCounts {
  std::uint64_t cycles = 0;
  std::uint64_t interruptions = 0;
  std::uint64_t rsi_restarts = 0;
  std::uint64_t unreadable_datagrams = 0, foreign_datagrams = 0, skipped_states = 0;
  std::uint64_t delay_max = 0;  ///< Delay of the controllers
};

class RobotPair {
 public:
  /// Listens for RSI. Throws std::runtime_error.
  explicit RobotPair(const RobotPairSettings& settings);
  ~RobotPair();
  RobotPair(const RobotPair&) = delete;
  RobotPair& operator=(const RobotPair&) = delete;

  [[nodiscard]] std::uint16_t camera_rsi_port() const;
  [[nodiscard]] std::uint16_t target_rsi_port() const;

  /// Connects to both controllers and starts RSI. Throws std::runtime_error: device, address and what was expected.
  void open(const eki::ClientSettings& camera_eki, const eki::ClientSettings& target_eki, bool is_virtual);
  /// Ends RSI and closes the lines.
  void close() noexcept;

  /// Returns the posture as the controllers stated it in the last cycle.
  [[nodiscard]] Posture posture() const;
  /// Returns the posture that was commanded last.
  [[nodiscard]] Posture command() const;

  /// Follows the motion and waits until the arms have settled. Throws std::runtime_error if they do not settle.
  MotionEnd follow(const Motion& motion);
  /// Holds the arms for a number of cycles.
  MotionEnd hold(int cycles);
  /// Recovers after kInterrupted: after kInterrupted: waits until emergency stops are cleared, resets and starts what
  /// has stopped. `report` gets a sentence for the operator. Throws std::runtime_error after the operator's time-out.
  void recover(const std::function<void(const std::string&)>& report);
  /// Returns the posture at rest, through Ethernet KRL.
  [[nodiscard]] Posture rest_posture();

  /// Cancels from another thread: calls return kInterrupted or throw without delay, and wait for nothing.
  void cancel() noexcept;

  [[nodiscard]] double time_s() const;  ///< bench time since open(), 4 ms a cycle
  [[nodiscard]] RobotPairCounts counts() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace vbar::tron
