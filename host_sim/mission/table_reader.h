#pragma once
// Reads one TOML table key by key and rejects invalid content with a MissionError that names the location.

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <toml++/toml.h>

#include "fsw/core/gps_time.h"
#include "host_sim/mission/mission_error.h"

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

inline constexpr std::string_view kTable = "a table";

/// A key as a reader accepts it.
struct AcceptedKey {
  std::string name;
  std::string accepted;  ///< "a number from 0 to 1", kTable, also of several; empty if only its presence was asked for
  std::string default_value;  ///< as in TOML; empty without one
  friend bool operator==(const AcceptedKey&, const AcceptedKey&) = default;
};

/// Reads one table; a key that has been read is a known key: finish() rejects all others, so that no list of keys is
/// needed.
class TableReader {
 public:
  /// Reads the document `table`, which must outlive the reader and all readers of its inner tables; `file` is the
  /// file's name.
  TableReader(const toml::table& table, std::string file);

  /// Ends the reading, when all keys have been read. Throws, in this order: for a key of the table that was not read;
  /// for such a key of its inner tables; for the first number or flag of the table that was rejected. (number, numbers,
  /// integer and flag return an accepted value for a rejected one, so that the remaining keys are read before the
  /// message.)
  void finish() const;

  /// Rejects a key that has not been read so far, without checking inner tables.
  void refuse_unknown_keys() const;

  /// Returns the keys that have been read, in that order.
  [[nodiscard]] std::vector<std::string> asked() const;
  /// Returns the keys that have been read of all tables of the document, by the dotted paths of the tables.
  [[nodiscard]] std::map<std::string, std::vector<AcceptedKey>> asked_of_all() const;

  [[nodiscard]] bool has(std::string_view key) const { return find(key) != nullptr; }

  [[nodiscard]] bool is_array(std::string_view key) const;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Returns the keys of the table, in alphabetical order; this does not count as reading them.
  [[nodiscard]] std::vector<std::string> keys() const;

  // A value or, if the key is missing, `default_value`; without it the key is required.
  double number(std::string_view key, Range range, std::optional<double> default_value = std::nullopt) const;
  std::int64_t integer(std::string_view key, std::int64_t low, std::int64_t high,
                       std::optional<std::int64_t> default_value = std::nullopt) const;
  bool flag(std::string_view key, bool default_value) const;
  /// Reads a text of printable characters; an unquoted TOML date-time counts as its text.
  std::string text(std::string_view key, std::optional<std::string> default_value = std::nullopt) const;
  /// Reads an array of texts of printable characters; empty if the key is missing.
  std::vector<std::string> texts(std::string_view key) const;
  /// Reads a name of letters, digits, '_' and '-' only, which can be part of a path.
  std::string name(std::string_view key, std::optional<std::string> default_value = std::nullopt) const;
  /// Reads an array of `min_count` to `max_count` numbers.
  std::vector<double> numbers(std::string_view key, std::size_t min_count, std::size_t max_count, Range range) const;
  /// Reads an array of 1 to `max_count` pairs of numbers: [[first, second], ...].
  std::vector<std::pair<double, double>> pairs(std::string_view key, std::size_t max_count, Range first,
                                               Range second) const;
  /// Reads three numbers or, where the key is missing, `default_value`; without it the key is required.
  std::array<double, 3> three_numbers(std::string_view key, Range range,
                                      std::optional<std::array<double, 3>> default_value = std::nullopt) const;
  /// Reads six numbers.
  std::array<double, 6> six_numbers(std::string_view key, Range range) const;
  /// Reads a span given in units of `unit_s` seconds, rounded to a nanosecond; range and `default_value` in the same
  /// units.
  fsw::Duration span(std::string_view key, double unit_s, Range range,
                     std::optional<double> default_value = std::nullopt) const;

  /// Returns the enumerator whose name is the value.
  template <class Enum, std::size_t N>
  Enum choice(std::string_view key, const std::array<std::pair<std::string_view, Enum>, N>& names,
              std::optional<Enum> default_value = std::nullopt) const {
    std::vector<std::string_view> accepted;
    std::string_view default_name;
    for (const auto& [name, value] : names) {
      accepted.push_back(name);
      if (default_value && value == *default_value && default_name.empty()) default_name = name;
    }
    note_choice(key, accepted, default_name);
    if (!has(key) && default_value) return *default_value;
    return names[chosen(key, accepted)].second;
  }

