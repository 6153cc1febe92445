#pragma once
// Whole text files, for files that are either there as meant or not at all.

#include <filesystem>
#include <string>
#include <string_view>

namespace vbar::files {

/// Throws std::runtime_error that names the file.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file);

/// Returns the path that replace_text_file writes before it renames; a kill can leave it.
[[nodiscard]] std::filesystem::path neighbour_of(const std::filesystem::path& file);

/// Writes a neighbour and renames it, so that `file` never holds half of `text`. Throws std::runtime_error that names
/// the file; what was there before then still is.
void replace_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace vbar::files
