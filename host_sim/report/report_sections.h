#pragma once
// The sections of a run's report. One that has nothing to show has no content.

#include <string>

#include "host_sim/report/html_page.h"
#include "host_sim/report/run_record.h"

namespace vbar::report {

/// Mission, flight software, speed and end of the run (section_overview.cpp).
[[nodiscard]] std::string overview(const RunRecord& record);

/// Distance, accuracy, aiding sources and maneuvers of the whole run (section_glance.cpp).
[[nodiscard]] Section glance_section(const RunRecord& record);
/// Faults of the scenario and of the flight software (section_faults.cpp).
[[nodiscard]] Section faults_section(const RunRecord& record);

/// The paper's performance metrics at each waypoint (section_waypoints.cpp).
[[nodiscard]] Section waypoint_section(const RunRecord& record);

/// Motion of the target about the servicer, in its RTN planes (section_trajectory.cpp).
[[nodiscard]] Section trajectory_section(const RunRecord& record);

/// Mean ROE: true, estimated, desired (section_elements.cpp).
[[nodiscard]] Section elements_section(const RunRecord& record);

/// Delta-v over time and all maneuvers (section_maneuvers.cpp).
[[nodiscard]] Section maneuver_section(const RunRecord& record);

/// Errors of navigation and the bounds that its filter claims (section_navigation.cpp).
[[nodiscard]] Section navigation_section(const RunRecord& record);

/// True attitudes and rates (section_attitude.cpp).
[[nodiscard]] Section attitude_section(const RunRecord& record);

/// Actions of guidance over time, and how near the target may drift (section_guidance.cpp).
[[nodiscard]] Section guidance_section(const RunRecord& record);

/// Counts of the flight software: packets rejected and dropped, plans rejected, faults (section_health.cpp).
[[nodiscard]] Section health_section(const RunRecord& record);

/// Cost of each flight step, link, deadlines and where the wall-clock time went (section_computer.cpp).
[[nodiscard]] Section computer_section(const RunRecord& record);

}  // namespace vbar::report
