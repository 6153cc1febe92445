#pragma once
// What a run leaves behind, as rows: filled while the mission flies, written to the run folder, read back for the
// report. SI units; frames in the names; ROE are mean, times the reference semi-major axis.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace vbar::report {

using Triple = std::array<double, 3>;
using Sextuple = std::array<double, 6>;
using Quadruple = std::array<double, 4>;
/// A symmetric 6x6 matrix: lower triangle by rows.
using LowerTriangle6 = std::array<double, 21>;

/// Truth at a step (truth.csv).
struct TruthRow {
  double time_s = 0.0;  ///< since the mission's epoch
  Triple servicer_position_eci{}, servicer_velocity_eci{};
  Triple target_position_eci{}, target_velocity_eci{};
  Triple relative_position_rtn{}, relative_velocity_rtn{};  ///< target in the servicer's RTN
  Sextuple a_roe_mean_m{};
  friend bool operator==(const TruthRow&, const TruthRow&) = default;
};

/// True attitude of one spacecraft at a step (attitude.csv, only if the mission has attitudes).
struct AttitudeRow {
  double time_s = 0.0;
  std::string spacecraft;
  Quadruple q_body_eci{1.0, 0.0, 0.0, 0.0};  ///< w, x, y, z: turns ECI components into body components
  Triple rate_body_radps{};                  ///< of the body with respect to ECI, in body axes
  friend bool operator==(const AttitudeRow&, const AttitudeRow&) = default;
};

/// What the flight software said of itself at a step (estimate.csv).
struct EstimateRow {
  double time_s = 0.0;
  std::int64_t step = 0;
  int navigation_source = 0, navigation_valid = 0;
  Triple relative_position_rtn{}, relative_velocity_rtn{};
  Sextuple sigma_rtn{};
  Sextuple a_roe_mean_m{}, a_roe_desired_m{}, predicted_a_roe_error_m{};
  int mode = 0, active_solver = -1, waypoint_index = -1, planned_burns = 0;
  int koenig_damico_status = 0, closed_form_status = 0, least_squares_status = 0, safety_status = 0;
  double planned_dv_mps = 0.0, passive_safety_distance_m = 0.0, commanded_dv_mps = 0.0;
  std::uint64_t step_cost = 0;  ///< instructions or cycles, 0 where the target cannot count them
  std::uint32_t stack_bytes = 0;
  friend bool operator==(const EstimateRow&, const EstimateRow&) = default;
};

/// What navigation by GNSS said of itself at a step (gnss.csv, only if a run has such navigation). Counts are since the
/// start of the flight software.
struct GnssRow {
  double time_s = 0.0;
  std::int64_t step = 0;
  std::optional<double> epoch_s;  ///< of the last measurements folded in, as time_s
  std::int32_t pairs = 0;         ///< epochs of both receivers folded in
  std::int32_t alone = 0, too_late = 0, no_solution = 0;
  std::int32_t tracked = 0;  ///< carriers that both receivers follow
  std::int32_t fixed = 0;    ///< of them, held to integers
  std::int32_t fixes = 0, releases = 0, slips = 0, restarts = 0;
  std::string obstacle;  ///< what kept the last decision from holding all
  double success_rate = 0.0, ratio = 0.0;
  std::int32_t codes_used = 0, phases_used = 0;  ///< in the last epoch
  std::int32_t codes_refused = 0, phases_refused = 0;
  double code_nis = 0.0, phase_nis = 0.0;  ///< of the last epoch: sums of normalised innovations squared
  LowerTriangle6 covariance_rtn{};         ///< of the relative state at epoch_s: m^2, m^2/s, m^2/s^2
  std::int32_t messages = 0;               ///< of both receivers
  std::int32_t messages_refused = 0;       ///< and what only looked like one, by a chance pattern of bytes
  friend bool operator==(const GnssRow&, const GnssRow&) = default;
};

/// A maneuver from command to execution (maneuvers.csv).
struct ManeuverRow {
  int maneuver_id = 0, waypoint_index = -1, solver = -1;
  double command_time_s = 0.0, execution_time_s = 0.0;
  bool accepted = false;
  Triple commanded_dv_rtn_mps{}, executed_dv_rtn_mps{};
  friend bool operator==(const ManeuverRow&, const ManeuverRow&) = default;
};

