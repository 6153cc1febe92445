#include <algorithm>

#include <fmt/core.h>

#include "host_sim/app/commands.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/mission/catalogue.h"
#include "host_sim/sensors/sensor_kinds.h"

namespace vbar::app {

int missions_command(const std::filesystem::path& folder_or_mission) {
  std::error_code error;
  std::vector<mission::CatalogueEntry> entries;
  if (folder_or_mission.empty() || std::filesystem::is_directory(folder_or_mission, error)) {
    entries = mission::list_missions(folder_or_mission.empty() ? mission::missions_directory() : folder_or_mission,
                                     sensors::installation());
  } else {
    const mission::Installation installation = sensors::installation();
    entries = {mission::entry_of(mission::find_mission(folder_or_mission, installation), installation)};
  }
  std::size_t width = 0;
  for (const mission::CatalogueEntry& entry : entries) width = std::max(width, entry.name.size());
  for (const mission::CatalogueEntry& entry : entries) fmt::print("{}\n", mission::line_of(entry, width));
  return std::ranges::all_of(entries, &mission::CatalogueEntry::good) ? kDone : kFailed;
}

}  // namespace vbar::app
