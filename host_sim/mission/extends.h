#pragma once
// `extends = "other.toml"`: a mission file that says only what differs from another one.

#include <filesystem>
#include <string>

#include <toml++/toml.h>

namespace vbar::mission {

/// Replaces `document`, if it has the key `extends`, by the file it names (seen from `file`, which may extend another
/// in turn) with `document` put over it: tables key by key; a [[spacecraft]] of the same name and a [[waypoint]] of the
/// same index likewise, others are added behind; every other value, arrays included, takes the place of the old one.
/// Throws MissionError for a file that cannot be read, and for a chain of more than four.
void put_over_extended(toml::table& document, const std::filesystem::path& file);

/// The file as one that stands alone: its own text if it extends nothing, else the whole of what it says, in TOML
/// without comments. Throws MissionError as put_over_extended and for text that is no TOML.
[[nodiscard]] std::string whole_mission_text(const std::filesystem::path& file);

}  // namespace vbar::mission