/// A residual of navigation (residuals.csv); none with ideal navigation.
struct ResidualRow {
  double time_s = 0.0;
  std::string sensor;
  double prefit = 0.0, postfit = 0.0, sigma = 0.0;
  friend bool operator==(const ResidualRow&, const ResidualRow&) = default;
};

/// A waypoint of the table and how it was met (waypoints.csv).
struct WaypointRow {
  int index = 0;
  double time_s = 0.0;
  Sextuple a_roe_desired_m{}, a_roe_actual_m{};
  Triple desired_position_rtn{}, actual_position_rtn{};
  double control_error_m = 0.0;
  std::optional<double> navigation_error_m, navigation_velocity_error_mps;
  double leg_dv_mps = 0.0, cumulative_dv_mps = 0.0;
  int leg_maneuvers = 0;
  friend bool operator==(const WaypointRow&, const WaypointRow&) = default;
};

struct MeanAndDeviation {
  double mean = 0.0, std = 0.0;
  friend bool operator==(const MeanAndDeviation&, const MeanAndDeviation&) = default;
};

/// summary.json.
struct Summary {
  std::string mission;
  std::uint64_t seed = 0;
  bool complete = false;
  std::string incomplete_reason;
  std::string flight_computer, flight_software, camera, gnss, navigation;
  double simulated_s = 0.0, wall_s = 0.0, speed_factor = 0.0;
  /// Over all steps with a valid estimate; from the first fix on if there was one.
  std::optional<MeanAndDeviation> navigation_error_m, navigation_velocity_error_mps;
  std::optional<MeanAndDeviation> attitude_error_deg;
  // Navigation by GNSS only.
  std::optional<double> first_fix_s;  ///< since the start: the first step whose estimate is by fixed ambiguities
  /// Of this run's draws: the distance between the antennas' true places and those that navigation takes for true, as
  /// of bodies with parallel axes. Navigation that takes the nominal places errs by it; one that estimates them from
  /// the motion may do better.
  std::optional<double> static_floor_m;
  /// Mean normalised estimation error squared of the relative state over the steps of navigation_error_m; 6 is honest.
  std::optional<double> navigation_nees;
  double dv_mps = 0.0;
  int maneuvers = 0;
  std::string commands_sha256, telemetry_sha256;
  struct FlightStep {
    std::uint64_t count = 0, max = 0;
    double mean = 0.0;
    std::string unit = "none";
    std::uint32_t stack_bytes_max = 0;
    friend bool operator==(const FlightStep&, const FlightStep&) = default;
  } flight_step;
  struct Link {
    std::uint64_t bytes = 0, frames_resent = 0, frames_rejected = 0, frames_duplicated = 0, strangers_ignored = 0;
    int baud = 0;                                        ///< of a serial line; 0: none, or as fast as it goes
    double step_share_max = 0.0, step_share_mean = 0.0;  ///< of a step's period, that its bytes take at that rate
    friend bool operator==(const Link&, const Link&) = default;
  } link;
  struct Deadlines {
    std::uint64_t compute_overruns = 0, wakeups_late = 0, link_late = 0, simulation_late = 0;
    friend bool operator==(const Deadlines&, const Deadlines&) = default;
  } deadlines;
  struct WallShare {
    double truth_s = 0.0, flight_s = 0.0, link_s = 0.0, other_s = 0.0;
    friend bool operator==(const WallShare&, const WallShare&) = default;
  } wall_share;
  friend bool operator==(const Summary&, const Summary&) = default;
};

struct RunRecord {
  Summary summary;
  std::vector<WaypointRow> waypoints;
  std::vector<TruthRow> truth;
  std::vector<AttitudeRow> attitudes;
  std::vector<EstimateRow> estimates;
  std::vector<GnssRow> gnss;
  std::vector<ManeuverRow> maneuvers;
  std::vector<ResidualRow> residuals;
  friend bool operator==(const RunRecord&, const RunRecord&) = default;
};

}  // namespace vbar::report
