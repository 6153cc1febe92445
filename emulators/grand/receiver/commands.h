#pragma once
// Commands of the receiver as tables, and their reading from text and from binary fields (OEM6 Firmware Reference
// Manual OM-20000129, chapter 2).

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace vbar::grand::bench {

enum class CommandId : std::uint16_t {
  kLog = 1,
  kCom = 4,
  kClockAdjust = 15,
  kReset = 18,
  kSaveConfig = 19,
  kFreset = 20,
  kUnlog = 36,
  kUnlogAll = 38,
  kElevationCutoff = 50,
  kSetApproxTime = 102,
  kCodeSmoothing = 269,
  kSetApproxPos = 377,
  kPpsControl = 613,
  kSerialConfig = 1246,
};

/// Identifiers of ports in binary commands; the identifier of a port includes its 32 virtual addresses.
enum class PortId : std::uint32_t {
  kThisPortAll = 6,
  kAllPorts = 8,
  kCom1 = 32,
  kCom2 = 64,
  kCom3 = 96,
  kThisPort = 192
};

enum class Trigger : std::uint8_t { kOnNew = 0, kOnChanged = 1, kOnTime = 2, kOnNext = 3, kOnce = 4, kOnMark = 5 };
/// Trigger of a LOG that names none: the log's own default.
inline constexpr std::uint32_t kDefaultTrigger = 255;

enum class LogFormat : std::uint8_t { kBinary = 0, kAscii = 1, kAbbreviated = 2 };

/// Command with the values of its fields in order; a message field holds its number plus 65536 times its format.
struct Command {
  static constexpr std::size_t kMaxFields = 9;
  CommandId id = CommandId::kLog;
  std::array<double, kMaxFields> values{};

  [[nodiscard]] std::uint32_t whole(std::size_t field) const { return static_cast<std::uint32_t>(values[field]); }
  [[nodiscard]] std::uint16_t message_id(std::size_t field) const {
    return static_cast<std::uint16_t>(whole(field) & 0xFFFFU);
  }
  [[nodiscard]] LogFormat format(std::size_t field) const { return static_cast<LogFormat>(whole(field) >> 16U); }
};

/// Answer of the receiver; 1 is OK.
struct Response {
  std::uint32_t id = 1;
  std::string text = "OK";
  [[nodiscard]] bool ok() const { return id == 1; }
};

// Responses of the manual's table, as far as the receiver gives them.
Response no_such_log();
Response not_enough_resources();
Response command_failed();
Response invalid_message_id();
Response invalid_field(std::size_t field);
Response invalid_checksum();
Response missing_field();
Response out_of_range(std::size_t field);
Response invalid_trigger(std::size_t field);
Response invalid_rate();
Response incorrect_message();
Response unknown_port();
Response invalid_baud();
Response invalid_offset();

using ReadCommand = std::variant<Command, Response>;

/// Reads a name and its fields, as words; `name` without the suffix of its format.
ReadCommand read_text_command(std::string_view name, const std::vector<std::string_view>& fields);
/// Reads the body of a binary command.
ReadCommand read_binary_command(std::uint16_t id, std::span<const std::uint8_t> body);

/// Returns the name of a command or the word in a message ("RANGEB") in capitals, and the format of its last letter.
std::string_view name_of(CommandId id);

}  // namespace vbar::grand::bench
