#pragma once
// Lines of Zaber's ASCII protocol: commands to a device and what devices answer.
//
//   /1 2 move abs 1000:XX        device, axis, command, checksum (all but the command may be missing)
//   @01 2 OK BUSY WR 0           reply: device, axis, OK or RJ, BUSY or IDLE, the gravest warning or --, data
//   #01 2 text   !01 2 IDLE --   information and alerts, without a request
//
// The checksum is the low byte of minus the sum of the characters between the first one and the colon, as two digits.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "hil_drivers/wire/bytes.h"

namespace vbar::zaber {

using wire::WireError;

inline constexpr int kMaxDevice = 99;
inline constexpr int kMaxAxis = 9;

struct Command {
  int device = 0;  ///< 0: every device
  int axis = 0;    ///< 0: the device, or all of its axes
  std::optional<int> id = std::nullopt;
  std::string text = {};  ///< words separated by single spaces; empty: asks for the status
  bool has_checksum = false;

  friend bool operator==(const Command&, const Command&) = default;
};

enum class MessageKind { kReply, kInformation, kAlert };

struct Message {
  MessageKind kind = MessageKind::kReply;
  int device = 1;
  int axis = 0;
  std::optional<int> id = std::nullopt;
  bool is_rejected = false;  ///< reply RJ
  bool is_busy = false;      ///< set in a reply and an alert
  std::string warning = "--";
  std::string data = "0";  ///< in a reply or an alert its data, in an information its text
  bool has_checksum = false;

  friend bool operator==(const Message&, const Message&) = default;
};

[[nodiscard]] std::string checksum_of(std::string_view characters);

/// Encodes without the end of the line. Throws WireError for what the line cannot hold.
[[nodiscard]] std::string encode(const Command& command);
[[nodiscard]] std::string encode(const Message& message);

/// Decodes a line without its end. Throws WireError: one sentence with the line.
[[nodiscard]] Command decode_command(std::string_view line);
[[nodiscard]] Message decode_message(std::string_view line);

}  // namespace vbar::zaber
