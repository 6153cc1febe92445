#pragma once
// Documents of KUKA's Ethernet KRL between the computer and a program of the robot (hil_drivers/tron/robot/*_eki.xml).
// TCP without length or terminator: a document ends with the closing tag of its root. Values as on the wire: degrees,
// millimetres, milliseconds.
//
//   <Command Seq="3" Do="start"/>                                                                      to the robot
//   <State Seq="3" T="1200" DrivesPowered="1" EmergencyStop="0" RsiOn="1" Stopped="0" Message=""/>     back; Seq 0:
//                                                                                            unsolicited, on a change
//   <RobotState Seq="4" T="1204"><Pos X="" Y="" Z="" A="" B="" C=""/><Axis A1="" ... A6="" E1=""/></RobotState>

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>

#include "hil_drivers/wire/bytes.h"
#include "host_sim/io/byte_channel.h"

namespace vbar::tron::eki {

using wire::WireError;

inline constexpr std::size_t kMaxDocumentBytes = 16384;  ///< BUFFSIZE of the controller

enum class Action { kStatus, kStart, kStop, kReset, kPose };
[[nodiscard]] std::string_view name_of(Action action);

struct Command {
  std::uint32_t seq = 0;  ///< above 0; the answer repeats it
  Action action = Action::kStatus;
  friend bool operator==(const Command&, const Command&) = default;
};

struct State {
  std::uint32_t seq = 0;  ///< 0: unsolicited
  std::uint64_t time_ms = 0;
  bool drives_powered = false;
  bool emergency_stop = false;
  bool rsi_on = false;
  bool stopped = false;  ///< by a message, which "reset" acknowledges
  std::string message;   ///< text of the controller; empty: none
  friend bool operator==(const State&, const State&) = default;
};

struct RobotState {
  std::uint32_t seq = 0;
  std::uint64_t time_ms = 0;
  std::array<double, 6> cartesian{};  ///< X Y Z in mm, A B C in deg, of the flange in the base
  std::array<double, 6> axes_deg{};
  double track_mm = 0.0;  ///< E1
  friend bool operator==(const RobotState&, const RobotState&) = default;
};

using Reply = std::variant<State, RobotState>;

[[nodiscard]] std::string encode(const Command& command);
[[nodiscard]] std::string encode(const State& state);
[[nodiscard]] std::string encode(const RobotState& state);

/// Decodes one document. Throws WireError: one sentence with what was found.
[[nodiscard]] Command decode_command(std::string_view document);
[[nodiscard]] Reply decode_reply(std::string_view document);

/// Cuts a stream into documents.
class DocumentBuffer {
 public:
  void append(std::string_view bytes) { buffer_ += bytes; }
  /// Returns the next complete document. Throws WireError for bytes that cannot begin or continue one (they are
  /// discarded), and for a document of more than kMaxDocumentBytes.
  std::optional<std::string> next();

 private:
  std::string buffer_;
};

// The computer's end of Ethernet KRL for one robot: status, start and stop of RSI, reset, achieved pose. One thread.
// Unsolicited states are kept when they arrive.

struct ClientSettings {
  std::string name;  ///< name of the device in messages: "camera robot"
  std::string host;
  std::uint16_t port = 54600;
  std::chrono::milliseconds connect_limit{5000};
  std::chrono::milliseconds answer_limit{5000};  ///< wall clock, of what never comes
};

/// States device, address and what was expected, in one sentence.
class EkiError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Client {
 public:
  /// Connects and asks for the state. Throws EkiError.
  explicit Client(const ClientSettings& settings);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  // Sends a command; every command returns the state after it, also if the controller has rejected it (then `message`
  // states why). All throw EkiError: the line is closed, no answer, or a document that cannot be read.

  State status() { return command(Action::kStatus); }
  /// Starts RSI: its datagrams begin at once, so the RSI client must listen.
  State start() { return command(Action::kStart); }
  State stop() { return command(Action::kStop); }
  /// Acknowledges messages and switches the drives on.
  State reset() { return command(Action::kReset); }
  RobotState pose();

  /// Reads unsolicited states that have arrived; never waits.
  void poll();
  /// Returns the last state received, solicited or not.
  [[nodiscard]] const State& last_state() const { return last_; }
  /// Returns the number of unsolicited states received.
  [[nodiscard]] std::uint64_t unsolicited() const { return unsolicited_; }
  [[nodiscard]] const std::string& description() const { return description_; }

 private:
  State command(Action action);
  void send(Action action);
  Reply wait_for_reply(Action action);
  std::optional<Reply> take();
  void read(io::Clock::time_point deadline);
  [[noreturn]] void fail(const std::string& problem) const;

  ClientSettings settings_;
  std::string description_;
  std::unique_ptr<io::ByteChannel> channel_;
  DocumentBuffer documents_;
  State last_;
  std::uint32_t seq_ = 0;
  std::uint64_t unsolicited_ = 0;
};

}  // namespace vbar::tron::eki
