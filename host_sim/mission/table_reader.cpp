#include "host_sim/mission/table_reader.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <exception>
#include <sstream>

#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/name_search.h"

namespace vbar::mission {
namespace {

std::string text_of(double number) {
  std::ostringstream out;
  out.precision(10);
  out << number;
  return out.str();
}

template <class Value>
std::string streamed(const Value& value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

bool is_control_character(char c) {
  return static_cast<unsigned char>(c) < 0x20U || c == 0x7F;
}

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

// A table created by an override has no source location of its own; its contents have.
const toml::node* first_with_location(const toml::node& node) {
  if (node.source().begin.line != 0) return &node;
  if (const auto* table = node.as_table()) {
    for (const auto& [key, child] : *table)
      if (const auto* found = first_with_location(child)) return found;
  }
  return nullptr;
}

}  // namespace

bool is_name(std::string_view text) {
  return !text.empty() && text.size() <= 64 && std::all_of(text.begin(), text.end(), is_name_character);
}

std::string location_of(const toml::node& node, const std::string& file) {
  const toml::node* located = first_with_location(node);
  if (located == nullptr) return file;
  const toml::source_region& source = located->source();
  const std::string& path = source.path ? *source.path : file;  // the extended file, where it applies
  if (path.starts_with("--set ")) return path;
  return path + ":" + std::to_string(source.begin.line);
}

std::string description_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return "the text \"" + node.as_string()->get() + "\"";
    case toml::node_type::integer:
      return "the integer " + std::to_string(node.as_integer()->get());
    case toml::node_type::floating_point: {
      const double value = node.as_floating_point()->get();
      return std::isfinite(value) ? "the number " + text_of(value) : std::isnan(value) ? "nan" : "an infinity";
    }
    case toml::node_type::boolean:
      return node.as_boolean()->get() ? "true" : "false";
    case toml::node_type::date:
      return "the date " + streamed(node.as_date()->get());
    case toml::node_type::time:
      return "the time " + streamed(node.as_time()->get());
    case toml::node_type::date_time:
      return "the date-time " + streamed(node.as_date_time()->get());
    case toml::node_type::array:
      return "an array of " + std::to_string(node.as_array()->size());
    case toml::node_type::table:
      return "a table";
    case toml::node_type::none:
      break;
  }
  return "nothing";
}

std::string text_of(Range range) {
  return (range.above ? "above " : "from ") + text_of(range.low) + (range.above ? ", up to " : " to ") +
         text_of(range.high);
}

std::string listing_of(const std::vector<std::string_view>& names) {
  std::string listing;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (k > 0) listing += k + 1 == names.size() ? " or " : ", ";
    listing += names[k];
  }
  return listing;
}

/// The keys that were read from each table of a document, and the first error, deferred until finish().
struct TableReader::Book {
  struct Entry {
    std::string path;
    std::vector<AcceptedKey> keys;

    [[nodiscard]] std::vector<std::string> names() const {
      std::vector<std::string> names;
      for (const AcceptedKey& key : keys) names.push_back(key.name);
      return names;
    }
    AcceptedKey& of(std::string_view name) {
      const auto known = std::ranges::find(keys, name, &AcceptedKey::name);
      return known != keys.end() ? *known : keys.emplace_back(AcceptedKey{std::string(name), {}, {}});
    }
  };
  std::map<const toml::table*, Entry> entries;
  std::vector<NamedFile> data_files;
  std::deque<toml::table> missing;  ///< stand-ins for tables that the file lacks
  const toml::table* refused_in = nullptr;
  std::exception_ptr refused;
};

TableReader::TableReader(const toml::table& table, std::string file)
    : table_(&table), file_(std::move(file)), book_(std::make_shared<Book>()) {
  book_->entries[table_];
}

TableReader::TableReader(const toml::table& table, std::string path, const TableReader& parent)
    : table_(&table), path_(std::move(path)), file_(parent.file_), book_(parent.book_) {
  book_->entries[table_].path = path_;
}

void TableReader::rename(std::string path) {
  path_ = std::move(path);
  book_->entries[table_].path = path_;
}

const toml::node* TableReader::find(std::string_view key) const {
  static_cast<void>(book_->entries[table_].of(key));
  return table_->get(key);
}

