#pragma once
// `extends = "other.toml"`, or an array of files: a mission file that states only the differences from others.

#include <filesystem>
#include <string>

#include <toml++/toml.h>

namespace vbar::mission {

/// Returns the name of a mission that does not state it: that of its file, in which letters that no name can have
/// become '_'.
[[nodiscard]] std::string name_of_file(const std::filesystem::path& file);

/// Replaces `document`, if it has the key `extends`, by the file that this key names, with `document` put over that
/// file. The name is relative to `file`, or that of a mission of the catalogue; the file may extend another one in
/// turn. If the key names several files, each is put over those before it. Tables are merged key by key, and so are a
/// [[spacecraft]] of the same name and a [[waypoint]] of the same index; other elements of these arrays are appended.
/// Every other value, arrays included, replaces the old one and the keys that it excludes (drop_alternatives). The name
/// of the extended mission is not adopted. Throws MissionError for a file that cannot be read, and for a chain of more
/// than four files.
void put_over_extended(toml::table& document, const std::filesystem::path& file);

/// Returns the text of a file without dependence on others: its own text if it extends nothing, else its merged
/// content, in TOML without comments. Throws MissionError as put_over_extended and for invalid TOML.
[[nodiscard]] std::string whole_mission_text(const std::filesystem::path& file);

}  // namespace vbar::mission
