#pragma once
// The laboratory as designed: two arms, track, mounts, lamp, light boxes, camera, motion capture, addresses and limits
// (data/benches/tron.toml, where each number has its source). What a testbed really is differs from it by the errors
// that calibration finds.
//
// Laboratory frame L: x along the track, z up, origin on the floor in a corner of the end wall, y = 0 in the middle.
// T_A_B (Eigen::Isometry3d) takes coordinates in B to coordinates in A.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/types.h"

namespace vbar::tron {

inline constexpr std::size_t kJoints = 6;
inline constexpr std::size_t kBoxes = 10;

struct AxisLimits {
  double lower = 0.0, upper = 0.0;  ///< rad (m of the track)
  double speed = 0.0;               ///< rad/s (m/s)
  double acceleration = 0.0;        ///< rad/s2 (m/s2)
  double jerk = 0.0;                ///< rad/s3 (m/s3)
};

/// Describes an arm of six axes with a spherical wrist, of KUKA's kind. At zero angles it is stretched along base x,
/// and the frames of all links are parallel to the base's. A1 turns about -z at height d1; A2 about +y, a1 before A1;
/// A3 about +y, a2 along the upper arm; A4 about -x, a3 above A3; A5 about +y and A6 about -x at the wrist, d4 along
/// the forearm; the flange is d6 from the wrist. Flange frame: z away from the wrist, x down at zero angles
/// (R_base_flange = [0 0 1; 0 1 0; -1 0 0], rotation of 90 deg about y).
struct ArmDesign {
  std::string type;  ///< designation of the manufacturer
  double d1_m = 0.0, a1_m = 0.0, a2_m = 0.0, a3_m = 0.0, d4_m = 0.0, d6_m = 0.0;
  std::array<AxisLimits, kJoints> axes{};
  /// Radii of the capsules that stand for its bodies in collision checks: column (base to A2), upper arm, forearm,
  /// wrist.
  std::array<double, 4> body_radius_m{};
};

/// Holds the place and rotation of an arm's base.
struct BasePose {
  fsw::Vector3 position_m =
      fsw::Vector3::Zero();  ///< place of the base, L; for the arm on the track, with the carriage at 0
  fsw::Vector3 rpy_rad = fsw::Vector3::Zero();  ///< R_L_base = Rz(yaw) Ry(pitch) Rx(roll), given as roll, pitch, yaw
  [[nodiscard]] Eigen::Isometry3d T_L_base() const;
};

/// Names the face of the target by which the flange holds it; the flange's z goes into the body through it.
enum class MountFace { kMinusX, kPlusX, kMinusY, kPlusY, kBottom, kTop };

struct TargetMount {
  std::string model = "tango";  ///< CAD model and keypoints, at full scale
  MountFace face = MountFace::kBottom;
  double stand_off_m = 0.25;   ///< from the flange to the face
  double roll_rad = 0.0;       ///< rotation of the body about the flange's z
  double rod_radius_m = 0.03;  ///< radius of the rod between them
  fsw::Vector3 body_low_m = fsw::Vector3::Zero(), body_high_m = fsw::Vector3::Zero();  ///< box of the hull, full scale
  /// Returns the full-scale body frame scaled by `scale`; the origin of T is the scaled origin of the body frame.
  [[nodiscard]] Eigen::Isometry3d T_flange_target(double scale) const;
};

struct CameraMount {
  double ahead_m = 0.15;  ///< projection centre from the flange along its z, which is the boresight
  double roll_rad = 0.0;  ///< rotation of the camera's x from the flange's x about the boresight
  double body_radius_m = 0.05;
  std::string file = "tron";  ///< data/cameras/<file>.toml: the lens and detector as designed
  std::string model, serial;  ///< that the device has to state; empty: any
  [[nodiscard]] Eigen::Isometry3d T_flange_camera() const;
};

/// Describes the lamp, which rides on a horizontal arc about `centre`. Azimuth from -x towards -y.
struct Lamp {
  fsw::Vector3 centre_m = fsw::Vector3::Zero();
  double radius_m = 1.3;
  double azimuth_low_rad = 0.0, azimuth_high_rad = 0.0;
  double speed_rad_s = 0.0;
  double beam_width_m = 1.1;
  double irradiance_ratio = 0.0;  ///< at full power in the middle of the beam, to the solar constant
  /// Returns the unit vector from the centre to the lamp, L: (-cos b, -sin b, 0).
  [[nodiscard]] static fsw::Vector3 direction(double azimuth_rad);
};

struct LightBox {
  fsw::Vector3 centre_m = fsw::Vector3::Zero();
  fsw::Vector3 normal = fsw::Vector3::UnitX();  ///< into the room
};

struct LightBoxes {
  double side_m = 0.6;
  /// Radiant exitance ratio: radiance at full power times pi, relative to the lamp's irradiance at full power.
  double exitance_ratio = 0.0;
  std::array<LightBox, kBoxes> boxes{};
};

struct RobotLine {
  std::string address;             ///< host of the controller: EKI server; RSI comes from there
  std::uint16_t rsi_port = 0;      ///< UDP port of this computer, to which the controller sends
  std::uint16_t eki_port = 54600;  ///< TCP port of the controller
};

struct Robot {
  ArmDesign design;
  BasePose base;
  std::array<double, kJoints> home_rad{};
  RobotLine line;
};

struct Track {
  AxisLimits axis;      ///< carriage, m along L x
  double home_m = 4.0;  ///< its E1 is 0 mm at `home_m` and counts along +x
};

struct ViconSettings {
  std::uint16_t port = 51001;
  std::string camera_object = "camera", target_object = "target";
  double rate_hz = 100.0;
  std::string rotation = "xyz";  ///< Rx Ry Rz
};

struct SacnSettings {
  std::string address;  ///< unicast
  std::uint16_t port = 5568;
  std::uint16_t universe = 1;
  int start_slot = 1;  ///< first of 12 values of two slots, coarse first: lamp power, lamp place, boxes 1 to 10
  int priority = 100;
};

struct MotionSettings {
  double override_fraction = 0.5;  ///< share of speed and acceleration
  double clearance_m = 0.05;
  double cable_turn_rad = 0.0;    ///< largest |A4 + A6| of the camera's arm since home
  double limit_margin_rad = 0.0;  ///< penalty closer to a limit
  double cycle_s = 0.004;
};

struct TestbedDesign {
  std::string name;
  double scale = 0.5;  ///< laboratory metres per metre in orbit
  fsw::Vector3 room_low_m = fsw::Vector3::Zero(), room_high_m = fsw::Vector3::Zero();
  Robot camera_robot, target_robot;
  Track track;
  CameraMount camera;
  TargetMount target;
  Lamp lamp;
  LightBoxes boxes;
  ViconSettings vicon;
  SacnSettings sacn;
  MotionSettings motion;
  std::string camera_address;  ///< IP address of the GigE camera
};

/// Throws mission::MissionError that names file and line.
[[nodiscard]] TestbedDesign read_testbed_design(const std::filesystem::path& file,
                                                const std::vector<std::string>& assignments = {});

}  // namespace vbar::tron
