#pragma once
// Reads one TOML table key by key and refuses what is not as it should be with a MissionError that says where.

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <toml++/toml.h>

#include "fsw/core/gps_time.h"

namespace vbar::mission {

/// Accepted numbers: low <= x <= high, or low < x where `above` is set.
struct Range {
  double low = 0.0;
  double high = 0.0;
  bool above = false;
};
constexpr Range from_to(double low, double high) {
  return {low, high, false};
}
constexpr Range above_to(double low, double high) {
  return {low, high, true};
}

class TableReader {
 public:
  /// Reads `table`, which must outlive the reader. `path` is its dotted path, empty for the document; `file` the file's
  /// name.
  TableReader(const toml::table& table, std::string path, std::string file);

  /// Refuses every key of the table that is not listed. To be called before a value is read, except the one value on
  /// which the list depends.
  void accept_only(std::initializer_list<std::string_view> keys) const;

  [[nodiscard]] bool has(std::string_view key) const { return table_->contains(key); }

  // A value or, where the key is missing, `otherwise`; without `otherwise` the key is required.
  double number(std::string_view key, Range range, std::optional<double> otherwise = std::nullopt) const;
  std::int64_t integer(std::string_view key, std::int64_t low, std::int64_t high,
                       std::optional<std::int64_t> otherwise = std::nullopt) const;
  bool flag(std::string_view key, bool otherwise) const;
  /// Text of printable characters; an unquoted TOML date-time counts as its text.
  std::string text(std::string_view key, std::optional<std::string> otherwise = std::nullopt) const;
  /// Letters, digits, '_' and '-' only: a name that can stand in a path.
  std::string name(std::string_view key, std::optional<std::string> otherwise = std::nullopt) const;
  /// An array of at least `least` and at most `most` numbers.
  std::vector<double> numbers(std::string_view key, std::size_t least, std::size_t most, Range range) const;
  /// Three numbers or, where the key is missing, `otherwise`; without `otherwise` the key is required.
  std::array<double, 3> three_numbers(std::string_view key, Range range,
                                      std::optional<std::array<double, 3>> otherwise = std::nullopt) const;
  /// Six numbers.
  std::array<double, 6> six_numbers(std::string_view key, Range range) const;
  /// A span given in units of `unit_s` seconds, rounded to a nanosecond; range and `otherwise` in the same units.
  fsw::Duration span(std::string_view key, double unit_s, Range range,
                     std::optional<double> otherwise = std::nullopt) const;

  /// The enumerator whose name is the value.
  template <class Enum, std::size_t N>
  Enum choice(std::string_view key, const std::array<std::pair<std::string_view, Enum>, N>& names,
              std::optional<Enum> otherwise = std::nullopt) const {
    if (!has(key) && otherwise) return *otherwise;
    std::vector<std::string_view> accepted;
    for (const auto& [name, value] : names) accepted.push_back(name);
    return names[chosen(key, accepted)].second;
  }

  /// The enumerators whose names are in the array, each at most once; none where the key is missing.
  template <class Enum, std::size_t N>
  std::vector<Enum> choices(std::string_view key, const std::array<std::pair<std::string_view, Enum>, N>& names) const {
    std::vector<std::string_view> accepted;
    for (const auto& [name, value] : names) accepted.push_back(name);
    std::vector<Enum> values;
    for (const std::size_t index : chosen_several(key, accepted)) values.push_back(names[index].second);
    return values;
  }

  /// A table inside this one; an empty one if it is missing.
  [[nodiscard]] TableReader table(std::string_view key) const;
  /// The elements of an array of tables; none if it is missing. Their paths are key.0, key.1, ... until renamed.
  [[nodiscard]] std::vector<TableReader> tables(std::string_view key) const;
  /// Gives the table the path by which people know it.
  void rename(std::string path) { path_ = std::move(path); }

  /// Refuses the value of `key` (the whole table if empty) for a reason of the caller's.
  [[noreturn]] void refuse(std::string_view key, const std::string& found, const std::string& accepted) const;
  /// As above; what was found is the value itself.
  [[noreturn]] void refuse_value(std::string_view key, const std::string& accepted) const;

 private:
  [[nodiscard]] std::string path_of(std::string_view key) const;
  [[nodiscard]] const toml::node& required(std::string_view key, const std::string& accepted) const;
  [[nodiscard]] std::size_t chosen(std::string_view key, const std::vector<std::string_view>& accepted) const;
  [[nodiscard]] std::vector<std::size_t> chosen_several(std::string_view key,
                                                        const std::vector<std::string_view>& accepted) const;
  double checked_number(const toml::node& node, std::string_view key, Range range) const;

  const toml::table* table_;
  std::string path_;
  std::string file_;
};

/// "file:line" of a node, or the override it came from; `file` alone if it came from nowhere.
[[nodiscard]] std::string location_of(const toml::node& node, const std::string& file);

/// The value as a message shows it: `the text "abc"`, `the number 2.5`, `nan`, `a table`, ...
[[nodiscard]] std::string description_of(const toml::node& node);

/// "from 0 to 1", "above 0, up to 1".
[[nodiscard]] std::string text_of(Range range);

/// "a, b or c".
[[nodiscard]] std::string listing_of(const std::vector<std::string_view>& names);

}  // namespace vbar::mission
