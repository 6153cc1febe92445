#pragma once
// Files that the controllers of both robots load, as driver and emulator read them.

#include <filesystem>
#include <string>

#include "hil_drivers/tron/protocols/rsi_messages.h"

namespace vbar::tron {

inline constexpr const char* kCameraRobot = "camera_robot";
inline constexpr const char* kTargetRobot = "target_robot";

/// Returns $VBAR_TRON_ROBOT if set, else this folder of the source tree that the program was built from.
[[nodiscard]] std::filesystem::path robot_directory();

/// Returns the files of kCameraRobot or kTargetRobot, in robot_directory(). Throws mission::MissionError.
[[nodiscard]] rsi::RobotFiles robot_files(const std::string& robot);

}  // namespace vbar::tron
