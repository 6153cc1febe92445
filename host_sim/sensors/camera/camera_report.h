#pragma once
// Summary figures and report sections of navigation by camera.

#include <optional>
#include <string>
#include <vector>

#include "host_sim/report/extension.h"
#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/published_figures.h"
#include "host_sim/report/run_record.h"
#include "host_sim/sensors/camera/camera_rows.h"

namespace vbar::sensors {

/// Counts of the images of angles-only navigation.
struct ImageCounts {
  int images = 0;
  int with_bearing = 0;
  int with_stars = 0;     ///< whose stars were identified
  int wrong_targets = 0;  ///< images whose choice is not the target; those without truth are not evaluated
  int without_truth = 0;
  int lit_among_objects = 0;  ///< a detected object is the target, which is in sunlight at least in part
  int lit_not_found = 0;      ///< number of these without a bearing
};

/// Figures of navigation by the pose network.
struct PoseFigures {
  int images = 0;
  int with_pose = 0;                 ///< by PnP
  int poses_over_10_deg = 0;         ///< number of these more than 10 deg off
  double keypoint_error_px = 0.0;    ///< median of those usable
  double keypoint_chi_square = 0.0;  ///< median normalised squared error of those usable; 1.39 if consistent
  /// Position error over the images of a lit target alone, m.
  report::MeanAndDeviation lit_navigation_error_m;
  std::optional<double> attitude_nees;  ///< mean of attitude and rate, 6 if consistent
  int attitude_restarts = 0, restarts = 0;
  int without_truth = 0;  ///< images, not evaluated
};

/// Returns the counts and the figures of a run; none if the run has no such images.
[[nodiscard]] std::optional<ImageCounts> image_counts(const report::RunRecord& record);
[[nodiscard]] std::optional<PoseFigures> pose_figures(const report::RunRecord& record);

/// Adds the figures of images and of poses, where the run has any (camera_figures.cpp): sensor_figures "images" and
/// "pose", and the summary's own figures of attitude and bearing.
void summarise_images(const report::RunRecord& record, report::Summary& summary);

/// Returns the NEES of the orbit; NIS of the bearings or of the keypoints that the filter processed.
[[nodiscard]] std::vector<report::ConsistencyFigure> image_consistency(const report::RunRecord& record);

/// Returns the published figures of experiments 1 and 2; none for a run that does not navigate by the same measurements
/// to the same waypoints (camera_figures.cpp).
[[nodiscard]] std::vector<report::PaperColumn> camera_paper_columns(const report::RunRecord& record);

// In section_angles_only.cpp.
/// Returns the errors at the waypoints and delta-v as HTML; the paper's figures below those of a run that meets its
/// waypoints.
[[nodiscard]] std::string angles_only_performance(const report::RunRecord& record);

/// Makes the section of angles-only navigation: beside the paper, bearings, star attitude, range, pictures
/// (section_angles_only.cpp).
[[nodiscard]] report::Section angles_only_section(const report::RunRecord& record);

/// Makes the section of navigation by the pose network: beside the paper, attitude, poses of single images, keypoints,
/// pictures (section_pose.cpp).
[[nodiscard]] report::Section pose_section(const report::RunRecord& record);

}  // namespace vbar::sensors
