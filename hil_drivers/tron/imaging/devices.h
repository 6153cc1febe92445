#pragma once
// Interfaces of devices and planning to the exchange of a scene for an image.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "hil_drivers/tron/geometry/kinematics.h"
#include "hil_drivers/tron/geometry/testbed_design.h"

namespace vbar::tron {

// Content of an image: relative pose and lighting, in the camera's axes.

struct Scene {
  Eigen::Isometry3d T_C_T = Eigen::Isometry3d::Identity();  ///< target in the camera, laboratory lengths
  fsw::Vector3 sun_C = fsw::Vector3::UnitZ();               ///< unit
  fsw::Vector3 earth_C = fsw::Vector3::UnitY();             ///< to the middle of its light, unit
  double earth_half_angle = 1.1;                            ///< angular radius of its disc, rad
  double earth_to_sun = 0.0;  ///< irradiance of an area that faces the Earth to that of one that faces the Sun
  double sunlit = 1.0;        ///< visible fraction of the Sun's disc
};

/// Holds the commanded posture and the lamp's place.
struct Place {
  Posture posture;
  double lamp_azimuth_rad = 0.0;
  double sun_error_rad = 0.0;  ///< error of the direction to the lamp
  int hidden = 0;              ///< keypoints and centre that the arm hides
  int shaded = 0;              ///< lit points of the hull, four a face, in the shadow of an arm
};

/// States why there is no placement or path, one sentence.
struct PlacementFailure {
  std::string reason;
};

class MotionPlanner {
 public:
  MotionPlanner() = default;
  MotionPlanner(const MotionPlanner&) = delete;
  MotionPlanner& operator=(const MotionPlanner&) = delete;
  virtual ~MotionPlanner() = default;

  [[nodiscard]] virtual std::variant<Place, PlacementFailure> place(const Scene& scene, const Posture& from,
                                                                    std::int64_t image) = 0;
  /// Returns a path free of collisions; if there is nothing to move, a motion of no cycles.
  [[nodiscard]] virtual std::variant<Motion, PlacementFailure> path(const Posture& from, const Posture& to) = 0;
  /// Returns the posture near `from` whose relative pose by the calibrated arms is `T_C_T`.
  [[nodiscard]] virtual std::optional<Posture> corrected(const Posture& from, const Eigen::Isometry3d& T_C_T) = 0;
};

/// Holds powers from 0 to 1, of light, not of the DMX value.
struct LightLevels {
  double lamp_power = 0.0;
  double lamp_azimuth_rad = 0.0;
  std::array<double, kBoxes> box_power{};
  std::optional<double> earth_misfit;  ///< rms over the normals, relative to the largest irradiance of the Earth
};

class LightPlanner {
 public:
  LightPlanner() = default;
  LightPlanner(const LightPlanner&) = delete;
  LightPlanner& operator=(const LightPlanner&) = delete;
  virtual ~LightPlanner() = default;

  [[nodiscard]] virtual LightLevels levels(const Scene& scene, const Place& place) = 0;
};

/// Holds poses of the objects of motion capture in its frame, averaged at rest.
struct CapturedPoses {
  Eigen::Isometry3d T_V_camera = Eigen::Isometry3d::Identity(), T_V_target = Eigen::Isometry3d::Identity();
};

struct MeasuredPlace {
  Posture posture;                       ///< at rest, through Ethernet KRL
  std::optional<CapturedPoses> capture;  ///< none: hidden, frozen, silent
};

struct DetectorFrame {
  std::vector<std::uint16_t> dn;  ///< pixels of the region, rows from the top
  std::int64_t packets_resent = 0;
  int tries = 1;
};

/// Gives access to the devices of a testbed. All functions throw std::runtime_error, one sentence that names the
/// device, if the testbed cannot go on.
class Laboratory {
 public:
  Laboratory() = default;
  Laboratory(const Laboratory&) = delete;
  Laboratory& operator=(const Laboratory&) = delete;
  virtual ~Laboratory() = default;

  [[nodiscard]] virtual Posture posture() = 0;
  virtual MotionEnd follow(const Motion& motion) = 0;
  virtual MotionEnd hold(double bench_s) = 0;
  /// Recovers the robots after kInterrupted.
  virtual void recover() = 0;
  /// Measures the poses by arms and motion capture, at rest.
  virtual std::variant<MeasuredPlace, MotionEnd> measure() = 0;
  /// Sends the levels; hold() until they act.
  virtual void light(const LightLevels& levels) = 0;
  virtual DetectorFrame take(double exposure_s) = 0;
  [[nodiscard]] virtual double time_s() const = 0;  ///< bench time
};

}  // namespace vbar::tron
