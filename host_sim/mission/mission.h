#pragma once
// [[limit]] of a mission, and [[pass]] of a campaign: what a number of the summary must keep.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <vbar/fields.h>

#include "fsw/core/gps_time.h"
#include "fsw/orbit/elements.h"
#include "fsw/packets/messages.h"
#include "host_sim/engine/clock.h"
#include "host_sim/engine/link_model.h"
#include "host_sim/mission/attitude.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/udp_address.h"
#include "host_sim/truth/truth_settings.h"
#include "host_sim/twins/thruster_properties.h"

namespace vbar::mission {

/// Limits the number with a dotted key of the summary, e.g. waypoints.10.navigation_error_m. At least one of both
/// bounds is stated.
struct Limit {
  std::string key;
  std::optional<double> most, least;
};

/// Returns the limits of a mission file, of the files that it extends, and of the overrides, "path=value". Nothing else
/// of the mission is read or checked. Throws MissionError.
[[nodiscard]] std::vector<Limit> load_limits(const std::filesystem::path& file, std::span<const std::string> overrides);

// A mission file's content, checked and in SI units: plain structs. The meaning of each key, its default and its range
// are in the functions that read it (read_*.cpp) and, by example, in missions/ideal_navigation.toml.

inline constexpr std::string_view kTruthModel = "model";  ///< source of the truth: vbar's truth model

inline constexpr std::size_t kMaxWaypoints = 16;  ///< capacity of one waypoint telecommand

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

/// Orbit given by the file of another program, at the epoch.
struct OrbitByFile {
  std::filesystem::path file;
  std::string object;  ///< name of the object in the file; empty: the file's only object
};

using truth::SurfaceProperties;

enum class FlightTarget { kInProcess, kHostProcess, kZynqQemu, kZynqLinuxQemu, kBoard };
enum class FlightLink { kSerial, kUdp };

/// The computer of a spacecraft's flight software, and its link.
struct FlightComputer {
  FlightTarget target = FlightTarget::kInProcess;
  FlightLink link = FlightLink::kSerial;
  std::string library;            ///< shared library of another flight software; empty: vbar's own
  std::string image;              ///< program or ELF image of another one; empty: vbar's own
  fsw::Duration compute_latency;  ///< from a step to the moment its outputs take effect
  std::string device;             ///< board on a serial link: the tty
  /// Serial link: the tty's rate (board: 921,600 by default); for others the bridge limits the rate to it.
  std::optional<int> baud;
  std::string address;  ///< board on UDP
  int port = 0;         ///< board on UDP
  /// Largest cost of a step, beyond which the run fails: instructions on zynq_qemu, processor cycles on a board.
  std::int64_t step_budget = 0;
  std::string telecommand_key_file;  ///< key of telecommands; empty: they are not authenticated
};

/// Settings that a kind of sensor has read from the table of one sensor: each kind derives its own settings.
struct SensorSettings {
  SensorSettings() = default;
  SensorSettings(const SensorSettings&) = default;
  SensorSettings& operator=(const SensorSettings&) = default;
  virtual ~SensorSettings() = default;

