#pragma once
// Files of a folder that may have come from elsewhere: a symbolic link in it must not direct a write or a removal to
// what it names.

#include <filesystem>

namespace vbar::files {

/// Removes `file` if it is a symbolic link, so that what is opened or written under this name next is in its own
/// folder. Throws std::runtime_error that names the link if it cannot be removed.
void remove_link(const std::filesystem::path& file);

}  // namespace vbar::files
