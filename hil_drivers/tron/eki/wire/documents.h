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
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "hil_drivers/wire/bytes.h"

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

}  // namespace vbar::tron::eki
