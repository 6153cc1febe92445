#pragma once
// The sections of a run's report, each as HTML. One that has nothing to show is empty.

#include <string>

#include "host_sim/report/run_record.h"

namespace vbar::report {

/// What was flown, by what, how fast, and whether it came to its end (section_overview.cpp).
[[nodiscard]] std::string overview(const RunRecord& record);

/// The paper's performance metrics at each waypoint (section_waypoints.cpp).
[[nodiscard]] std::string waypoint_section(const RunRecord& record);

/// Motion of the target about the servicer, in its RTN planes (section_trajectory.cpp).
[[nodiscard]] std::string trajectory_section(const RunRecord& record);

/// Mean ROE: true, estimated, wanted (section_elements.cpp).
[[nodiscard]] std::string elements_section(const RunRecord& record);

/// Delta-v over time and all maneuvers (section_maneuvers.cpp).
[[nodiscard]] std::string maneuver_section(const RunRecord& record);

/// Errors of navigation and their claimed bounds, residuals of its measurements (section_navigation.cpp).
[[nodiscard]] std::string navigation_section(const RunRecord& record);

/// Carrier-phase navigation: beside the paper, integers, consistency (section_gnss.cpp).
[[nodiscard]] std::string gnss_section(const RunRecord& record);

/// Angles-only navigation: beside the paper, bearings, star attitude, range, pictures (section_angles_only.cpp).
[[nodiscard]] std::string angles_only_section(const RunRecord& record);

/// Navigation by the pose network: beside the paper, attitude, poses of single images, keypoints, pictures
/// (section_pose.cpp).
[[nodiscard]] std::string pose_section(const RunRecord& record);

/// True attitudes and rates (section_attitude.cpp).
[[nodiscard]] std::string attitude_section(const RunRecord& record);

/// What guidance did when, and how near the target may drift (section_guidance.cpp).
[[nodiscard]] std::string guidance_section(const RunRecord& record);

/// What the flight software counted: packets rejected and dropped, plans refused, faults (section_health.cpp).
[[nodiscard]] std::string health_section(const RunRecord& record);

/// Cost of each flight step, link, deadlines and where the wall-clock time went (section_computer.cpp).
[[nodiscard]] std::string computer_section(const RunRecord& record);

}  // namespace vbar::report