std::vector<std::string> TableReader::keys() const {
  std::vector<std::string> names;
  for (const auto& [key, node] : *table_) names.emplace_back(key.str());
  return names;
}

void TableReader::note(std::string_view key, std::string accepted, std::string default_value) const {
  AcceptedKey& known = book_->entries[table_].of(key);
  known.accepted = std::move(accepted);
  known.default_value = std::move(default_value);
}

void TableReader::note_choice(std::string_view key, const std::vector<std::string_view>& names,
                              std::string_view default_name) const {
  note(key, listing_of(names), default_name.empty() ? std::string() : '"' + std::string(default_name) + '"');
}

std::string TableReader::several_of(const std::vector<std::string_view>& names) {
  return "an array of distinct names out of " + listing_of(names);
}

std::vector<std::string> TableReader::asked() const {
  return book_->entries[table_].names();
}

std::map<std::string, std::vector<AcceptedKey>> TableReader::asked_of_all() const {
  std::map<std::string, std::vector<AcceptedKey>> all;
  for (const auto& [table, entry] : book_->entries) all[entry.path] = entry.keys;
  return all;
}

void TableReader::refuse_unknown_keys() const {
  refuse_unknown_keys(*table_);
}

void TableReader::refuse_unknown_keys(const toml::table& table) const {
  const Book::Entry& entry = book_->entries[&table];
  const std::vector<std::string> names = entry.names();
  for (const auto& [key, node] : table) {
    if (std::ranges::find(names, key.str()) != names.end()) continue;
    const std::vector<std::string_view> accepted(names.begin(), names.end());
    throw MissionError(location_of(node, file_), (entry.path.empty() ? "" : entry.path + ".") + std::string(key.str()),
                       "an unknown key" + did_you_mean(key.str(), accepted), listing_of(accepted));
  }
}

void TableReader::finish() const {
  finish(*table_);
  if (book_->refused && (book_->refused_in == table_ || path_.empty())) std::rethrow_exception(book_->refused);
}

void TableReader::finish(const toml::table& table) const {
  refuse_unknown_keys(table);
  const auto finish_inner = [&](const toml::node& node) {
    const toml::table* const inner = node.as_table();
    if (inner != nullptr && book_->entries.contains(inner)) finish(*inner);
  };
  for (const auto& [key, node] : table) {
    finish_inner(node);
    if (const toml::array* const elements = node.as_array())
      for (const toml::node& element : *elements) finish_inner(element);
  }
}

template <class Value, class Read>
Value TableReader::or_later(Value accepted, const Read& read) const {
  try {
    return read();
  } catch (const MissionError&) {
    if (!book_->refused) {
      book_->refused = std::current_exception();
      book_->refused_in = table_;
    }
    return accepted;
  }
}

