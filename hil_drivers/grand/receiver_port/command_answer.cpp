#include "hil_drivers/grand/receiver_port/command_answer.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

namespace vbar::grand {
namespace {

// Longest text of a refusal; what is longer is not an answer.
constexpr std::size_t kLongestError = 200;

std::string_view as_text(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};  // char may alias anything
}

bool is_printable(char c) {
  return c >= ' ' && c <= '~';
}

}  // namespace

std::optional<CommandAnswer> find_answer(std::span<const std::uint8_t> bytes) {
  const std::string_view text = as_text(bytes);
  for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at + 1)) {
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("<OK")) return CommandAnswer{true, "<OK"};
    if (!rest.starts_with("<ERROR:")) continue;
    const std::size_t end = rest.find_first_of("\r\n");
    if (end == std::string_view::npos || end > kLongestError) continue;
    const std::string_view line = rest.substr(0, end);
    if (std::ranges::all_of(line, is_printable)) return CommandAnswer{false, std::string(line)};
  }
  return std::nullopt;
}

std::optional<std::string> find_prompt(std::span<const std::uint8_t> bytes) {
  constexpr std::array<std::string_view, 3> kPortKinds{"[COM", "[USB", "[ICOM"};
  const std::string_view text = as_text(bytes);
  std::optional<std::string> found;
  for (std::size_t at = text.find('['); at != std::string_view::npos; at = text.find('[', at + 1)) {
    const std::string_view rest = text.substr(at);
    const std::size_t end = rest.find(']');
    if (end == std::string_view::npos || end > 6) continue;
    const auto is_kind = [&](std::string_view kind) { return rest.starts_with(kind); };
    if (std::ranges::any_of(kPortKinds, is_kind)) found = std::string(rest.substr(1, end - 1));
  }
  return found;
}

std::string printable(std::span<const std::uint8_t> bytes, std::size_t limit) {
  std::string text;
  for (const std::uint8_t byte : bytes.first(std::min(limit, bytes.size()))) {
    if (is_printable(static_cast<char>(byte))) {
      text += static_cast<char>(byte);
    } else {
      text += fmt::format("\\x{:02x}", byte);
    }
  }
  if (bytes.size() > limit) text += "...";
  return text;
}

}  // namespace vbar::grand
