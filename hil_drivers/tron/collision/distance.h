#pragma once
// Distances of segments from segments and boxes.

#include <Eigen/Geometry>

#include "fsw/core/types.h"

namespace vbar::tron {

/// Holds all points within `radius_m` of a segment.
struct Capsule {
  fsw::Vector3 from = fsw::Vector3::Zero(), to = fsw::Vector3::Zero();
  double radius_m = 0.0;
};

struct OrientedBox {
  Eigen::Isometry3d T_L_box = Eigen::Isometry3d::Identity();  ///< origin in its middle, axes along its edges
  fsw::Vector3 half_m = fsw::Vector3::Zero();
};

/// Returns the distance between two segments (Ericson 2004, section 5.1.9).
[[nodiscard]] double segment_distance(const fsw::Vector3& a_from, const fsw::Vector3& a_to, const fsw::Vector3& b_from,
                                      const fsw::Vector3& b_to);
/// Returns the distance of a segment from a box; 0 if it enters the box. The error is 1e-6 of the segment's length.
[[nodiscard]] double box_distance(const fsw::Vector3& from, const fsw::Vector3& to, const OrientedBox& box);

}  // namespace vbar::tron
