#pragma once
// Sections of CelesTrak's text files of daily values: lines BEGIN and END with the name of one.

#include <optional>
#include <span>
#include <string_view>

#include "host_sim/files/text_lines.h"

namespace vbar::truth {

/// Goes along with the lines of a file; at most one section is open.
class Sections {
 public:
  /// Makes a reader; `names` are those that the file may have.
  explicit Sections(std::span<const std::string_view> names) : names_(names) {}

  /// Returns whether the line begins or ends a section. Throws files::FormatError for one within another and unknown
  /// names.
  bool take(const files::TextLines& lines);

  /// Returns the place of the open section among the names.
  [[nodiscard]] std::optional<std::size_t> open() const { return open_; }

  /// Checks, at the end of the file, that no section is open. Throws files::FormatError if a section is open.
  void check_end(const files::TextLines& lines) const;

 private:
  std::span<const std::string_view> names_;
  std::optional<std::size_t> open_;
};

}  // namespace vbar::truth
