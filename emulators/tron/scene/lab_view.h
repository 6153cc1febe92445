#pragma once
// View of a camera in the emulated laboratory: true poses, lights and lens at the instant of an exposure.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "hil_drivers/tron/geometry/testbed_design.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::tron::bench {

/// Describes a link of an arm, or anything else of this shape: a cylinder with hemispherical ends.
struct Limb {
  fsw::Vector3 from_m = fsw::Vector3::Zero(), to_m = fsw::Vector3::Zero();  ///< middles of the hemispheres, L
  double radius_m = 0.05;
};

struct LampState {
  double azimuth_rad = 0.0;  ///< as Lamp::direction() takes it
  double power = 0.0;        ///< irradiance in the middle of the beam, to that at full power
};

struct LabView {
  Eigen::Isometry3d T_L_C = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_L_T = Eigen::Isometry3d::Identity();  ///< half-scale body frame of the mock-up
  std::optional<Eigen::Isometry3d> T_L_board;               ///< the calibration board hangs in place of the mock-up
  std::vector<Limb> arms;                                   ///< links of both; rod and pedestal are added
  LampState lamp;
  std::array<double, kBoxes> box_powers{};  ///< radiance, to that at full power
  twins::camera::CameraSettings camera;     ///< as it really is: lens, detector, region that is read, exposure
  std::int64_t frame = 0;                   ///< selects noise and flicker
};

/// Holds the parts of the domain gap between the laboratory and the digital twin. With all of them off the image agrees
/// with the digital twin's of the same scene.
struct GapSettings {
  bool surfaces = true;     ///< materials, seams, printed cells and uneven albedo of the mock-up
  bool shape = true;        ///< corners of the mock-up 0.5 mm off
  bool lamp = true;         ///< extended source, diverging and uneven beam, flicker; otherwise the Sun's parallel light
  bool earth_light = true;  ///< rectangles near by; otherwise a disc far away of the same irradiance vector
  bool room = true;         ///< walls, boxes, arms, rod, pedestal; their light on the target
  bool focus = true;        ///< blur away from the distance of focus
  bool detector = true;     ///< another sensor: its own fixed pattern; otherwise the non-uniformity of the settings

  [[nodiscard]] static GapSettings none() { return {false, false, false, false, false, false, false}; }
};

/// Throws std::invalid_argument, naming what is wrong, if a number of the view is not finite or not possible or a pose
/// is not a rigid one.
void check_view(const LabView& view);

}  // namespace vbar::tron::bench
