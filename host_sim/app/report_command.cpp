// vbar report: one run, or several side by side.

#include <fmt/core.h>

#include "host_sim/app/commands.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/waypoint_table.h"

namespace vbar::app {

int report_command(const std::vector<std::filesystem::path>& run_folders) {
  for (const std::filesystem::path& folder : run_folders) fmt::print("{}", report::waypoint_table(report::read_run(folder)));
  return 0;
}

}  // namespace vbar::app
