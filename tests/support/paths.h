#pragma once
// Absolute paths of files that tests read. They are compiled into one source file only, so that the compiler cache
// serves every checkout of the project with the objects of all other test sources.

#include <string>

namespace vbar::tests {

/// Path of `relative` in the source tree; the root of the tree if empty.
std::string source_path(const std::string& relative = {});

/// Path of `relative` in the build tree; the root of the tree if empty.
std::string build_path(const std::string& relative = {});

}  // namespace vbar::tests
