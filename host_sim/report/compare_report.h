#pragma once
// A page with several runs side by side: the comparison's table, delta-v and ROE of all runs in the same plots.

#include <filesystem>
#include <span>
#include <string>

#include "host_sim/report/comparison.h"

namespace vbar::report {

/// Returns the page of at least one run.
[[nodiscard]] std::string html_comparison(std::span<const ComparedRun> runs);

/// Throws std::runtime_error that names the file.
void write_html_comparison(const std::filesystem::path& file, std::span<const ComparedRun> runs);

}  // namespace vbar::report
