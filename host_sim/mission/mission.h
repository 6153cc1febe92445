#pragma once
// A mission file's content, checked and in SI units: plain structs. What each key means, its default and its range
// stand with the functions that read it (read_*.cpp) and, by example, in missions/ideal_navigation.toml.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/orbit/elements.h"
#include "host_sim/engine/clock.h"
#include "host_sim/engine/link_model.h"
#include "host_sim/mission/attitude.h"
#include "host_sim/truth/truth_settings.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/crosslink.h"
#include "host_sim/twins/gnss/gnss_settings.h"

namespace vbar::mission {

inline constexpr std::size_t kMaxWaypoints = 16;  ///< of one waypoint telecommand

/// Orbit of a spacecraft at the epoch.
enum class ElementsKind { kOsculating, kMean };
struct OrbitByElements {
  ElementsKind kind = ElementsKind::kOsculating;
  fsw::orbit::QnsElements elements;
};

/// Orbit given by the mean ROE of a waypoint with respect to another spacecraft, at the start of the run.
struct OrbitByWaypoint {
  std::string to;
  int waypoint_index = 0;
};

/// Orbit given by mean ROE with respect to another spacecraft, at the start of the run.
struct OrbitByRoe {
  std::string to;
  fsw::Vector6 a_roe_m = fsw::Vector6::Zero();  ///< times the reference a
};

using truth::SurfaceProperties;

enum class FlightTarget { kInProcess, kHostProcess, kZynqQemu, kZynqLinuxQemu, kBoard };
enum class FlightLink { kSerial, kUdp };

/// Where a spacecraft's flight software runs, and how packets get there.
struct FlightComputer {
  FlightTarget target = FlightTarget::kInProcess;
  FlightLink link = FlightLink::kSerial;
  std::string library;            ///< shared library of another test article; empty: vbar's own
  fsw::Duration compute_latency;  ///< from a step to the moment its outputs take effect
  std::string device;             ///< board on a serial link: the tty
  /// Serial link: the tty's rate (board: 921,600 unless said); for others the bridge slows the line down to it.
  std::optional<int> baud;
  std::string address;  ///< board on UDP
  int port = 0;         ///< board on UDP
};

enum class NavigationSource { kIdeal, kRecorded };

/// sensors.navigation: states that need no estimating.
struct NavigationSensor {
  NavigationSource source = NavigationSource::kIdeal;
  std::string target;  ///< the spacecraft it observes
  fsw::Duration period;
  std::filesystem::path log;  ///< recorded only: the packet log it plays
};

/// sensors.gnss: a receiver and a star tracker.
struct GnssSensor {
  twins::gnss::GnssReceiverSettings receiver;
  /// The spacecraft whose receiver's data come by the crosslink; empty: this one's go to its partner, or they are all
  /// there is, beside a camera.
  std::string partner;
};

/// What navigation makes of a camera's images.
enum class CameraNavigation { kAnglesOnly, kPose };

/// sensors.camera: navigates by images of one spacecraft among all that have a CAD model.
struct CameraSensor {
  std::string camera;  ///< names its file in data/cameras, which `settings` began with
  twins::camera::CameraSettings settings;
  std::string target;  ///< the spacecraft it navigates to
  CameraNavigation navigation = CameraNavigation::kAnglesOnly;
  fsw::Duration period;   ///< between exposures
  fsw::Duration readout;  ///< from the middle of an exposure until the image leaves the camera
  Eigen::Quaterniond q_camera_body = Eigen::Quaterniond::Identity();  ///< camera axes: z boresight, x right, y down
  fsw::Vector3 position_body_m = fsw::Vector3::Zero();                ///< from the centre of mass
};

/// What angles-only navigation goes by, telecommanded; fields as in vbar.lcm, angles_only_configuration.
struct AnglesOnly {
  double detection_sigmas = 0.0;
  double centroid_floor_px = 0.0;
  double pointing_tolerance = 0.0;
  double acceleration_psd = 0.0;
  double acceleration_psd_least = 0.0;
  double acceleration_psd_most = 0.0;
  double brightness_offset_m = 0.0;
  double maneuver_sigma = 0.0;
  double maneuver_sigma_relative = 0.0;
  int batch_images = 0;
  /// Of the target's place that is telecommanded at the start: mean ROE times the reference a, 1 sigma.
  fsw::Vector6 apriori_sigma_a_roe_m = fsw::Vector6::Zero();
  friend bool operator==(const AnglesOnly&, const AnglesOnly&) = default;
};

/// What navigation by the pose network goes by, telecommanded; fields as in vbar.lcm, pose_configuration.
struct PoseNavigation {
  double keypoint_sigma_scale = 0.0;
  double keypoint_floor_px = 0.0;
  double acceleration_psd = 0.0;
  double acceleration_psd_least = 0.0;
  double acceleration_psd_most = 0.0;
  double angular_acceleration_psd = 0.0;
  double maneuver_sigma = 0.0;
  double maneuver_sigma_relative = 0.0;
  /// Of where the target is telecommanded to be at the start: mean ROE times the reference a, 1 sigma; zero: it is not.
  fsw::Vector6 apriori_sigma_a_roe_m = fsw::Vector6::Zero();
  fsw::Vector6 start_sigma_a_roe_m = fsw::Vector6::Zero();  ///< of a formation that nothing is known of
  int start_images = 0;
  friend bool operator==(const PoseNavigation&, const PoseNavigation&) = default;
};

/// What flight software navigates by, telecommanded; fields as in vbar.lcm, navigation_configuration.
struct GnssNavigation {
  bool resolve_ambiguities = true;
  double min_success_rate = 0.0;
  double min_ratio = 0.0;
  fsw::Duration pair_wait;
  double antenna_offset_sigma_m = 0.0;
  double phase_centre_jitter_m = 0.0;
  double code_bias_sigma_m = 0.0;
  double start_velocity_sigma = 0.0;
  double acceleration_sigma = 0.0;
  double acceleration_time_s = 0.0;
  double maneuver_sigma = 0.0;
  double maneuver_sigma_relative = 0.0;
  friend bool operator==(const GnssNavigation&, const GnssNavigation&) = default;
};

/// A burn that the flight software is told of but did not ask for.
struct PrescribedBurn {
  fsw::GpsTime time;
  fsw::Vector3 dv_rtn = fsw::Vector3::Zero();
};

/// actuators.thruster; 1-sigma errors of each burn.
struct Thruster {
  double magnitude_error = 0.0;     ///< relative
  double pointing_error_rad = 0.0;  ///< about each of two axes across the burn
};

struct Spacecraft {
  std::string name;
  std::uint8_t number = 0;  ///< as in packet headers
  SurfaceProperties surface;
  std::string model;  ///< CAD file that cameras see it by, data/models/<model>.obj; empty: no camera sees it
  std::variant<OrbitByElements, OrbitByWaypoint, OrbitByRoe> orbit;
  std::optional<Attitude> attitude;
  std::optional<FlightComputer> flight_computer;
  std::optional<NavigationSensor> navigation;
  std::optional<GnssSensor> gnss;
  std::optional<CameraSensor> camera;
  std::optional<Thruster> thruster;

