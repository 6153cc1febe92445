#include "host_sim/mission/toml_file.h"

#include <fstream>
#include <iterator>

#include "host_sim/files/data_stream.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/toml_depth.h"

namespace vbar::mission {

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
  std::ifstream stream(file, std::ios::binary);
  // Not `<< stream.rdbuf()`, which fails for an empty file.
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream.is_open() || stream.bad()) throw MissionError(file.string(), "", "a file that cannot be read", kind);
  return text;
}

}  // namespace vbar::mission
