#pragma once
// Texts with numbers at named places, "T{time_s:.3f},{vehicle}": the same pattern writes a text and reads it back.

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "hil_drivers/grand/wire/bytes.h"

namespace vbar::grand::wire {

using NamedValues = std::map<std::string, double, std::less<>>;

class TextPattern {
 public:
  /// `known`: the accepted names. Places are {name} or {name:FORMAT}, with FORMAT as in std::format:
  /// [0][width][.precision] and one of d, e, f, g; without it, the shortest text that reads back exactly. "{{" and "}}"
  /// are braces, "\n", "\r" and "\t" (backslash and letter) control characters. Throws WireError with the position.
  TextPattern(std::string_view pattern, const std::vector<std::string_view>& known);

  /// Returns the text of these values. Throws WireError if a value is missing or not finite.
  [[nodiscard]] std::string format(const NamedValues& values) const;
  /// Returns the values in a text of this form. Throws WireError with the position.
  [[nodiscard]] NamedValues parse(std::string_view text) const;
  /// Returns true if `text` has this form.
  [[nodiscard]] bool matches(std::string_view text) const;

  [[nodiscard]] std::vector<std::string> names() const;

 private:
  /// Literal text, followed by a place unless `name` is empty.
  struct Piece {
    std::string literal = {};
    std::string name = {};
    std::string specification = {};  ///< for fmt, "{:.3f}"
    bool is_integer = false;
  };
  std::string pattern_;
  std::vector<Piece> pieces_;
};

/// Returns a number at the beginning of `text`, without white space before it; `length` receives its length, 0 if there
/// is none. Accepts a leading '+'.
double leading_number(std::string_view text, std::size_t& length);

}  // namespace vbar::grand::wire
