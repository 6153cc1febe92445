#include "host_sim/mission/data_directory.h"

#include <cstdlib>
#include <stdexcept>

#include "host_sim/files/own_program.h"

namespace vbar::mission {

namespace {

/// Returns the data folder of an installation, which lies beside the folder of the running program.
std::filesystem::path installed_data() {
  std::error_code error;
  const std::filesystem::path program = files::own_program();
  const std::filesystem::path folder = program.parent_path().parent_path() / "share/vbar/data";
  return !program.empty() && std::filesystem::is_directory(folder, error) ? folder : std::filesystem::path();
}

}  // namespace

std::filesystem::path data_directory() {
  const char* const chosen = std::getenv("VBAR_DATA");
  const std::filesystem::path installed = chosen == nullptr ? installed_data() : std::filesystem::path();
  const std::filesystem::path folder = chosen != nullptr ? chosen : installed.empty() ? VBAR_DATA_DIRECTORY : installed;
  if (!std::filesystem::is_directory(folder)) {
    throw std::runtime_error(folder.string() + ": no such data folder; set VBAR_DATA to the project's data folder");
  }
  return folder;
}

}  // namespace vbar::mission
