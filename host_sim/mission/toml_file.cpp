#include "host_sim/mission/toml_file.h"

#include <optional>
#include <utility>
#include <vector>

#include "host_sim/files/data_stream.h"
#include "host_sim/files/output_file.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::mission {

namespace {

/// Follows brackets, dots and strings; values are of no interest.
class DepthScan {
 public:
  explicit DepthScan(std::string_view text) : text_(text) {}

  std::optional<std::size_t> line_too_deep() {
    while (at_ < text_.size()) {
      take(text_[at_]);
      if (outer() + names_ > kTomlDepthMax) return line_;
    }
    return std::nullopt;
  }

 private:
  /// Depth of what surrounds the present key or value.
  [[nodiscard]] std::size_t outer() const { return open_.empty() ? header_ : open_.back(); }

  void take(char c) {
    switch (c) {
      case '"':
      case '\'':
        skip_string(c);
        is_line_start_ = false;
        return;
      case '#':
        at_ = text_.substr(0, text_.find('\n', at_)).size();
        return;
      case '\n':
        end_line();
        break;
      case '.':
        ++names_;
        break;
      case ',':
        names_ = 1;
        break;
      case '[':
        is_line_start_&& open_.empty() ? begin_header() : open();
        break;
      case '{':
        open();
        break;
      case ']':
      case '}':
        close();
        break;
      default:
        break;
    }
    if (c != ' ' && c != '\t' && c != '\n' && c != '\r') is_line_start_ = false;
    ++at_;
  }

  void begin_header() {
    header_ = 0;
    names_ = 1;
    in_header_ = true;
    if (at_ + 1 < text_.size() && text_[at_ + 1] == '[') ++at_;  // header of an array of tables
  }

  void open() {
    open_.push_back(outer() + names_ + 1);
    names_ = 1;
  }

  void close() {
    if (in_header_) return;  // the names of a header count to the end of its line
    if (!open_.empty()) open_.pop_back();
    names_ = 1;
  }

  void end_line() {
    ++line_;
    is_line_start_ = true;
    if (in_header_) header_ = names_;
    in_header_ = false;
    names_ = 1;
  }

  /// Whether three quotes begin here.
  [[nodiscard]] bool has_three(char quote) const {
    const std::string_view three = text_.substr(at_, 3);
    return three.size() == 3 && three.find_first_not_of(quote) == std::string_view::npos;
  }

  void skip_string(char quote) {
    const bool is_long = has_three(quote);
    at_ += is_long ? 3 : 1;
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n') {
        if (!is_long) return;  // not closed: the parser rejects it
        ++line_;
      }
      if (c == '\\' && quote == '"') {
        ++at_;
        if (at_ < text_.size() && text_[at_] == '\n') ++line_;
      } else if (c == quote && (!is_long || has_three(quote))) {
        at_ += is_long ? 3 : 1;
        return;
      }
    }
  }

  std::string_view text_;
  std::size_t at_ = 0, line_ = 1;
  std::size_t header_ = 0;         ///< depth of the table that the last header names
  std::size_t names_ = 1;          ///< number of names of the present dotted key; dots of numbers count as well
  std::vector<std::size_t> open_;  ///< depth within each open bracket
  bool is_line_start_ = true, in_header_ = false;
};

}  // namespace

std::optional<std::size_t> line_too_deep(std::string_view text) {
  return DepthScan(text).line_too_deep();
}

toml::table parse_toml(std::string_view text, const std::string& file) {
  if (const auto line = line_too_deep(text))
    throw MissionError(file + ":" + std::to_string(*line), "",
                       "tables nested deeper than " + std::to_string(kTomlDepthMax) + " levels",
                       "at most that many dotted names, inline tables and arrays within each other");
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw MissionError(file + ":" + std::to_string(error.source().begin.line), "",
                       "invalid TOML: " + std::string(error.description()), "a TOML 1.0 document");
  }
}

std::string read_data_text(const std::filesystem::path& file, const std::string& kind) {
  std::string text = read_text_file(file, kind);
  files::note_file_read(file, text);
  return text;
}

std::string read_text_file(const std::filesystem::path& file, const std::string& kind) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw MissionError(file.string(), "", "no such file", kind);
  if (!std::filesystem::is_regular_file(status))
    throw MissionError(file.string(), "", "something that is not a file", kind);
  std::optional<std::string> text = files::contents_of(file);
  if (!text) throw MissionError(file.string(), "", "a file that cannot be read", kind);
  return *std::move(text);
}

}  // namespace vbar::mission