  std::string source;         ///< provider of its data: "digital", "recorded" or the name of a testbed
  std::filesystem::path log;  ///< of source "recorded": the packet log
  std::string observed;       ///< the other spacecraft that it measures or exchanges data with; empty: none
  /// Uses by navigation: a sum of navigation_configuration::kUse (vbar.lcm); 0: nothing.
  std::int32_t navigation = 0;
};

/// Settings that a kind of sensor has read from tables of the document, for all of its sensors.
struct SharedSettings {
  SharedSettings() = default;
  SharedSettings(const SharedSettings&) = default;
  SharedSettings& operator=(const SharedSettings&) = default;
  virtual ~SharedSettings() = default;
};

/// [spacecraft.sensors.<name>]
struct Sensor {
  std::string name;
  std::string kind;
  std::shared_ptr<const SensorSettings> settings;
};

/// [testbed.<name>], as the driver of that name has read it.
struct TestbedSettings {
  TestbedSettings() = default;
  TestbedSettings(const TestbedSettings&) = default;
  TestbedSettings& operator=(const TestbedSettings&) = default;
  virtual ~TestbedSettings() = default;
};
struct Testbed {
  std::string name;
  std::shared_ptr<const TestbedSettings> settings;
};

/// A burn that is reported to the flight software but was not commanded by it.
struct PrescribedBurn {
  fsw::GpsTime time;
  fsw::Vector3 dv_rtn = fsw::Vector3::Zero();
};

enum class FaultKind {
  kSilent,             ///< a sensor gives nothing
  kFrozen,             ///< a camera gives its last image again
  kReceiverSilent,     ///< a receiver gives no bytes; attitudes of the same sensor continue
  kTargetTurned,       ///< a camera sees the target rotated by `value`, rad, about its body's x axis
  kTargetHidden,       ///< a camera does not see the target
  kAttitudeError,      ///< attitudes of a sensor are rotated by `value`, rad
  kThrustScale,        ///< burns are executed at `value` of their size; 0: not at all
  kThrustUncommanded,  ///< an acceleration of `value` m/s^2 along `direction_rtn`
  kComputerSilent,     ///< the flight computer gets no packets and takes no steps, then continues
  kComputerReboot,     ///< the same, and it starts again: its telecommands are sent again
  kCycleSlip,          ///< carriers of a receiver jump by `value` cycles without an indication in its data
  kClockJump,          ///< the clock of a receiver jumps by `value`, s
  kReceiverReset,      ///< a receiver is switched off, and on again after its duration, as at the start of a run
};

/// The circumstance in which a fault begins whose time is not known beforehand.
struct FaultEvent {
  enum class Kind : std::uint8_t {
    kFirstFix,    ///< telemetry of a step reports fixed integers for the first time
    kBurn,        ///< ignition of burn number `argument`, counted from 1 at the start of the run
    kRangeBelow,  ///< true distance to the target at a step, below `argument`, m
  };
  Kind kind = Kind::kFirstFix;
  double argument = 0.0;
  fsw::Duration delay;  ///< from the event to the beginning of the fault
};

/// [[fault]]: something that fails in the simulation.
struct Fault {
  std::string name;
  FaultKind kind = FaultKind::kSilent;
  std::string unit;        ///< the sensor concerned; empty for other kinds
  std::string spacecraft;  ///< that carries it
  std::string observed;    ///< kTargetTurned, kTargetHidden: the spacecraft in its images
  std::string satellite;   ///< kCycleSlip: "G05", "highest" or "all"
  std::string start;       ///< as in the file: "waypoint:9"; empty: a time
  /// Event that begins the fault; empty if `begin` is known: before the run, or since the event has happened.
  std::optional<FaultEvent> awaited;
  fsw::GpsTime begin;                     ///< kNever while an event is awaited
  std::optional<fsw::Duration> duration;  ///< empty: to the end
  double value = 0.0;
  fsw::Vector3 direction_rtn = fsw::Vector3::Zero();
  bool is_reported = true;   ///< the thruster reports what happened; otherwise what was commanded
  bool keeps_state = false;  ///< the flight computer that reboots continues from its snapshot

  static constexpr fsw::GpsTime kNever{std::numeric_limits<std::int64_t>::max()};

