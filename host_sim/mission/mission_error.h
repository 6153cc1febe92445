#pragma once
// The one message for an invalid mission file.

#include <stdexcept>
#include <string>

namespace vbar::mission {

/// Error of a mission file; what() is "<where>: <key>: found <found>; accepted: <accepted>".
class MissionError : public std::runtime_error {
 public:
  /// Composes the message. `where`: "file:line", a file alone, or "--set path=value". `key`: the dotted path; empty if
  /// the error concerns the whole file.
  MissionError(const std::string& where, const std::string& key, const std::string& found, const std::string& accepted)
      : std::runtime_error(where + ": " + (key.empty() ? "" : key + ": ") + "found " + found +
                           "; accepted: " + accepted) {}
};

}  // namespace vbar::mission
