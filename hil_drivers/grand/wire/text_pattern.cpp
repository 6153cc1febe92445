#include "hil_drivers/grand/wire/text_pattern.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace vbar::grand::wire {
namespace {

[[noreturn]] void fail(std::string_view pattern, std::size_t position, std::string_view problem) {
  throw WireError(fmt::format("pattern \"{}\", character {}: {}", printable(pattern), position + 1, problem));
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// [0][width][.precision][d|e|f|g], width and precision up to two digits.
bool is_specification(std::string_view text) {
  const auto skip_digits = [&] {
    std::size_t count = 0;
    while (count < text.size() && count < 3 && is_digit(text[count])) ++count;
    text.remove_prefix(count);
  };
  skip_digits();
  if (text.starts_with('.')) {
    text.remove_prefix(1);
    if (text.empty() || !is_digit(text.front())) return false;
    skip_digits();
  }
  return text.size() == 1 && std::string_view("defg").find(text.front()) != std::string_view::npos;
}

char control_character(char letter) {
  switch (letter) {
    case 'n':
      return '\n';
    case 'r':
      return '\r';
    case 't':
      return '\t';
    default:
      return '\0';
  }
}

std::string listing_of(const std::vector<std::string_view>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

double leading_number(std::string_view text, std::size_t& length) {
  const std::size_t sign = text.starts_with('+') ? 1 : 0;
  double value = 0.0;
  const char* begin = text.data() + sign;
  const auto result = std::from_chars(begin, text.data() + text.size(), value);
  const bool has_two_signs = sign == 1 && text.size() > 1 && text[1] == '-';
  length = result.ec == std::errc{} && !has_two_signs ? static_cast<std::size_t>(result.ptr - text.data()) : 0;
  return value;
}

TextPattern::TextPattern(std::string_view pattern, const std::vector<std::string_view>& known) : pattern_(pattern) {
  Piece piece;
  for (std::size_t at = 0; at < pattern.size(); ++at) {
    const char c = pattern[at];
    const char following = at + 1 < pattern.size() ? pattern[at + 1] : '\0';
    if ((c == '{' || c == '}') && following == c) {
      piece.literal += c;
      ++at;
    } else if (c == '\\') {
      const char control = control_character(following);
      if (control == '\0') fail(pattern, at, "after a backslash, n, r or t is expected");
      piece.literal += control;
      ++at;
    } else if (c == '}') {
      fail(pattern, at, "'}' without '{'; a brace is written \"}}\"");
    } else if (c == '{') {
      const std::size_t end = pattern.find('}', at);
      if (end == std::string_view::npos) fail(pattern, at, "'{' without '}'");
      const std::string_view place = pattern.substr(at + 1, end - at - 1);
      const std::size_t colon = std::min(place.find(':'), place.size());
      piece.name = place.substr(0, colon);
      if (std::find(known.begin(), known.end(), piece.name) == known.end())
        fail(pattern, at, fmt::format("unknown name \"{}\"; known are {}", printable(piece.name), listing_of(known)));
      const std::string_view specification = colon < place.size() ? place.substr(colon + 1) : "";
      if (colon < place.size() && !is_specification(specification))
        fail(pattern, at,
             fmt::format("format \"{}\" is not [0][width][.precision] and d, e, f or g", printable(specification)));
      piece.is_integer = specification.ends_with('d');
      if (piece.is_integer && specification.find('.') != std::string_view::npos)
        fail(pattern, at, "an integer has no precision");
      piece.specification = fmt::format("{{:{}}}", specification);
      // Two numbers without a text between them cannot be read back.
      if (piece.literal.empty() && !pieces_.empty())
        fail(pattern, at, fmt::format("no text between \"{}\" and \"{}\"", pieces_.back().name, piece.name));
      pieces_.push_back(std::move(piece));
      piece = {};
      at = end;
    } else {
      piece.literal += c;
    }
  }
  if (!piece.literal.empty()) pieces_.push_back(std::move(piece));
}

std::string TextPattern::format(const NamedValues& values) const {
  std::string text;
  for (const Piece& piece : pieces_) {
    text += piece.literal;
    if (piece.name.empty()) continue;
    const auto found = values.find(piece.name);
    if (found == values.end() || !std::isfinite(found->second))
      throw WireError(fmt::format("pattern \"{}\": {} is missing or not finite", printable(pattern_), piece.name));
    const double value = found->second;
    if (piece.is_integer && std::abs(value) > 9e15)
      throw WireError(fmt::format("pattern \"{}\": {} = {} is too large", printable(pattern_), piece.name, value));
    text += piece.is_integer ? fmt::format(fmt::runtime(piece.specification), std::llround(value))
                             : fmt::format(fmt::runtime(piece.specification), value);
  }
  return text;
}

NamedValues TextPattern::parse(std::string_view text) const {
  NamedValues values;
  std::size_t at = 0;
  const auto fail_text = [&](std::string_view problem) {
    throw WireError(fmt::format("text \"{}\", character {}: {}", printable(text), at + 1, problem));
  };
  for (const Piece& piece : pieces_) {
    if (text.substr(at, piece.literal.size()) != piece.literal)
      fail_text(fmt::format("\"{}\" is expected", printable(piece.literal)));
    at += piece.literal.size();
    if (piece.name.empty()) continue;
    // A width pads with blanks.
    while (at < text.size() && text[at] == ' ') ++at;
    std::size_t length = 0;
    const double value = leading_number(text.substr(at), length);
    if (length == 0 || !std::isfinite(value)) fail_text(fmt::format("a finite number is expected ({})", piece.name));
    at += length;
    values[piece.name] = value;
  }
  if (at != text.size()) fail_text("the text is longer than expected");
  return values;
}

bool TextPattern::matches(std::string_view text) const {
  try {
    static_cast<void>(parse(text));
    return true;
  } catch (const WireError&) {
    return false;
  }
}

std::vector<std::string> TextPattern::names() const {
  std::vector<std::string> names;
  for (const Piece& piece : pieces_)
    if (!piece.name.empty()) names.push_back(piece.name);
  return names;
}

}  // namespace vbar::grand::wire
