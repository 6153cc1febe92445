#include "host_sim/mission/load.h"

#include <fstream>
#include <sstream>

#include "host_sim/mission/overrides.h"
#include "host_sim/mission/read_sections.h"

namespace vbar::mission {
namespace {

toml::table parse_document(std::string_view text, const std::string& file) {
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw MissionError(file + ":" + std::to_string(error.source().begin.line), "",
                       "text that is no TOML: " + std::string(error.description()), "a TOML 1.0 document");
  }
}

std::string read_text(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw MissionError(file.string(), "", "no such file", "a mission file (TOML)");
  if (!std::filesystem::is_regular_file(status))
    throw MissionError(file.string(), "", "something that is not a file", "a mission file (TOML)");
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream || !text) throw MissionError(file.string(), "", "a file that cannot be read", "a mission file (TOML)");
  return text.str();
}

}  // namespace

Mission parse_mission(std::string_view text, const std::filesystem::path& file,
                      std::span<const std::string> overrides) {
  toml::table table = parse_document(text, file.string());
  for (const std::string& assignment : overrides) apply_override(table, assignment);

  const TableReader document(table, "", file.string());
  document.accept_only({"mission", "truth", "spacecraft", "guidance", "waypoint", "clock", "links", "lcm"});
  Mission mission;
  mission.file = file;
  read_general(document, mission);
  read_truth(document, mission);
  read_waypoints(document, mission);
  read_spacecraft(document, mission);
  read_guidance(document, mission);
  read_clock(document, mission);
  read_links(document, mission);
  read_lcm(document, mission);
  return mission;
}

Mission load_mission(const std::filesystem::path& file, std::span<const std::string> overrides) {
  return parse_mission(read_text(file), file, overrides);
}

}  // namespace vbar::mission
