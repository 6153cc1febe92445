#pragma once
// Answer of a NovAtel receiver to an abbreviated ASCII command: <OK or <ERROR:text, then its prompt [COM1]. Logs and
// garbage may stand before and between (OEM6 Family Firmware Reference Manual, 1.4 "Responses").

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace vbar::grand {

struct CommandAnswer {
  bool is_accepted = false;
  std::string text;  ///< as received, printable: "<OK", "<ERROR:Invalid Message ID"
};

/// Returns the first answer that is complete in `bytes`; nothing if there is none yet.
[[nodiscard]] std::optional<CommandAnswer> find_answer(std::span<const std::uint8_t> bytes);

/// Returns the name of the port in the last prompt: "COM1"; nothing if there is none.
[[nodiscard]] std::optional<std::string> find_prompt(std::span<const std::uint8_t> bytes);

/// Returns at most `limit` bytes in printable form, other bytes as \xNN, for messages.
[[nodiscard]] std::string printable(std::span<const std::uint8_t> bytes, std::size_t limit = 60);

}  // namespace vbar::grand
