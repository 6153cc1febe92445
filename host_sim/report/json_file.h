#pragma once
// JSON files that this program wrote and reads again. They may come from anywhere: what is damaged, missing or of
// another kind is answered with one sentence that names the file, the line or the key, and what is accepted.

#include <cmath>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace vbar::report {

using Json = nlohmann::ordered_json;

/// Reads a whole file. Throws std::runtime_error "FILE:LINE: ..." for one that is cut off or damaged.
[[nodiscard]] Json read_json_file(const std::filesystem::path& file);

/// An object with its place, for messages. The JSON must outlive it. All functions throw std::runtime_error.
class JsonObject {
 public:
  JsonObject(const Json& json, std::string place);

  [[noreturn]] void fail(const char* key, const std::string& what) const;

  [[nodiscard]] bool has(const char* key) const { return json_.contains(key); }
  [[nodiscard]] const Json& at(const char* key) const;

  /// `accepted`: "a text", "a list of numbers"
  template <class Value>
  [[nodiscard]] Value get(const char* key, const char* accepted) const {
    const Json& value = at(key);
    try {
      return value.get<Value>();
    } catch (const Json::exception&) {
      fail(key, fmt::format("{} is not {}", value.dump(-1, ' ', false, Json::error_handler_t::replace), accepted));
    }
  }

  [[nodiscard]] std::string text(const char* key) const { return get<std::string>(key, "a text"); }
  /// Returns `value` without the key, which older versions of this program did not write.
  [[nodiscard]] std::string text_or(const char* key, const char* value) const { return has(key) ? text(key) : value; }
  [[nodiscard]] std::vector<std::string> texts(const char* key) const {
    return get<std::vector<std::string>>(key, "a list of texts");
  }
  [[nodiscard]] bool flag(const char* key) const { return get<bool>(key, "true or false"); }
  /// Reads a number from 0 on.
  [[nodiscard]] std::size_t count(const char* key) const;
  [[nodiscard]] double number(const char* key) const;
  [[nodiscard]] std::optional<double> number_or_null(const char* key) const;
  /// Reads a number between 0 and 1, exclusive.
  [[nodiscard]] double probability(const char* key) const;

  /// Returns the readers of the elements of a list of objects.
  [[nodiscard]] std::vector<JsonObject> objects(const char* key) const;
  [[nodiscard]] JsonObject object(const char* key) const { return {at(key), place_ + ": " + key}; }

 private:
  const Json& json_;
  std::string place_;
};

}  // namespace vbar::report
