#pragma once
// [[limit]] of a mission, and [[pass]] of a campaign: what a number of the summary must keep.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace vbar::mission {

/// Limits the number with a dotted key of the summary, e.g. waypoints.10.navigation_error_m. At least one of both
/// bounds is stated.
struct Limit {
  std::string key;
  std::optional<double> most, least;
};

/// Returns the limits of a mission file, of the files that it extends, and of the overrides, "path=value". Nothing else
/// of the mission is read or checked. Throws MissionError.
[[nodiscard]] std::vector<Limit> load_limits(const std::filesystem::path& file, std::span<const std::string> overrides);

}  // namespace vbar::mission
