#include "host_sim/files/text_lines.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace vbar::files {
namespace {

constexpr std::string_view kBlanks = " \t\r";

}  // namespace

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  return text;
}

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

bool TextLines::next() {
  if (rest_.empty()) return false;
  const auto end = rest_.find('\n');
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

void TextLines::refuse(std::string_view expected) const {
  refuse(quoted(line_), expected);
}

void TextLines::refuse(std::string_view found, std::string_view expected) const {
  throw FormatError(fmt::format("{}:{}: found {}, expected {}", file_, std::max(number_, 1), found, expected));
}

}  // namespace vbar::files