std::string TableReader::path_of(std::string_view key) const {
  if (key.empty()) return path_;
  return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

std::string TableReader::where(std::string_view key) const {
  const toml::node* node = key.empty() ? nullptr : table_->get(key);
  return location_of(node != nullptr ? *node : *table_, file_);
}

void TableReader::note_data_file(std::string_view key, const std::string& text,
                                 const std::filesystem::path& file) const {
  book_->data_files.push_back({where(key), path_of(key), text, file});
}

std::vector<NamedFile> TableReader::data_files() const {
  return book_->data_files;
}

void TableReader::refuse(std::string_view key, const std::string& found, const std::string& accepted) const {
  if (book_->refused) std::rethrow_exception(book_->refused);  // the earlier one, of which this may be a consequence
  throw MissionError(where(key), path_of(key), found, accepted);
}

void TableReader::refuse_value(std::string_view key, const std::string& accepted) const {
  const toml::node* node = table_->get(key);
  refuse(key, node != nullptr ? description_of(*node) : "nothing", accepted);
}

const toml::node& TableReader::required(std::string_view key, const std::string& accepted) const {
  const toml::node* node = find(key);
  if (node == nullptr) refuse(key, "nothing", accepted);
  return *node;
}

double TableReader::checked_number(const toml::node& node, std::string_view key, Range range) const {
  // TOML distinguishes integers from floats; 60 is accepted for 60.0.
  const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
  const bool good = value && std::isfinite(*value) && (range.above ? *value > range.low : *value >= range.low) &&
                    *value <= range.high;
  if (!good)
    throw MissionError(location_of(node, file_), path_of(key), description_of(node), "a number " + text_of(range));
  return *value;
}

double TableReader::number(std::string_view key, Range range, std::optional<double> default_value) const {
  note(key, "a number " + text_of(range), default_value ? text_of(*default_value) : std::string());
  if (!has(key) && default_value) return *default_value;
  return or_later(default_value.value_or(range.above ? range.high : range.low),
                  [&] { return checked_number(required(key, "a number " + text_of(range)), key, range); });
}

std::int64_t TableReader::integer(std::string_view key, std::int64_t low, std::int64_t high,
                                  std::optional<std::int64_t> default_value) const {
  const std::string accepted = "an integer from " + std::to_string(low) + " to " + std::to_string(high);
  note(key, accepted, default_value ? std::to_string(*default_value) : std::string());
  if (!has(key) && default_value) return *default_value;
  return or_later(default_value.value_or(low), [&] {
    const auto* value = required(key, accepted).as_integer();
    if (value == nullptr || value->get() < low || value->get() > high) refuse_value(key, accepted);
    return value->get();
  });
}

bool TableReader::flag(std::string_view key, bool default_value) const {
  note(key, "true or false", default_value ? "true" : "false");
  if (!has(key)) return default_value;
  return or_later(default_value, [&] {
    const auto* value = table_->get(key)->as_boolean();
    if (value == nullptr) refuse_value(key, "true or false");
    return value->get();
  });
}

std::string TableReader::text(std::string_view key, std::optional<std::string> default_value) const {
  note(key, "a text", default_value ? '"' + *default_value + '"' : std::string());
  if (!has(key) && default_value) return *default_value;
  const toml::node& node = required(key, "a text");
  if (const auto* date_time = node.as_date_time()) return streamed(date_time->get());
  if (const auto* date = node.as_date()) return streamed(date->get());
  if (const auto* time = node.as_time()) return streamed(time->get());
  const auto* value = node.as_string();
  if (value == nullptr) refuse_value(key, "a text");
  if (std::any_of(value->get().begin(), value->get().end(), is_control_character))
    refuse(key, "a text with control characters", "a text on one line");
  return value->get();
}

std::vector<std::string> TableReader::texts(std::string_view key) const {
  std::vector<std::string> values;
  const std::string accepted = "an array of texts, each on one line";
  note(key, accepted, "[]");
  if (!has(key)) return values;
  const auto* array = table_->get(key)->as_array();
  if (array == nullptr) refuse_value(key, accepted);
  for (const toml::node& element : *array) {
    const auto* value = element.as_string();
    if (value == nullptr || std::any_of(value->get().begin(), value->get().end(), is_control_character))
      throw MissionError(location_of(element, file_), path_of(key), description_of(element), accepted);
    values.push_back(value->get());
  }
  return values;
}

std::string TableReader::name(std::string_view key, std::optional<std::string> default_value) const {
  const std::string default_text = default_value ? '"' + *default_value + '"' : std::string();
  const std::string value = text(key, std::move(default_value));
  note(key, std::string(kNameRule), default_text);
  if (!is_name(value)) refuse(key, "the text \"" + value + "\"", std::string(kNameRule));
  return value;
}

std::vector<double> TableReader::numbers(std::string_view key, std::size_t min_count, std::size_t max_count,
                                         Range range) const {
  const std::string count =
      std::to_string(min_count) + (max_count == min_count ? "" : " to " + std::to_string(max_count));
  const std::string accepted = "an array of " + count + " numbers " + text_of(range);
  note(key, accepted);
  return or_later(std::vector<double>(min_count, range.above ? range.high : range.low), [&] {
    const auto* array = required(key, accepted).as_array();
    if (array == nullptr || array->size() < min_count || array->size() > max_count) refuse_value(key, accepted);
    std::vector<double> values;
    for (std::size_t k = 0; k < array->size(); ++k)
      values.push_back(checked_number((*array)[k], std::string(key) + "[" + std::to_string(k) + "]", range));
    return values;
  });
}

std::vector<std::pair<double, double>> TableReader::pairs(std::string_view key, std::size_t max_count, Range first,
                                                          Range second) const {
  const std::string accepted = "an array of 1 to " + std::to_string(max_count) + " pairs of numbers: [[0.0, 60.0]]";
  note(key, accepted);
  const auto* array = required(key, accepted).as_array();
  if (array == nullptr || array->empty() || array->size() > max_count) refuse_value(key, accepted);
  std::vector<std::pair<double, double>> values;
  for (std::size_t k = 0; k < array->size(); ++k) {
    const std::string place = std::string(key) + "[" + std::to_string(k) + "]";
    const auto* pair = (*array)[k].as_array();
    if (pair == nullptr || pair->size() != 2) refuse_value(key, accepted);
    values.emplace_back(checked_number((*pair)[0], place + "[0]", first),
                        checked_number((*pair)[1], place + "[1]", second));
  }
  return values;
}

bool TableReader::is_array(std::string_view key) const {
  const toml::node* const node = find(key);
  return node != nullptr && node->is_array();
}

std::array<double, 3> TableReader::three_numbers(std::string_view key, Range range,
                                                 std::optional<std::array<double, 3>> default_value) const {
  std::array<double, 3> three = default_value.value_or(std::array<double, 3>{});
  if (has(key) || !default_value) std::ranges::copy(numbers(key, 3, 3, range), three.begin());
  if (default_value) {
    const auto& [x, y, z] = *default_value;
    note(key, "an array of 3 numbers " + text_of(range),
         "[" + text_of(x) + ", " + text_of(y) + ", " + text_of(z) + "]");
  }
  return three;
}

std::array<double, 6> TableReader::six_numbers(std::string_view key, Range range) const {
  std::array<double, 6> six{};
  std::ranges::copy(numbers(key, 6, 6, range), six.begin());
  return six;
}

fsw::Duration TableReader::span(std::string_view key, double unit_s, Range range,
                                std::optional<double> default_value) const {
  return fsw::nearest_duration(number(key, range, default_value) * unit_s);
}

std::size_t TableReader::chosen(std::string_view key, const std::vector<std::string_view>& accepted) const {
  const auto* value = required(key, listing_of(accepted)).as_string();
  if (value == nullptr) refuse_value(key, listing_of(accepted));
  const auto found = std::find(accepted.begin(), accepted.end(), value->get());
  if (found == accepted.end())
    refuse(key, description_of(*value) + did_you_mean(value->get(), accepted), listing_of(accepted));
  return static_cast<std::size_t>(found - accepted.begin());
}

std::vector<std::size_t> TableReader::chosen_several(std::string_view key,
                                                     const std::vector<std::string_view>& accepted) const {
  std::vector<std::size_t> indices;
  if (!has(key)) return indices;
  const std::string listing = several_of(accepted);
  const auto* array = table_->get(key)->as_array();
  if (array == nullptr) refuse_value(key, listing);
  for (const toml::node& element : *array) {
    const auto* name = element.as_string();
    const auto found = name == nullptr ? accepted.end() : std::find(accepted.begin(), accepted.end(), name->get());
    const auto index = static_cast<std::size_t>(found - accepted.begin());
    if (found == accepted.end() || std::find(indices.begin(), indices.end(), index) != indices.end())
      throw MissionError(location_of(element, file_), path_of(key), description_of(element), listing);
    indices.push_back(index);
  }
  return indices;
}

TableReader TableReader::table(std::string_view key) const {
  const toml::node* node = find(key);
  note(key, std::string(kTable));
  if (node == nullptr) return {book_->missing.emplace_back(), path_of(key), *this};
  if (!node->is_table()) refuse_value(key, "a table");
  TableReader inner(*node->as_table(), path_of(key), *this);
  return inner;
}

std::vector<TableReader> TableReader::tables(std::string_view key) const {
  std::vector<TableReader> readers;
  const toml::node* node = find(key);
  note(key, std::string(kTable));
  if (node == nullptr) return readers;
  const std::string accepted = "an array of tables, [[" + path_of(key) + "]]";
  const auto* array = node->as_array();
  if (array == nullptr) refuse_value(key, accepted);
  for (const toml::node& element : *array) {
    if (!element.is_table())
      throw MissionError(location_of(element, file_), path_of(key), description_of(element), accepted);
    readers.push_back({*element.as_table(), path_of(key) + "." + std::to_string(readers.size()), *this});
  }
  return readers;
}

}  // namespace vbar::mission
