#pragma once
// The pose of an object of motion capture, averaged over frames at rest.

#include <vector>

#include <Eigen/Geometry>

namespace vbar::tron::vicon {

enum class ObjectState {
  kTracked,
  kSilent,    ///< too few frames
  kMissing,   ///< not in the frames
  kOccluded,  ///< all numbers are zero
  kFrozen,    ///< the numbers are those of the average before, although the object has moved since
};

struct ObjectAverage {
  ObjectState state = ObjectState::kSilent;
  int frames = 0;  ///< averaged
  Eigen::Isometry3d T_V_object = Eigen::Isometry3d::Identity();
  // Scatter of one frame about the mean, root mean square of the three axes.
  double translation_scatter_m = 0.0, rotation_scatter_rad = 0.0;
};

/// Returns mean translation and mean rotation (the one for which the rotation vectors to all others sum to zero), state
/// kTracked; without poses: kSilent.
[[nodiscard]] ObjectAverage average_of(const std::vector<Eigen::Isometry3d>& poses);

}  // namespace vbar::tron::vicon
