#pragma once
// The numbers of telemetry (fsw/packets/vbar.lcm, fsw/core/result.h) in words.

#include <string>
#include <vector>

namespace vbar::report {

[[nodiscard]] std::string mode_name(int mode);
[[nodiscard]] std::string solver_name(int solver);  ///< -1: "none"
/// The control solvers of the flight software, in the order of vbar.lcm.
[[nodiscard]] std::vector<int> solvers();
[[nodiscard]] std::string status_name(int status);
[[nodiscard]] std::string sighting_name(int status);       ///< fsw/angles_only/sighting.h
[[nodiscard]] std::string pose_sighting_name(int status);  ///< fsw/pose/spacecraft_pose_network.h

}  // namespace vbar::report
