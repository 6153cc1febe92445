#include "host_sim/campaign/value_text.h"

#include <array>
#include <charconv>
#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/mission/table_reader.h"

namespace vbar::campaign {
namespace {

/// A text that --set takes for a text without its quotes.
bool is_plain(const std::string& text) {
  const bool is_word = text == "true" || text == "false" || text == "inf" || text == "nan";
  const bool begins_with_letter = !text.empty() && ((text[0] | 0x20) >= 'a' && (text[0] | 0x20) <= 'z');
  return mission::is_name(text) && begins_with_letter && !is_word;
}

/// TOML's basic strings have the escapes of JSON.
std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string inner_text(const toml::node& value) {
  return value.is_string() ? quoted(value.as_string()->get()) : text_of(value);
}

std::string text_of_array(const toml::array& array) {
  std::string text;
  for (const toml::node& element : array) text += (text.empty() ? "" : ", ") + inner_text(element);
  return "[" + text + "]";
}

std::string text_of_table(const toml::table& table) {
  std::string text;
  for (const auto& [key, element] : table)
    text += (text.empty() ? " " : ", ") + quoted(std::string(key.str())) + " = " + inner_text(element);
  return text.empty() ? "{}" : "{" + text + " }";
}

template <class Value>
std::string streamed(const Value& value) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << value;
  return out.str();
}

}  // namespace

std::string text_of(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  std::string text(digits.data(), end);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";  // else TOML reads an integer
  return text;
}

std::string text_of(const toml::node& value) {
  switch (value.type()) {
    case toml::node_type::string: {
      const std::string& text = value.as_string()->get();
      return is_plain(text) ? text : quoted(text);
    }
    case toml::node_type::integer:
      return fmt::format("{}", value.as_integer()->get());
    case toml::node_type::floating_point:
      return text_of(value.as_floating_point()->get());
    case toml::node_type::boolean:
      return value.as_boolean()->get() ? "true" : "false";
    case toml::node_type::array:
      return text_of_array(*value.as_array());
    case toml::node_type::table:
      return text_of_table(*value.as_table());
    case toml::node_type::date:
      return streamed(*value.as_date());
    case toml::node_type::time:
      return streamed(*value.as_time());
    case toml::node_type::date_time:
      return streamed(*value.as_date_time());
    case toml::node_type::none:
      break;
  }
  return {};
}

}  // namespace vbar::campaign
