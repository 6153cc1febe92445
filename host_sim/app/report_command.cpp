// vbar report: one run, or several side by side.

#include <fmt/core.h>

#include "host_sim/app/commands.h"
#include "host_sim/report/compare_report.h"
#include "host_sim/report/html_report.h"
#include "host_sim/report/run_folder.h"

namespace vbar::app {

int report_command(const std::vector<std::filesystem::path>& run_folders) {
  return 0;
}

}  // namespace vbar::app
