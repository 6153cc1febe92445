#pragma once
// Visibility of objects to the cameras of motion capture. Twelve cameras under the ceiling, six along each side wall.
// An object carries markers; a marker is located by the cameras in whose field it is and whose line of sight no arm, no
// body and no plate crosses; an object is tracked with three markers.

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "hil_drivers/tron/geometry/testbed_design.h"

namespace vbar::tron::bench {

/// Describes a body that hides markers: a line with a radius, L.
struct Capsule {
  fsw::Vector3 from = fsw::Vector3::Zero(), to = fsw::Vector3::Zero();
  double radius_m = 0.0;
};

/// Describes a body that hides markers: a box about the origin of its frame.
struct Block {
  Eigen::Isometry3d T_L_block = Eigen::Isometry3d::Identity();
  fsw::Vector3 low_m = fsw::Vector3::Zero(), high_m = fsw::Vector3::Zero();
};

struct Marker {
  fsw::Vector3 at_m = fsw::Vector3::Zero();     ///< in the object's body frame
  fsw::Vector3 normal = fsw::Vector3::UnitZ();  ///< away from the surface
};

class ViconVisibility {
 public:
  static constexpr std::size_t kCameras = 12;
  static constexpr std::size_t kMinCameras = 2;  ///< cameras that see a marker
  static constexpr std::size_t kMinMarkers = 3;  ///< markers located of an object

  explicit ViconVisibility(const TestbedDesign& laboratory);

  /// Returns the number of markers located by at least kMinCameras.
  [[nodiscard]] std::size_t located(const Eigen::Isometry3d& T_L_object, const std::vector<Marker>& markers,
                                    const std::vector<Capsule>& capsules, const std::vector<Block>& blocks) const;

  [[nodiscard]] const std::array<fsw::Vector3, kCameras>& cameras() const { return cameras_; }

 private:
  std::array<fsw::Vector3, kCameras> cameras_;
};

/// Returns markers on the corners of a box and the middles of its faces.
[[nodiscard]] std::vector<Marker> markers_of_box(const fsw::Vector3& low_m, const fsw::Vector3& high_m);

/// Returns true if the segment passes through the body.
[[nodiscard]] bool crosses(const fsw::Vector3& from, const fsw::Vector3& to, const Capsule& capsule);
[[nodiscard]] bool crosses(const fsw::Vector3& from, const fsw::Vector3& to, const Block& block);

}  // namespace vbar::tron::bench
