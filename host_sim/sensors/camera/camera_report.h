#pragma once
// Summary figures and report sections of navigation by camera.

#include "host_sim/report/html_page.h"
#include "host_sim/report/run_record.h"

namespace vbar::sensors {

/// Of images and of poses, where the run has any (summarise_images.cpp).
void summarise_images(const report::RunRecord& record, report::Summary& summary);

/// Angles-only navigation: beside the paper, bearings, star attitude, range, pictures (section_angles_only.cpp).
[[nodiscard]] report::Section angles_only_section(const report::RunRecord& record);

/// Navigation by the pose network: beside the paper, attitude, poses of single images, keypoints, pictures
/// (section_pose.cpp).
[[nodiscard]] report::Section pose_section(const report::RunRecord& record);

}  // namespace vbar::sensors
