#include "hil_drivers/tron/robot/robot_files.h"

#include <cstdlib>

namespace vbar::tron {

std::filesystem::path robot_directory() {
  const char* chosen = std::getenv("VBAR_TRON_ROBOT");
  return chosen == nullptr || *chosen == '\0' ? VBAR_TRON_ROBOT_DIRECTORY : chosen;
}

rsi::RobotFiles robot_files(const std::string& robot) {
  return rsi::read_robot_files(robot_directory(), robot);
}

}  // namespace vbar::tron
