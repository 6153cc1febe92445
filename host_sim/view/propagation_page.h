#pragma once
// The page of a propagation (vbar propagate): orbits over time, and the motion of the second spacecraft relative to the
// first one.

#include <filesystem>
#include <string>
#include <string_view>

namespace vbar::view {

/// Returns whether the folder holds a propagation, and not a run.
[[nodiscard]] bool is_propagation(const std::filesystem::path& folder);

/// Returns the page of a complete propagation. The ephemerides are read part by part, as those of a month at steps of a
/// second are 2 GB; of more than 20,000 rows the page has those in which a column has an extreme in its part, as that
/// of a run. Throws std::runtime_error that names the file and the line.
[[nodiscard]] std::string propagation_page(const std::filesystem::path& folder, std::string_view name);

}  // namespace vbar::view
