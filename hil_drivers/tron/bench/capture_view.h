#pragma once
// Objects that motion capture can track at a posture: markers on camera and mock-up, hidden by arms and bodies.

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "hil_drivers/tron/bench/vicon/capture_errors.h"
#include "hil_drivers/tron/bench/world/vicon_visibility.h"
#include "hil_drivers/tron/bench/world/world.h"
#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/kinematics/posture.h"

namespace vbar::tron::bench {

class CaptureView {
 public:
  CaptureView(const BenchFile& laboratory, const World& world);

  /// Returns the number of markers located, of camera and target.
  [[nodiscard]] std::array<std::size_t, kCaptureObjects> located(const Posture& posture) const;
  /// Returns the links of both arms, where they really are.
  [[nodiscard]] std::vector<Capsule> arms(const Posture& posture) const;
  /// Returns the true pose of the camera, or of the plate's mock-up whatever hangs there; nothing if it is not tracked.
  [[nodiscard]] std::optional<Eigen::Isometry3d> tracked(CaptureObject object, const Posture& posture) const;

 private:
  struct Object {
    std::vector<Marker> markers;
    fsw::Vector3 low_m, high_m;  ///< box of the body that hides
  };
  [[nodiscard]] Eigen::Isometry3d T_L_body(CaptureObject object, const Posture& posture) const;
  [[nodiscard]] std::size_t located(CaptureObject object, const Posture& posture) const;

  const BenchFile& laboratory_;
  const World& world_;
  ViconVisibility cameras_;
  std::array<Object, kCaptureObjects> objects_;
};

}  // namespace vbar::tron::bench
