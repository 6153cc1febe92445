#include "host_sim/mission/load.h"

#include "host_sim/mission/extends.h"
#include "host_sim/mission/overrides.h"
#include "host_sim/mission/read_sections.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::mission {
namespace {

/// A table or an array of tables of the document.
struct Section {
  const char* name;
  void (*read)(const TableReader& document, Mission& mission, const Installation& installation);
};

template <auto read>
void without_installation(const TableReader& document, Mission& mission, const Installation& /*installation*/) {
  read(document, mission);
}

/// In the order of reading, because later ones depend on the results of earlier ones.
constexpr Section kSections[] = {{"mission", without_installation<read_general>},
                                 {"truth", read_truth},
                                 {"testbed", read_testbeds},
                                 {"waypoint", without_installation<read_waypoints>},
                                 {"spacecraft", read_spacecraft},
                                 {"guidance", without_installation<read_guidance>},
                                 {"safety", without_installation<read_safety>},
                                 {"navigation", read_shared},
                                 {"burn", without_installation<read_burns>},
                                 {"fault", without_installation<read_faults>},
                                 {"clock", read_clock},
                                 {"links", without_installation<read_links>},
                                 {"lcm", without_installation<read_lcm>},
                                 {"record", without_installation<read_record>},
                                 {"limit", without_installation<read_limits>}};

template <class Use>
void with_document(std::string_view text, const std::filesystem::path& file, std::span<const std::string> overrides,
                   const Installation& installation, const Use& use) {
  toml::table table = parse_toml(text, file.string());
  put_over_extended(table, file);
  for (const std::string& assignment : overrides) apply_override(table, assignment);

  const TableReader document(table, file.string());
  for (const Section& section : kSections) static_cast<void>(document.has(section.name));
  for (const SensorReader* const kind : installation.kinds)
    if (!kind->table.empty()) static_cast<void>(document.has(kind->table));
  if (document.has("extends")) document.refuse_value("extends", "nothing here: it is resolved before any --set");
  document.refuse_unknown_keys();
  Mission mission;
  mission.file = file;
  for (const Section& section : kSections) section.read(document, mission, installation);
  document.finish();
  mission.data_files = document.data_files();
  use(document, std::move(mission));
}

}  // namespace

Mission parse_mission(std::string_view text, const std::filesystem::path& file, std::span<const std::string> overrides,
                      const Installation& installation) {
  Mission loaded;
  with_document(text, file, overrides, installation,
                [&](const TableReader& /*document*/, Mission mission) { loaded = std::move(mission); });
  return loaded;
}

Mission load_mission(const std::filesystem::path& file, std::span<const std::string> overrides,
                     const Installation& installation) {
  return parse_mission(read_text_file(file, "a mission file (TOML)"), file, overrides, installation);
}

std::map<std::string, std::vector<AcceptedKey>> accepted_keys(const std::filesystem::path& file,
                                                              std::span<const std::string> overrides,
                                                              const Installation& installation) {
  std::map<std::string, std::vector<AcceptedKey>> keys;
  with_document(read_text_file(file, "a mission file (TOML)"), file, overrides, installation,
                [&](const TableReader& document, const Mission& /*mission*/) { keys = document.asked_of_all(); });
  return keys;
}

}  // namespace vbar::mission
