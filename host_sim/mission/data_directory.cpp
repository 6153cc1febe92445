#include "host_sim/mission/data_directory.h"

#include <cstdlib>
#include <stdexcept>

namespace vbar::mission {

std::filesystem::path data_directory() {
  const char* chosen = std::getenv("VBAR_DATA");
  const std::filesystem::path folder = chosen != nullptr ? chosen : VBAR_DATA_DIRECTORY;
  if (!std::filesystem::is_directory(folder)) {
    throw std::runtime_error(folder.string() + ": no such data folder; set VBAR_DATA to the project's data folder");
  }
  return folder;
}

}  // namespace vbar::mission
