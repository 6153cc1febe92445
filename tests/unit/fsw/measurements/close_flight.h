#pragma once
// The last two legs of the rendezvous as they truly go, waypoints 8 to 10, 13 to 5 m from a tumbling target; and what a
// keypoint network, a star tracker and a GNSS receiver would tell of it, without images.

#include <array>
#include <cstddef>
#include <optional>
#include <random>
#include <vector>

#include "fsw/filter/propagation.h"
#include "fsw/filter/target_attitude.h"
#include "fsw/orbit/earth_rotation.h"
#include "fsw/orbit/elements.h"
#include "fsw/vision/imaging/camera_model.h"
#include "fsw/vision/pose/keypoint.h"
#include "fsw/vision/pose/pnp.h"

namespace vbar::test {

inline constexpr double kImagePeriod_s = 5.0;

/// The truth at an image's time.
struct CloseEpoch {
  fsw::GpsTime time;
  fsw::orbit::CartesianState servicer;
  fsw::orbit::CartesianState target;
  fsw::Vector3 sun_eci = fsw::Vector3::Zero();  ///< unit vector
  bool is_target_lit = true;
};

/// Both orbits under all forces, with burns from waypoint to waypoint; the same for every seed.
struct CloseFlight {
  std::vector<CloseEpoch> epochs;
  std::vector<fsw::filter::Burn> burns;
  fsw::orbit::EarthOrientation earth;
};

CloseFlight fly_closely(double hours);

/// The target's attitude at each epoch: a rigid body in the Earth's gravity gradient, rate and axis from the seed.
/// `torque_nm`: a constant torque besides, in body axes, direction from the seed.
std::vector<fsw::filter::AttitudeState> tumble(const CloseFlight& flight, double rate_deg_s, unsigned seed,
                                               double torque_nm = 0.0);

/// 1-sigma figures of the sensors.
struct KeypointErrors {
  double sigma_px = 1.5;       ///< each axis of a keypoint
  double told_px = 1.5;        ///< what the network says of it
  double lasting_share = 0.0;  ///< of its variance, correlated from image to image
  double lasting_time_s = 20.0;
  double stretch = 0.0;           ///< of the apparent size, constant
  double outlier_share = 0.0;     ///< of keypoints, to anywhere within the crop
  double unseen_share = 0.05;     ///< of keypoints
  double flip_share = 0.0;        ///< of single images' poses, turned half about an axis of the body
  bool has_dark = true;           ///< no keypoints in the Earth's shadow
  double attitude_arcsec = 20.0;  ///< star tracker, each axis, half of it constant
  double pointing_deg = 0.2;      ///< the camera's control
  double burn_relative = 1e-3;    ///< of a burn's size, each axis: what is known of it against what was flown
};

/// The camera and the target as both the sensor and navigation know them.
struct CloseFlightCamera {
  fsw::imaging::CameraModel optics;
  fsw::Vector3 position_camera_m = fsw::Vector3::Zero();  ///< from the servicer's centre of mass, camera axes
  fsw::pose::KeypointShape shape{};                       ///< body axes from the target's centre of mass, m
  fsw::filter::Inertia inertia;
};
CloseFlightCamera close_flight_camera();

/// What the sensors measure at an image's time.
struct MeasuredEpoch {
  fsw::GpsTime time;
  fsw::Vector3 servicer_position_eci = fsw::Vector3::Zero();  ///< by GNSS
  fsw::Vector3 sun_eci = fsw::Vector3::Zero();                ///< unit vector
  fsw::Matrix3 R_camera_eci = fsw::Matrix3::Identity();
  const fsw::pose::Keypoints* keypoints = nullptr;  ///< null: no target detected
  std::optional<fsw::pose::PnpSolution> pnp;        ///< of the same keypoints
};

/// Mean ROE of the target times the servicer's mean a.
fsw::Vector6 mean_a_roe_m(const fsw::orbit::CartesianState& servicer, const fsw::orbit::CartesianState& target);

/// A measured epoch, in order of time. It stays true until the next is asked for.
class SimulatedNetwork {
 public:
  SimulatedNetwork(const CloseFlight& flight, const std::vector<fsw::filter::AttitudeState>& attitudes,
                   const KeypointErrors& errors, unsigned seed);

  /// `turned`: the target is turned by this besides, in body axes.
  const MeasuredEpoch& measure(std::size_t index, const Eigen::Quaterniond& turned = Eigen::Quaterniond::Identity());
  const std::vector<fsw::filter::Burn>& known_burns() const { return known_burns_; }

 private:
  double normal() { return standard_(random_); }
  double uniform() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }
  fsw::Vector3 normal3() {
    const double x = normal();
    const double y = normal();
    return {x, y, normal()};
  }
  void see_keypoints(const fsw::pose::TargetPose& pose);
  void solve_pose(const fsw::pose::TargetPose& truth);

  const CloseFlight& flight_;
  const std::vector<fsw::filter::AttitudeState>& attitudes_;
  KeypointErrors errors_;
  CloseFlightCamera camera_ = close_flight_camera();
  std::mt19937 random_;
  std::normal_distribution<double> standard_;
  fsw::Vector3 attitude_bias_;
  fsw::Vector3 gnss_slow_ = fsw::Vector3::Zero();
  std::array<fsw::Vector2, fsw::pose::kKeypoints> lasting_;
  std::array<bool, fsw::pose::kKeypoints> is_stray_{};
  std::vector<fsw::filter::Burn> known_burns_;
  fsw::pose::Keypoints keypoints_;
  MeasuredEpoch epoch_;
};

}  // namespace vbar::test