  [[nodiscard]] bool has_begun(fsw::GpsTime time) const { return time >= begin && begin != kNever; }
  /// Whether the fault is present. False for a fault of an instant, which has a duration of 0.
  [[nodiscard]] bool is_present(fsw::GpsTime time) const {
    return has_begun(time) && (!duration || time < begin + *duration);
  }
};

/// actuators.thruster; 1-sigma errors of each burn.
struct Thruster {
  double magnitude_error = 0.0;                     ///< relative
  double pointing_error_rad = 0.0;                  ///< about each of two axes across the burn
  double max_thrust_n = 0.0;                        ///< for a check of burn durations only; 0: not stated
  std::optional<twins::ThrusterProperties> finite;  ///< burns with a duration; without it impulses
};

struct Spacecraft {
  std::string name;
  std::uint8_t number = 0;     ///< as in packet headers
  std::string body;            ///< names its file in data/bodies; may be empty
  SurfaceProperties surface;   ///< nominal
  double mass_sigma_kg = 0.0;  ///< 1 sigma of its true mass
  std::string model;           ///< CAD file for cameras, data/models/<model>.obj; empty: invisible to cameras
  std::variant<OrbitByElements, OrbitByWaypoint, OrbitByRoe, OrbitByFile> orbit;
  std::optional<Attitude> attitude;
  std::vector<LaterAttitude> later_attitudes;  ///< in order of time
  std::optional<FlightComputer> flight_computer;
  std::vector<Sensor> sensors;  ///< kinds in the order of the program's list, the sensors of a kind by name
  std::optional<Thruster> thruster;

  /// Returns the spacecraft that its sensors navigate to; empty if it has none.
  [[nodiscard]] const std::string& observes() const;
};

/// Returns the settings of the first sensor of a kind, by the type of its settings; null if there is none.
template <class Settings>
[[nodiscard]] const Settings* find_settings(const Spacecraft& spacecraft) {
  for (const Sensor& sensor : spacecraft.sensors)
    if (const auto* const settings = dynamic_cast<const Settings*>(sensor.settings.get())) return settings;
  return nullptr;
}

/// The solver that plans the leg ending at a waypoint: kSolver of vbar.lcm's waypoint.
enum class Solver : std::int8_t {};

struct Waypoint {
  int index = 0;
  fsw::GpsTime time;
  fsw::Vector6 a_roe_m =
      fsw::Vector6::Zero();  ///< mean ROE of the target with respect to the servicer, times the reference a
  Solver solver{waypoint::kSolverClosedForm};
  std::optional<double> keep_out_radius_m;  ///< radius for the leg that ends here; default: that of guidance
};

/// Mode of guidance; numbers as in vbar.lcm, mode_command.
enum class Mode : std::int8_t { kIdle = 0, kApproach = 1, kStationKeeping = 2, kHold = 3, kRetreat = 4 };

/// Telecommands to the flight software at the start.
struct Guidance {
  Mode mode = Mode::kApproach;
  double reference_semi_major_axis_m = 0.0;
  vbar::gnc_configuration configuration{};
};

/// Knowledge of the target's orbit at the start.
enum class Apriori : std::int8_t { kNone = 0, kOrbit = 1, kRoe = 2 };

/// [navigation]: telecommands to navigation that do not depend on its sensors.
struct Navigation {
  vbar::navigation_configuration configuration{};  ///< without the sources
  vbar::thruster_configuration thruster{};
  Apriori apriori = Apriori::kNone;
  /// Mean ROE times the reference semi-major axis, 1 sigma.
  fsw::Vector6 apriori_sigma_a_roe_m = fsw::Vector6::Zero();
  double angular_acceleration_psd = 0.0;  ///< psd of the target's angular acceleration, rad^2/s^3, each axis
};

/// Live packets on an LCM bus.
struct LcmMirror {
  bool mirror = false;
  std::string url;
};

/// Live packets as datagrams, for ground systems.
struct TelemetryLink {
  UdpAddress udp;  ///< port 0: none
};

/// Content of the log of a run for the images of a digital camera.
enum class ImagesInLog {
  kRecipes,  ///< from which they are regenerated
  kTiles,    ///< their packets
};

/// Outputs of a run besides its summary with the hashes of its outputs.
struct Record {
  ImagesInLog images = ImagesInLog::kRecipes;
  bool packets = true;  ///< the log of all packets
  bool tables = true;   ///< tables, pictures and the report
  std::vector<double>
      samples_h;  ///< times after the epoch at which the summary states errors and consistency, ascending
};

struct Mission {
  std::filesystem::path file;
  std::string name;
  std::string description;
  fsw::GpsTime epoch;      ///< reference of orbital elements and waypoint times
  fsw::Duration start;     ///< first step, after the epoch
  fsw::Duration duration;  ///< from the first step to the end of the run
  engine::Cadence step{fsw::GpsTime{},
                       fsw::duration_of_seconds(60)};  ///< steps of the flight software, the first at the start
  std::uint64_t seed = 1;
  truth::TruthSettings truth;             ///< all but the data folder, which the program determines
  std::string truth_source{kTruthModel};  ///< or the name of a testbed; the model then gives the states at the start
  std::vector<Spacecraft> spacecraft;
  Guidance guidance;
  std::optional<vbar::safety_configuration> safety;  ///< without it neither retreat nor safety monitor
  Navigation navigation;
  std::vector<std::shared_ptr<const SharedSettings>> shared;  ///< one of each kind of sensor
  std::vector<Testbed> testbeds;
  std::vector<PrescribedBurn> burns;  ///< burns of the servicer, in order of time
  std::vector<Fault> faults;          ///< in the order of the file
  std::vector<Waypoint> waypoints;    ///< in order of time
  engine::ClockSettings clock;
  std::string clock_source;  ///< "<name>" or "<name>:<device>", engine::WallClockSource
  engine::LinkSettings
      board_link;  ///< the simulated link between a spacecraft's sensors or actuators and its flight computer
  LcmMirror lcm;
  TelemetryLink telemetry;
  Record record;
  std::vector<Limit> limits;          ///< limits that vbar check applies, in the order of the file
  std::vector<NamedFile> data_files;  ///< that the mission names

