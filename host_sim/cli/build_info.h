#pragma once
// Version, commit, compiler and build type of this program.

#include <string>

namespace vbar::app {

extern const char* const
    kBuildCommit;  ///< commit of the source tree, "+" behind it if files were changed; "unknown" outside git

/// "0.3.0"
[[nodiscard]] std::string build_version();
/// e.g. "GCC 12.2.0"
[[nodiscard]] std::string build_compiler();
/// e.g. "Release", with the sanitizers if there are any
[[nodiscard]] std::string build_type();

}  // namespace vbar::app
