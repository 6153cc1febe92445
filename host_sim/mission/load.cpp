#include "host_sim/mission/load.h"

#include "host_sim/mission/extends.h"
#include "host_sim/mission/overrides.h"
#include "host_sim/mission/read_sections.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::mission {

Mission parse_mission(std::string_view text, const std::filesystem::path& file,
                      std::span<const std::string> overrides) {
  toml::table table = parse_toml(text, file.string());
  put_over_extended(table, file);
  for (const std::string& assignment : overrides) apply_override(table, assignment);

  const TableReader document(table, "", file.string());
  document.accept_only({"mission", "truth", "spacecraft", "guidance", "gnss_navigation", "angles_only", "pose",
                        "waypoint", "burn", "constellation", "clock", "links", "lcm", "record"});
  Mission mission;
  mission.file = file;
  read_general(document, mission);
  read_truth(document, mission);
  read_waypoints(document, mission);
  read_spacecraft(document, mission);
  read_guidance(document, mission);
  read_gnss_navigation(document, mission);
  read_angles_only(document, mission);
  read_pose(document, mission);
  read_constellation(document, mission);
  read_burns(document, mission);
  read_clock(document, mission);
  read_links(document, mission);
  read_lcm(document, mission);
  read_record(document, mission);
  return mission;
}

Mission load_mission(const std::filesystem::path& file, std::span<const std::string> overrides) {
  return parse_mission(read_text_file(file, "a mission file (TOML)"), file, overrides);
}

}  // namespace vbar::mission