  /// The spacecraft that its sensors navigate to; empty if it has none.
  [[nodiscard]] const std::string& observes() const;
};

/// Which solver plans the leg that ends at a waypoint; numbers as in vbar.lcm.
enum class Solver : std::int8_t { kClosedForm = 0, kKoenigDamico = 1, kLeastSquares = 2 };

struct Waypoint {
  int index = 0;
  fsw::GpsTime time;
  fsw::Vector6 a_roe_m =
      fsw::Vector6::Zero();  ///< mean ROE of the target with respect to the servicer, times the reference a
  Solver solver = Solver::kClosedForm;
};

/// Numbers as in vbar.lcm, mode_command.
enum class Mode : std::int8_t { kIdle = 0, kApproach = 1, kStationKeeping = 2, kHold = 3 };

/// What is telecommanded to the flight software at the start; fields as in vbar.lcm, gnc_configuration.
struct Guidance {
  Mode mode = Mode::kApproach;
  double reference_semi_major_axis_m = 0.0;
  fsw::Duration compute_latency;
  fsw::Duration closed_form_period;
  fsw::Duration koenig_damico_period;
  fsw::Duration koenig_damico_grid;
  fsw::GpsTime planner_start;
  double minimum_dv = 0.0;
  double maximum_dv = 0.0;
  double roe_error_threshold_m = 0.0;
  double keep_out_radius_m = 0.0;
  double safety_horizon_s = 0.0;
  double station_keeping_deadband_m = 0.0;
  double closed_form_tolerance_m = 0.0;
  double koenig_damico_tolerance_m = 0.0;
  double station_keeping_horizon_s = 0.0;
  double navigation_timeout_s = 0.0;
};

/// Live packets on an LCM bus.
struct LcmMirror {
  bool mirror = false;
  std::string url;
};

/// What the log of a run keeps of a digital camera's images.
enum class ImagesInLog {
  kRecipes,  ///< from what they can be made again
  kTiles,    ///< their packets
};

struct Record {
  ImagesInLog images = ImagesInLog::kRecipes;
};

struct Mission {
  std::filesystem::path file;
  std::string name;
  std::string description;
  fsw::GpsTime epoch;      ///< of the orbital elements and of waypoint times
  fsw::Duration start;     ///< first step, after the epoch
  fsw::Duration duration;  ///< from the first step to the end of the run
  fsw::Duration step;      ///< between flight steps
  std::uint64_t seed = 1;
  truth::TruthSettings truth;  ///< all but the data folder, which the program knows
  std::vector<Spacecraft> spacecraft;
  Guidance guidance;
  GnssNavigation gnss_navigation;
  AnglesOnly angles_only;
  PoseNavigation pose;
  std::vector<PrescribedBurn> burns;  ///< of the spacecraft that flies, in order of time
  std::vector<Waypoint> waypoints;    ///< in order of time
  engine::ClockSettings clock;
  engine::LinkSettings
      board_link;  ///< the simulated link between a spacecraft's sensors or actuators and its flight computer
  twins::gnss::CrosslinkSettings crosslink;
  twins::gnss::ConstellationSettings constellation;
  LcmMirror lcm;
  Record record;

  [[nodiscard]] fsw::GpsTime start_time() const { return epoch + start; }
  [[nodiscard]] fsw::GpsTime end_time() const { return epoch + start + duration; }

  /// Whether any spacecraft carries flight software.
  [[nodiscard]] bool flies() const;

  /// Null if there is none of that name / with that index.
  [[nodiscard]] const Spacecraft* find_spacecraft(std::string_view spacecraft_name) const;
  [[nodiscard]] const Waypoint* find_waypoint(int index) const;
};

/// The names that mission files and summaries use (names.h has them all).
[[nodiscard]] std::string_view name_of(FlightTarget target);
[[nodiscard]] std::string_view name_of(FlightLink link);
[[nodiscard]] std::string_view name_of(NavigationSource source);

}  // namespace vbar::mission
