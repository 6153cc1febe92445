#pragma once
// What a navigation file holds beside the sets that are used, by kind and number, for a note and for the refusal of a
// file without a set that can be used.

#include <string>
#include <string_view>
#include <vector>

namespace vbar::twins::gnss {

class LeftOut {
 public:
  /// Adds a record of another system or message, which every file of several systems holds: "GLONASS", "Galileo F/NAV".
  void add(std::string_view kind) { entry(kind).count += 1; }

  /// Adds a set that would be used if it were right. `first`: satellite, line and reason, kept of the first of its
  /// kind.
  void add_defective(std::string_view kind, const std::string& first);

  [[nodiscard]] bool is_empty() const { return entries_.empty(); }

  /// Returns the records left out in words: "GLONASS (210), Galileo F/NAV (12), sets of zeros (2; the first: G05 in
  /// line 19)".
  [[nodiscard]] std::string text() const;

 private:
  struct Entry {
    std::string kind, first;
    int count = 0;
  };
  Entry& entry(std::string_view kind);

  std::vector<Entry> entries_;  ///< in the order in which their kinds appear
};

}  // namespace vbar::twins::gnss
