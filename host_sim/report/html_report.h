#pragma once
// report.html: a run as an engineer judges it, in one file that opens from disk.

#include <filesystem>
#include <string>

#include "host_sim/report/run_record.h"

namespace vbar::report {

[[nodiscard]] std::string html_report(const RunRecord& record);

/// Writes report.html into the run's folder and returns where. Throws std::runtime_error that names the file.
std::filesystem::path write_html_report(const std::filesystem::path& run_folder, const RunRecord& record);

}  // namespace vbar::report
