#include "host_sim/files/text_lines.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace vbar::files {
namespace {

constexpr std::string_view kBlanks = " \t\r";

/// Bytes of the character that `text` begins with; 0 if it is not one of UTF-8.
std::size_t character_bytes(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text.front());
  if (lead < 0x80) return 1;
  if (lead < 0xC2 || lead > 0xF4) return 0;
  const std::size_t count = lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  const auto follows = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; };
  return count <= text.size() && std::ranges::all_of(text.substr(1, count - 1), follows) ? count : 0;
}

/// The controls of ASCII and those that ISO 6429 adds, U+0080 to U+009F.
bool is_control(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1) return first < 0x20 || first == 0x7F;
  return first == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::optional<double> number_of(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  if (text.starts_with('+')) return std::nullopt;
  std::array<char, 64> digits{};
  if (text.empty() || text.size() > digits.size()) return std::nullopt;
  std::ranges::transform(text, digits.begin(), [](char c) { return c == 'D' || c == 'd' ? 'e' : c; });
  double value = 0.0;
  const char* const end = digits.data() + text.size();
  const auto [at, error] = std::from_chars(digits.data(), end, value);
  if (error != std::errc{} || at != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<int> integer_of(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  int value = 0;
  const auto [at, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || text.front() == '+' || error != std::errc{} || at != text.data() + text.size())
    return std::nullopt;
  return value;
}

std::vector<std::string_view> split_at(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const auto end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 100;
  const bool is_long = text.size() > kLongest;
  std::string shown(text.substr(0, kLongest));
  for (char& c : shown)
    if (c < ' ' || c > '~') c = c == '\t' ? ' ' : '?';
  return fmt::format("\"{}{}\"", shown, is_long ? "..." : "");
}

std::string printable(std::string_view message) {
  std::string shown;
  while (!message.empty()) {
    const std::size_t bytes = character_bytes(message);
    const std::string_view character = message.substr(0, std::max<std::size_t>(1, bytes));
    if (bytes == 0 || (character != "\n" && is_control(character)))
      shown += '?';
    else
      shown += character;
    message.remove_prefix(character.size());
  }
  return shown;
}

bool TextLines::next() {
  if (rest_.empty()) return false;
  const auto end = rest_.find('\n');
  is_ended_ = end != std::string_view::npos;
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (line_.ends_with('\r')) line_.remove_suffix(1);
  ++number_;
  return true;
}

std::string_view TextLines::columns(std::size_t first, std::size_t last) const {
  if (first > line_.size()) return {};
  return line_.substr(first - 1, last - first + 1);
}

bool TextLines::is_cut_in(std::size_t first, std::size_t last) const {
  return line_.size() < last && !trimmed(columns(first, last)).empty();
}

std::optional<double> TextLines::number_or_blank_in(std::size_t first, std::size_t last, std::string_view what) const {
  if (trimmed(columns(first, last)).empty()) return std::nullopt;
  return number_in(first, last, what);
}

double TextLines::number_in(std::size_t first, std::size_t last, std::string_view what) const {
  const auto value = number_of(columns(first, last));
  if (!value || is_cut_in(first, last)) refuse(fmt::format("{} in columns {} to {}", what, first, last));
  return *value;
}

int TextLines::integer_in(std::size_t first, std::size_t last, std::string_view what) const {
  const auto value = integer_of(columns(first, last));
  if (!value || is_cut_in(first, last)) refuse(fmt::format("{} in columns {} to {}", what, first, last));
  return *value;
}

std::vector<std::string_view> TextLines::words() const {
  std::vector<std::string_view> words;
  std::string_view rest = line_;
  for (;;) {
    const auto begin = rest.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) return words;
    const auto end = std::min(rest.find_first_of(kBlanks, begin), rest.size());
    words.push_back(rest.substr(begin, end - begin));
    rest.remove_prefix(end);
  }
}

void TextLines::check_ended() const {
  if (!is_ended_) refuse("a last row without a line feed", "one: its last number may be cut short");
}

void TextLines::refuse(std::string_view expected) const {
  refuse(quoted(line_), expected);
}

void TextLines::refuse(std::string_view found, std::string_view expected) const {
  throw FormatError(
      printable(fmt::format("{}:{}: found {}, expected {}", file_, std::max(number_, 1), found, expected)));
}

}  // namespace vbar::files
