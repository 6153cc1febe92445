#include "hil_drivers/tron/geometry/testbed_design.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "host_sim/mission/mission.h"
#include "host_sim/mission/mission_document.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/mission/toml_file.h"

namespace vbar::tron {
namespace {

using fsw::Vector3;
using mission::above_to;
using mission::from_to;
using mission::Range;
using mission::TableReader;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr Range kRoom_m = from_to(-100.0, 100.0);
constexpr Range kTurn_deg = from_to(-360.0, 360.0);

constexpr mission::Names<MountFace, 6> kFaces{{{"-x", MountFace::kMinusX},
                                               {"+x", MountFace::kPlusX},
                                               {"-y", MountFace::kMinusY},
                                               {"+y", MountFace::kPlusY},
                                               {"bottom", MountFace::kBottom},
                                               {"top", MountFace::kTop}}};

Vector3 vector(const TableReader& section, std::string_view key, Range range) {
  const auto numbers = section.three_numbers(key, range);
  return {numbers[0], numbers[1], numbers[2]};
}

std::uint16_t port(const TableReader& section, std::string_view key) {
  return static_cast<std::uint16_t>(section.integer(key, 1, 65535));
}

double degrees(const TableReader& section, std::string_view key, Range range) {
  return section.number(key, range) * kDegree;
}

using Column = double AxisLimits::*;

void read_column(const TableReader& section, std::string_view key, Range range, double unit, Column column,
                 ArmDesign& arm) {
  const auto numbers = section.six_numbers(key, range);
  for (std::size_t k = 0; k < kJoints; ++k) arm.axes[k].*column = numbers[k] * unit;
}

ArmDesign read_arm(const TableReader& section) {
  constexpr Range kLength_m = from_to(0.0, 10.0);
  ArmDesign arm;
  arm.type = section.text("type");
  arm.d1_m = section.number("d1_m", kLength_m);
  arm.a1_m = section.number("a1_m", kLength_m);
  arm.a2_m = section.number("a2_m", above_to(0.0, 10.0));
  arm.a3_m = section.number("a3_m", kLength_m);
  arm.d4_m = section.number("d4_m", above_to(0.0, 10.0));
  arm.d6_m = section.number("d6_m", kLength_m);
  read_column(section, "lower_deg", kTurn_deg, kDegree, &AxisLimits::lower, arm);
  read_column(section, "upper_deg", kTurn_deg, kDegree, &AxisLimits::upper, arm);
  read_column(section, "speed_deg_s", above_to(0.0, 3600.0), kDegree, &AxisLimits::speed, arm);
  read_column(section, "acceleration_rad_s2", above_to(0.0, 1e4), 1.0, &AxisLimits::acceleration, arm);
  read_column(section, "jerk_rad_s3", above_to(0.0, 1e6), 1.0, &AxisLimits::jerk, arm);
  const auto radii =
      section.numbers("body_radius_m", arm.body_radius_m.size(), arm.body_radius_m.size(), from_to(0.0, 1.0));
  std::ranges::copy(radii, arm.body_radius_m.begin());
  for (std::size_t k = 0; k < kJoints; ++k)
    if (arm.axes[k].lower >= arm.axes[k].upper) section.refuse_value("upper_deg", "upper limits above the lower ones");
  section.finish();
  return arm;
}

Robot read_robot(const TableReader& section, const ArmDesign& design) {
  Robot robot;
  robot.design = design;
  robot.base.position_m = vector(section, "base_m", kRoom_m);
  robot.base.rpy_rad = vector(section, "base_rpy_deg", kTurn_deg) * kDegree;
  const auto home = section.six_numbers("home_deg", kTurn_deg);
  for (std::size_t k = 0; k < kJoints; ++k) {
    robot.home_rad[k] = home[k] * kDegree;
    if (robot.home_rad[k] < design.axes[k].lower || robot.home_rad[k] > design.axes[k].upper)
      section.refuse_value("home_deg", "angles within the limits of the axes");
  }
  robot.line.address = section.text("address");
  robot.line.rsi_port = port(section, "rsi_port");
  robot.line.eki_port = port(section, "eki_port");
  section.finish();
  return robot;
}

Track read_track(const TableReader& section) {
  Track track;
  track.axis.lower = section.number("lower_m", kRoom_m);
  track.axis.upper = section.number("upper_m", kRoom_m);
  track.home_m = section.number("home_m", from_to(track.axis.lower, track.axis.upper));
  track.axis.speed = section.number("speed_m_s", above_to(0.0, 20.0));
  track.axis.acceleration = section.number("acceleration_m_s2", above_to(0.0, 100.0));
  track.axis.jerk = section.number("jerk_m_s3", above_to(0.0, 1e4));
  section.finish();
  return track;
}

CameraMount read_camera(const TableReader& section, std::string& address) {
  CameraMount camera;
  address = section.text("address");
  camera.file = section.name("file", camera.file);
  camera.model = section.text("model", "");
  camera.serial = section.text("serial", "");
  camera.ahead_m = section.number("ahead_m", from_to(-2.0, 2.0));
  camera.roll_rad = degrees(section, "roll_deg", kTurn_deg);
  camera.body_radius_m = section.number("body_radius_m", from_to(0.0, 1.0));
  section.finish();
  return camera;
}

TargetMount read_target(const TableReader& section) {
  TargetMount target;
  target.model = section.name("model", target.model);
  target.face = section.choice<MountFace>("face", kFaces);
  target.stand_off_m = section.number("stand_off_m", from_to(0.0, 2.0));
  target.roll_rad = degrees(section, "roll_deg", kTurn_deg);
  target.rod_radius_m = section.number("rod_radius_m", from_to(0.0, 1.0));
  target.body_low_m = vector(section, "body_low_m", kRoom_m);
  target.body_high_m = vector(section, "body_high_m", kRoom_m);
  if (!(target.body_low_m.array() < target.body_high_m.array()).all())
    section.refuse_value("body_high_m", "coordinates above those of body_low_m");
  section.finish();
  return target;
}

Lamp read_lamp(const TableReader& section) {
  Lamp lamp;
  lamp.centre_m = vector(section, "centre_m", kRoom_m);
  lamp.radius_m = section.number("radius_m", above_to(0.0, 100.0));
  const auto azimuth = section.numbers("azimuth_deg", 2, 2, kTurn_deg);
  lamp.azimuth_low_rad = azimuth[0] * kDegree;
  lamp.azimuth_high_rad = azimuth[1] * kDegree;
  if (lamp.azimuth_low_rad > lamp.azimuth_high_rad) section.refuse_value("azimuth_deg", "the lower azimuth first");
  lamp.speed_rad_s = degrees(section, "speed_deg_s", above_to(0.0, 360.0));
  lamp.beam_width_m = section.number("beam_width_m", above_to(0.0, 100.0));
  lamp.irradiance_ratio = section.number("irradiance_ratio", above_to(0.0, 10.0));
  section.finish();
  return lamp;
}

LightBoxes read_boxes(const TableReader& section) {
  LightBoxes boxes;
  boxes.side_m = section.number("side_m", above_to(0.0, 10.0));
  boxes.exitance_ratio = section.number("exitance_ratio", above_to(0.0, 1000.0));
  const auto places = section.tables("centres_m");
  if (places.size() != kBoxes) section.refuse("centres_m", std::to_string(places.size()) + " boxes", "10 boxes");
  for (std::size_t k = 0; k < kBoxes; ++k) {
    boxes.boxes[k] = {vector(places[k], "at_m", kRoom_m), vector(places[k], "normal", from_to(-1.0, 1.0))};
    if (std::abs(boxes.boxes[k].normal.norm() - 1.0) > 1e-6) places[k].refuse_value("normal", "a unit vector");
    places[k].finish();
  }
  section.finish();
  return boxes;
}

ViconSettings read_vicon(const TableReader& section) {
  ViconSettings vicon;
  vicon.port = port(section, "port");
  vicon.camera_object = section.name("camera_object", vicon.camera_object);
  vicon.target_object = section.name("target_object", vicon.target_object);
  vicon.rate_hz = section.number("rate_hz", from_to(1.0, 2000.0));
  vicon.rotation = section.choice("rotation", {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"}, vicon.rotation);
  section.finish();
  return vicon;
}

SacnSettings read_sacn(const TableReader& section) {
  SacnSettings sacn;
  sacn.address = section.text("address");
  sacn.port = port(section, "port");
  sacn.universe = static_cast<std::uint16_t>(section.integer("universe", 1, 63999));
  sacn.start_slot = static_cast<int>(section.integer("start_slot", 1, 512 - 2 * (2 + static_cast<int>(kBoxes)) + 1));
  sacn.priority = static_cast<int>(section.integer("priority", 0, 200));
  section.finish();
  return sacn;
}

MotionSettings read_motion(const TableReader& section) {
  MotionSettings motion;
  motion.override_fraction = section.number("override", above_to(0.0, 1.0));
  motion.clearance_m = section.number("clearance_m", from_to(0.0, 1.0));
  motion.cable_turn_rad = degrees(section, "cable_turn_deg", from_to(0.0, 3600.0));
  motion.limit_margin_rad = degrees(section, "limit_margin_deg", from_to(0.0, 90.0));
  section.finish();
  return motion;
}

/// Into the body through the face, and the middle of the face, full scale.
struct Face {
  Vector3 inward, middle;
};

Face face_of(const TargetMount& target) {
  const Vector3 middle = 0.5 * (target.body_low_m + target.body_high_m);
  const auto face = static_cast<int>(target.face);
  const int axis = face / 2;
  const bool is_high = face % 2 == 1;
  Face found{Vector3::Zero(), middle};
  found.inward[axis] = is_high ? -1.0 : 1.0;
  found.middle[axis] = is_high ? target.body_high_m[axis] : target.body_low_m[axis];
  return found;
}

}  // namespace

Eigen::Isometry3d BasePose::T_L_base() const {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = (Eigen::AngleAxisd(rpy_rad.z(), Vector3::UnitZ()) * Eigen::AngleAxisd(rpy_rad.y(), Vector3::UnitY()) *
                Eigen::AngleAxisd(rpy_rad.x(), Vector3::UnitX()))
                   .toRotationMatrix();
  T.translation() = position_m;
  return T;
}

Eigen::Isometry3d TargetMount::T_flange_target(double scale) const {
  const Face at = face_of(*this);
  // The body's axis after the inward one is along the flange's x, before the roll.
  const auto next = (static_cast<int>(face) / 2 + 1) % 3;
  const Vector3 x_body = Vector3::Unit(next);
  fsw::Matrix3 R_target_flange;
  R_target_flange.col(0) = x_body;
  R_target_flange.col(1) = at.inward.cross(x_body);
  R_target_flange.col(2) = at.inward;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(roll_rad, Vector3::UnitZ()).toRotationMatrix() * R_target_flange.transpose();
  T.translation() = stand_off_m * Vector3::UnitZ() - T.linear() * (scale * at.middle);
  return T;
}

Eigen::Isometry3d CameraMount::T_flange_camera() const {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(roll_rad, Vector3::UnitZ()).toRotationMatrix();
  T.translation() = ahead_m * Vector3::UnitZ();
  return T;
}

Vector3 Lamp::direction(double azimuth_rad) {
  return {-std::cos(azimuth_rad), -std::sin(azimuth_rad), 0.0};
}

TestbedDesign read_testbed_design(const std::filesystem::path& file, const std::vector<std::string>& assignments) {
  toml::table table =
      mission::parse_toml(mission::read_text_file(file, "the file of a robotic bench (TOML)"), file.string());
  for (const std::string& assignment : assignments) mission::apply_override(table, assignment);
  const TableReader document(table, file.string());
  TestbedDesign bench;
  bench.name = document.name("name");
  bench.scale = document.number("scale", above_to(0.0, 10.0));
  const TableReader room = document.table("room");
  bench.room_low_m = vector(room, "low_m", kRoom_m);
  bench.room_high_m = vector(room, "high_m", kRoom_m);
  room.finish();
  const ArmDesign arm = read_arm(document.table("arm"));
  bench.camera_robot = read_robot(document.table("camera_robot"), arm);
  bench.target_robot = read_robot(document.table("target_robot"), arm);
  bench.track = read_track(document.table("track"));
  bench.camera = read_camera(document.table("camera"), bench.camera_address);
  bench.target = read_target(document.table("target"));
  bench.lamp = read_lamp(document.table("lamp"));
  bench.boxes = read_boxes(document.table("boxes"));
  bench.sacn = read_sacn(document.table("sacn"));
  bench.vicon = read_vicon(document.table("vicon"));
  bench.motion = read_motion(document.table("motion"));
  document.finish();
  return bench;
}

}  // namespace vbar::tron
