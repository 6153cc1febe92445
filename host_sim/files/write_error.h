#pragma once
// One sentence about a file that could not be written.

#include <filesystem>
#include <stdexcept>

namespace vbar::files {

/// "FILE: cannot be written: REASON", with the system's reason in errno, e.g. "No space left on device". Set errno to 0
/// before the attempt.
[[nodiscard]] std::runtime_error write_error(const std::filesystem::path& file);

}  // namespace vbar::files
