#include <algorithm>

#include <fmt/core.h>

#include "host_sim/app/commands.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/mission/catalogue.h"
#include "host_sim/sensors/sensor_kinds.h"

namespace vbar::app {

int missions_command(const std::filesystem::path& folder) {
  const std::vector<mission::CatalogueEntry> entries =
      mission::list_missions(folder.empty() ? mission::missions_directory() : folder, sensors::installation());
  std::size_t width = 0;
  for (const mission::CatalogueEntry& entry : entries) width = std::max(width, entry.name.size());
  for (const mission::CatalogueEntry& entry : entries) fmt::print("{}\n", mission::line_of(entry, width));
  return std::ranges::all_of(entries, &mission::CatalogueEntry::good) ? kDone : kFailed;
}

}  // namespace vbar::app
