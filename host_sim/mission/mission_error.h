#pragma once
// The one message for an invalid mission file.

#include <filesystem>
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

// A data file as a mission names it.

struct NamedFile {
  std::string where;           ///< "file:line" or "--set path=value"
  std::string key;             ///< dotted path
  std::string text;            ///< the value
  std::filesystem::path file;  ///< absolute, or in the data folder
};

}  // namespace vbar::mission