  /// Returns one of the names; `default_value` where the key is missing.
  std::string choice(std::string_view key, const std::vector<std::string_view>& names,
                     std::string_view default_value) const {
    note_choice(key, names, default_value);
    return std::string(has(key) ? names[chosen(key, names)] : default_value);
  }

  /// Returns the enumerators whose names are in the array, each at most once; empty if the key is missing.
  template <class Enum, std::size_t N>
  std::vector<Enum> choices(std::string_view key, const std::array<std::pair<std::string_view, Enum>, N>& names) const {
    std::vector<std::string_view> accepted;
    for (const auto& [name, value] : names) accepted.push_back(name);
    note(key, several_of(accepted), "[]");
    std::vector<Enum> values;
    for (const std::size_t index : chosen_several(key, accepted)) values.push_back(names[index].second);
    return values;
  }

  /// Returns the reader of a table inside this one; an empty one if it is missing.
  [[nodiscard]] TableReader table(std::string_view key) const;
  /// Returns the readers of the elements of an array of tables; empty if it is missing. Their paths are key.0, key.1,
  /// ... until renamed.
  [[nodiscard]] std::vector<TableReader> tables(std::string_view key) const;
  /// Sets the path of the table in messages.
  void rename(std::string path);

  /// Returns "file:line" of the key, or its override ("--set path=value").
  [[nodiscard]] std::string where(std::string_view key) const;

  /// Keeps a key that names a data file, for data_files().
  void note_data_file(std::string_view key, const std::string& text, const std::filesystem::path& file) const;
  /// Returns the data files that the whole document names, in the order of reading.
  [[nodiscard]] std::vector<NamedFile> data_files() const;

  /// Rejects the value of `key` (the whole table if empty) for a reason given by the caller.
  [[noreturn]] void refuse(std::string_view key, const std::string& found, const std::string& accepted) const;
  /// Rejects the value of `key` as refuse() does; the value itself is reported as found.
  [[noreturn]] void refuse_value(std::string_view key, const std::string& accepted) const;

 private:
  struct Book;

  TableReader(const toml::table& table, std::string path, const TableReader& parent);

  /// Returns the node of a key, which counts as read; null if it is missing.
  [[nodiscard]] const toml::node* find(std::string_view key) const;
  void finish(const toml::table& table) const;
  void refuse_unknown_keys(const toml::table& table) const;
  /// Records what the key accepts, for asked_of_all().
  void note(std::string_view key, std::string accepted, std::string default_value = {}) const;
  void note_choice(std::string_view key, const std::vector<std::string_view>& names,
                   std::string_view default_name) const;
  [[nodiscard]] static std::string several_of(const std::vector<std::string_view>& names);
  /// Keeps the error for finish().
  template <class Value, class Read>
  Value or_later(Value accepted, const Read& read) const;
  [[nodiscard]] std::string path_of(std::string_view key) const;
  [[nodiscard]] const toml::node& required(std::string_view key, const std::string& accepted) const;
  [[nodiscard]] std::size_t chosen(std::string_view key, const std::vector<std::string_view>& accepted) const;
  [[nodiscard]] std::vector<std::size_t> chosen_several(std::string_view key,
                                                        const std::vector<std::string_view>& accepted) const;
  double checked_number(const toml::node& node, std::string_view key, Range range) const;

  const toml::table* table_;
  std::string path_;
  std::string file_;
  std::shared_ptr<Book> book_;  ///< record of the whole document
};

inline constexpr std::string_view kNameRule = "a name of 1 to 64 letters, digits, '_' and '-'";
[[nodiscard]] bool is_name(std::string_view text);

/// Returns "file:line" of a node, or its override; `file` alone without a location.
[[nodiscard]] std::string location_of(const toml::node& node, const std::string& file);

/// Returns the value as shown in messages: `the text "abc"`, `the number 2.5`, `nan`, `a table`, ...
[[nodiscard]] std::string description_of(const toml::node& node);

/// Returns a range in words: "from 0 to 1", "above 0, up to 1".
[[nodiscard]] std::string text_of(Range range);

/// Returns names as a list in words: "a, b or c".
[[nodiscard]] std::string listing_of(const std::vector<std::string_view>& names);

// Keys whose default is the value that the settings were made with.

inline void read(const TableReader& section, std::string_view key, Range range, double& value) {
  value = section.number(key, range, value);
}

inline void read(const TableReader& section, std::string_view key, int low, int high, int& value) {
  value = static_cast<int>(section.integer(key, low, high, value));
}

}  // namespace vbar::mission
