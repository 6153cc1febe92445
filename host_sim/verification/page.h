#pragma once
// Figures of a verification.json in pages: docs/verification.md as a whole, and in other pages what stands between
// markers.
//
//     3.8<!-- v:experiment3 navigation_error_mean_m median x1000 .1 -->
//
// a figure: row, quantity, statistic (median, p90, worst, n, seeds), factor, decimals;
//
//     8.7<!-- v:paper table_10.sil.whole.navigation_error_mean_m cell x1000 .1 -->
//
// a cell of host_sim/report/paper_results.h;
//
//     <!-- v:table experiment3 -->
//     ...
//     <!-- v:end -->
//
// the table of a row.

#include <filesystem>
#include <string>

#include "host_sim/verification/record.h"

namespace vbar::verification {

/// Returns the page as a whole, in Markdown.
[[nodiscard]] std::string verification_page(const Json& verification);

/// Returns a page with all its marked figures and tables as the verification has them; "not flown" where it has none.
/// Throws std::runtime_error that names `file`, line and marker for an unknown row, quantity or statistic.
[[nodiscard]] std::string with_figures(const std::string& text, const Json& verification, const std::string& file);

/// Writes `docs`/verification.md and the figures of the other pages of `docs` and of README.md beside it. Returns the
/// names of the files that have changed.
std::vector<std::filesystem::path> write_pages(const Json& verification, const std::filesystem::path& docs);

}  // namespace vbar::verification
