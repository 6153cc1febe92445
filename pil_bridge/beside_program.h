#pragma once
// Files of a build or an installation that the running program finds by their places relative to its own.

#include <filesystem>
#include <string>
#include <system_error>

#include "host_sim/files/own_program.h"

namespace vbar::pil {

/// Paths relative to the program's folder: the file of an installation if there is one, else that of a build, whether
/// or not it exists.
inline std::string beside_program(const std::filesystem::path& installed, const std::filesystem::path& built) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path here = files::own_program().parent_path();
  const bool is_installed = fs::is_regular_file(here / installed, error);
  return (here / (is_installed ? installed : built)).lexically_normal().string();
}

}  // namespace vbar::pil
