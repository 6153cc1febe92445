#include "host_sim/mission/data_file.h"

#include <string>

namespace vbar::mission {
namespace {

std::filesystem::path resolved(const TableReader& section, std::string_view key, const std::string& text,
                               const Mission& mission) {
  if (text.empty()) section.refuse_value(key, "a file of the data folder, or one seen from the mission file (./...)");
  if (!text.starts_with("./") && !text.starts_with("../")) return text;
  return std::filesystem::absolute(mission.file).parent_path() / text;
}

}  // namespace

std::filesystem::path data_file(const TableReader& section, std::string_view key,
                                const std::filesystem::path& default_value, const Mission& mission) {
  return resolved(section, key, section.text(key, default_value.string()), mission);
}

std::vector<std::filesystem::path> data_files(const TableReader& section, std::string_view key,
                                              const Mission& mission) {
  std::vector<std::filesystem::path> files;
  for (const std::string& text : section.texts(key)) files.push_back(resolved(section, key, text, mission));
  return files;
}

}  // namespace vbar::mission
