#pragma once
// [[limit]] of a mission, and [[pass]] of a campaign: what a number of the summary must keep.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace vbar::mission {

/// Of the number with a dotted key, e.g. waypoints.10.navigation_error_m; at least one of both is stated.
struct Limit {
  std::string key;
  std::optional<double> most, least;
};

/// Those of a mission file with what it extends, and of the overrides, "path=value"; nothing else of it is read or
/// checked. Throws MissionError.
[[nodiscard]] std::vector<Limit> load_limits(const std::filesystem::path& file, std::span<const std::string> overrides);

}  // namespace vbar::mission
