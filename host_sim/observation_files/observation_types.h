#pragma once
// The observation types of a RINEX file by its header lines: versions 2.xx list one set for all systems, versions 3.xx
// and 4.xx one for each.

#include <map>
#include <string>
#include <vector>

#include "host_sim/files/text_lines.h"

namespace vbar::observation_files {

class ObservationTypes {
 public:
  /// `version`: 2, 3 or 4.
  explicit ObservationTypes(int version = 2) : version_(version) {}

  /// Reads a header line that lists types, and ignores any other. Throws files::FormatError.
  void take(const files::TextLines& lines);
  /// Refuses a list that ended before its number of types.
  void check_complete(const files::TextLines& lines) const;

  /// Returns the types of a system ("C1", "L1C"); empty for one without.
  [[nodiscard]] const std::vector<std::string>& of(char system) const;
  [[nodiscard]] int version() const { return version_; }
  [[nodiscard]] bool empty() const { return types_.empty(); }

  static constexpr int kMaxTypes = 99;  ///< of one system

 private:
  void take_words(const files::TextLines& lines, std::size_t first, std::size_t width, std::size_t per_line);

  int version_;
  int announced_ = 0;     ///< types of the list that is being read
  char system_ = ' ';     ///< whose list that is; blank: version 2
  bool is_open_ = false;  ///< the list lacks types
  std::map<char, std::vector<std::string>> types_;
};

/// Returns the label in columns 61 to 80 of a header line.
[[nodiscard]] std::string_view label_of(const files::TextLines& lines);

/// Reads the version of a RINEX file from its first line, and refuses one that is not an observation file of version 2,
/// 3 or 4.
[[nodiscard]] int observation_version(const files::TextLines& lines);

}  // namespace vbar::observation_files
