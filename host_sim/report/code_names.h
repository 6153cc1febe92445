#pragma once
// The numbers of telemetry (fsw/packets/vbar.lcm, fsw/core/result.h) in words.

#include <string>

namespace vbar::report {

[[nodiscard]] std::string mode_name(int mode);
[[nodiscard]] std::string solver_name(int solver);  ///< -1: "none"
[[nodiscard]] std::string status_name(int status);
[[nodiscard]] std::string sighting_name(int status);       ///< fsw/angles_only/sighting.h
[[nodiscard]] std::string pose_sighting_name(int status);  ///< fsw/pose/spacecraft_pose_network.h

}  // namespace vbar::report
