#include "emulators/tron/robots.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "hil_drivers/tron/robot/robot_files.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::tron::bench {
namespace {

constexpr const char* kDriverAddress = "127.0.0.1";
constexpr double kDegree = std::numbers::pi / 180.0;

/// As KUKA gives a pose: mm, and deg about z, y', x''.
CartesianPose kuka_pose(const Eigen::Isometry3d& pose) {
  const fsw::Matrix3 R = pose.linear();
  const double a = std::atan2(R(1, 0), R(0, 0));
  const double b = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  const double c = std::atan2(R(2, 1), R(2, 2));
  const fsw::Vector3 mm = 1e3 * pose.translation();
  return {mm.x(), mm.y(), mm.z(), a / kDegree, b / kDegree, c / kDegree};
}

ControllerSettings controller_settings(const std::string& name, const Robot& robot, const Track* track,
                                       rsi::RobotFiles files, std::uint16_t rsi_port, std::uint64_t seed) {
  ControllerSettings settings;
  settings.name = name;
  settings.robot = robot;
  if (track != nullptr) settings.track = *track;
  settings.ethernet = std::move(files.ethernet);
  settings.ethernet.address = kDriverAddress;
  settings.ethernet.port = rsi_port != 0 ? rsi_port : robot.line.rsi_port;
  settings.context = std::move(files.context);
  // The controller has been running for up to a week.
  constexpr std::uint64_t kWeekOfCycles = 7ULL * 24 * 3600 * 250;
  settings.first_ipoc = 4 * (engine::RandomStream(seed, "bench/ipoc/" + name).bits() % kWeekOfCycles) + 1;
  const auto arm = std::make_shared<TrueArm>(robot.design, 1.0, ErrorSizes::none(), seed, "as_designed");
  settings.flange_pose = [arm](const AxisPositions& at) { return kuka_pose(arm->T_base_flange(at.axes_rad)); };
  return settings;
}

nlohmann::ordered_json summary_of(const Controller& controller) {
  const ControllerStatistics& counts = controller.statistics();
  const ControllerSettings& settings = controller.settings();
  nlohmann::ordered_json summary;
  summary["cycles"] = counts.cycles;
  summary["answers"] = counts.answers;
  summary["late_answers"] = counts.cycles_without_answer;
  summary["bad_answers"] = counts.bad_answers;
  summary["repeated_answers"] = counts.repeated_answers;
  summary["clamps"] = counts.clamps;
  summary["limit_trips"] = counts.limit_trips;
  summary["rsi_starts"] = counts.rsi_starts;
  summary["answers_within_1ms"] = counts.answers_within_1ms;
  summary["max_answer_time_s"] = counts.max_answer_time_s;
  std::vector<double> speed, acceleration;
  const auto add = [&](const AxisLimits& limits, std::size_t axis) {
    speed.push_back(counts.max_speed[axis] / limits.speed);
    acceleration.push_back(counts.max_acceleration[axis] / limits.acceleration);
  };
  for (std::size_t axis = 0; axis < kJoints; ++axis) add(settings.robot.design.axes[axis], axis);
  if (settings.track) add(settings.track->axis, kJoints);
  summary["max_speed_ratio"] = speed;
  summary["max_acceleration_ratio"] = acceleration;
  if (!counts.last_bad_answer.empty()) summary["last_bad_answer"] = counts.last_bad_answer;
  return summary;
}

}  // namespace

Robots::Robots(boost::asio::io_context& context, const BenchSettings& settings, const World& world,
               const DriverPorts& ports)
    : track_home_m_(settings.laboratory.track.home_m) {
  const TestbedDesign& laboratory = settings.laboratory;
  camera_ = std::make_unique<Controller>(
      context, controller_settings("camera robot", laboratory.camera_robot, &laboratory.track,
                                   robot_files(kCameraRobot), ports.camera_rsi, settings.seed));
  target_ = std::make_unique<Controller>(
      context, controller_settings("target robot", laboratory.target_robot, nullptr, robot_files(kTargetRobot),
                                   ports.target_rsi, settings.seed));
  camera_->on_standstill([this, &world] {
    const std::uint64_t number = camera_standstills_++;
    return AxisPositions{world.camera_arm_deviation_rad(number), world.carriage_deviation_m(number)};
  });
  target_->on_standstill([this, &world] {
    return AxisPositions{world.target_arm_deviation_rad(target_standstills_++), 0.0};
  });
}

Posture Robots::true_posture() const {
  const AxisPositions camera = camera_->true_position(), target = target_->true_position();
  return {camera.axes_rad, target.axes_rad, track_home_m_ + camera.track_m};
}

Posture Robots::measured_posture() const {
  const AxisPositions camera = camera_->position(), target = target_->position();
  return {camera.axes_rad, target.axes_rad, track_home_m_ + camera.track_m};
}

bool Robots::set_fault(const Fault& fault, bool is_on) {
  Controller& robot = fault.is_of_target ? *target_ : *camera_;
  const auto count = static_cast<std::uint64_t>(fault.value);
  switch (fault.kind) {
    case FaultKind::kEmergencyStop:
      robot.set_emergency_stop(is_on);
      return true;
    case FaultKind::kDrivesOff:
      robot.switch_drives_off("drives off");
      return true;
    case FaultKind::kAxesFrozen:
      robot.set_frozen(is_on);
      return true;
    case FaultKind::kRsiSilent:
      robot.be_silent(count);
      return true;
    case FaultKind::kAnswersLost:
      robot.lose_answers(count);
      return true;
    case FaultKind::kIpocBack:
      robot.set_ipoc_back(count);
      return true;
    case FaultKind::kRsiDropped:
      robot.drop_rsi();
      return true;
    default:
      return false;
  }
}

nlohmann::ordered_json Robots::summary() const {
  nlohmann::ordered_json summary;
  summary["camera_robot"] = summary_of(*camera_);
  summary["target_robot"] = summary_of(*target_);
  return summary;
}

}  // namespace vbar::tron::bench