  [[nodiscard]] fsw::GpsTime start_time() const { return epoch + start; }
  [[nodiscard]] fsw::GpsTime end_time() const { return epoch + start + duration; }

  /// Returns whether any spacecraft carries flight software.
  [[nodiscard]] bool flies() const;

  /// Returns the element with a name or index; null for an unknown one.
  [[nodiscard]] const Spacecraft* find_spacecraft(std::string_view spacecraft_name) const;
  [[nodiscard]] const Waypoint* find_waypoint(int index) const;
};

/// Returns the settings that a kind of sensor has read for all its sensors, by the type of those settings. Throws
/// std::logic_error if the mission was loaded without that kind.
template <class Settings>
[[nodiscard]] const Settings& shared_settings(const Mission& mission) {
  for (const auto& shared : mission.shared)
    if (const auto* const settings = dynamic_cast<const Settings*>(shared.get())) return *settings;
  throw std::logic_error("the mission was loaded without a kind of sensor that is asked for");
}

/// Returns the names that mission files and summaries use (the constants below list all).
[[nodiscard]] std::string_view name_of(FaultKind kind);
[[nodiscard]] std::string_view name_of(FlightTarget target);
[[nodiscard]] std::string_view name_of(FlightLink link);

// The names of the enumerations in mission files, summaries and messages: one list each.

template <class Enum, std::size_t N>
using Names = std::array<std::pair<std::string_view, Enum>, N>;

inline constexpr Names<ElementsKind, 2> kElementsKinds{
    {{"osculating", ElementsKind::kOsculating}, {"mean", ElementsKind::kMean}}};
inline constexpr Names<FlightTarget, 5> kFlightTargets{{{"in_process", FlightTarget::kInProcess},
                                                        {"host_process", FlightTarget::kHostProcess},
                                                        {"zynq_qemu", FlightTarget::kZynqQemu},
                                                        {"zynq_linux_qemu", FlightTarget::kZynqLinuxQemu},
                                                        {"board", FlightTarget::kBoard}}};
inline constexpr Names<FlightLink, 2> kFlightLinks{{{"serial", FlightLink::kSerial}, {"udp", FlightLink::kUdp}}};
/// The words of waypoint.kSolver in vbar.lcm, without none.
inline constexpr auto kSolvers = [] {
  Names<Solver, std::size(codes::waypoint_kSolver) - 1> names{};
  std::size_t count = 0;
  for (const Code& code : codes::waypoint_kSolver)
    if (code.value != waypoint::kSolverNone) names[count++] = {code.word, static_cast<Solver>(code.value)};
  return names;
}();
inline constexpr Names<Mode, 5> kModes{{{"idle", Mode::kIdle},
                                        {"approach", Mode::kApproach},
                                        {"station_keeping", Mode::kStationKeeping},
                                        {"hold", Mode::kHold},
                                        {"retreat", Mode::kRetreat}}};
inline constexpr Names<FaultKind, 13> kFaultKinds{{{"silent", FaultKind::kSilent},
                                                   {"frozen", FaultKind::kFrozen},
                                                   {"receiver_silent", FaultKind::kReceiverSilent},
                                                   {"target_turned", FaultKind::kTargetTurned},
                                                   {"target_hidden", FaultKind::kTargetHidden},
                                                   {"attitude_error", FaultKind::kAttitudeError},
                                                   {"thrust_scale", FaultKind::kThrustScale},
                                                   {"thrust_uncommanded", FaultKind::kThrustUncommanded},
                                                   {"computer_silent", FaultKind::kComputerSilent},
                                                   {"computer_reboot", FaultKind::kComputerReboot},
                                                   {"cycle_slip", FaultKind::kCycleSlip},
                                                   {"clock_jump", FaultKind::kClockJump},
                                                   {"receiver_reset", FaultKind::kReceiverReset}}};
inline constexpr Names<Apriori, 3> kAprioris{
    {{"none", Apriori::kNone}, {"orbit", Apriori::kOrbit}, {"roe", Apriori::kRoe}}};
inline constexpr Names<ImagesInLog, 2> kImagesInLog{
    {{"recipes", ImagesInLog::kRecipes}, {"tiles", ImagesInLog::kTiles}}};
inline constexpr Names<engine::ClockMode, 2> kClockModes{
    {{"lock_step", engine::ClockMode::kLockStep}, {"real_time", engine::ClockMode::kRealTime}}};
inline constexpr Names<engine::LatencyKind, 4> kLatencyKinds{{{"constant", engine::LatencyKind::kConstant},
                                                              {"uniform", engine::LatencyKind::kUniform},
                                                              {"normal", engine::LatencyKind::kNormal},
                                                              {"exponential", engine::LatencyKind::kExponential}}};

inline constexpr Names<truth::GeomagneticIndex, 2> kGeomagneticIndices{
    {{"daily", truth::GeomagneticIndex::kDaily}, {"three_hourly", truth::GeomagneticIndex::kThreeHourly}}};
inline constexpr Names<truth::Shadow, 3> kShadows{{{"none", truth::Shadow::kNone},
                                                   {"cylindrical", truth::Shadow::kCylindrical},
                                                   {"conical", truth::Shadow::kConical}}};

/// Returns the name of an enumerator; empty for an invalid value.
template <class Enum, std::size_t N>
constexpr std::string_view name_in(const Names<Enum, N>& names, Enum value) {
  for (const auto& [name, candidate] : names)
    if (candidate == value) return name;
  return {};
}

// Initial telecommands of a mission to its flight software that do not depend on its sensors, as messages of the packet
// contract. (The parameters of guidance are such a message in the mission.)

/// Returns all waypoints of the mission, including those that have passed at the start, which the flight software
/// skips. A mission has at most kMaxWaypoints of them (checked by the loader).
[[nodiscard]] vbar::waypoint_table waypoint_table_of(const Mission& mission);

[[nodiscard]] vbar::mode_command mode_command_of(const Mission& mission);

}  // namespace vbar::mission
