#pragma once
// What a run leaves behind, as rows: filled while the mission flies, written to the run folder, read back for the
// report. SI units; frames in the names; ROE are mean, times the reference semi-major axis.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/report/provenance.h"

namespace vbar::report {

using Pair = std::array<double, 2>;
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

/// What angles-only navigation said of an image (fsw/packets/vbar.lcm, telemetry_image), and what was true at its
/// exposure (images.csv, only if a run has such navigation). Counts at the end are since the start.
struct ImageRow {
  double time_s = 0.0;       ///< middle of the exposure, since the mission's epoch
  double step_time_s = 0.0;  ///< of the step that told of it
  std::int64_t step = 0;
  std::int32_t image = 0;
  int status = 0;  ///< why no bearing came of it; 0: one did
  int star_method = 0;
  int tiles_missing = 0, objects = 0, stars = 0, hypotheses = 0;
  int target_object = -1;  ///< the flight software's choice, an index in objects.csv; -1: none
  int true_object = -1;    ///< the one that is really the target; -1: none is, or nobody can tell
  std::string chosen;      ///< the spacecraft that the choice really is, "nothing" if none; empty without a choice
  double background_dn = 0.0, noise_dn = 0.0;
  Quadruple q_eci_camera{1.0, 0.0, 0.0, 0.0};  ///< from the stars; w, x, y, z
  double attitude_sigma_arcsec = 0.0;
  Triple bearing_eci{};
  double bearing_sigma_arcsec = 0.0;
  Pair prefit_arcsec{}, postfit_arcsec{};  ///< in the plane of the orbit and across it
  double nis = 0.0;                        ///< two degrees of freedom
  int used = 0;                            ///< 0: navigation refused it, 1: filter, 2: batch
  LowerTriangle6 covariance_a_roe_m2{};
  Sextuple a_roe_osculating_m{};
  std::int32_t bearings_used = 0, bearings_refused = 0, images_without_stars = 0, tiles_refused = 0;
  // The truth. Errors are estimated less true; absent where the flight software gave nothing.
  std::optional<double> range_m;
  std::optional<double> bearing_error_x_arcsec, bearing_error_y_arcsec;            ///< against the centre of mass
  std::optional<double> attitude_error_across_arcsec, attitude_error_roll_arcsec;  ///< of the boresight, and about it
  std::optional<double> nees;  ///< of the osculating ROE, six degrees of freedom; of images that the filter used
  friend bool operator==(const ImageRow&, const ImageRow&) = default;
};

/// What the flight software took an object of an image for (objects.csv).
struct ObjectRow {
  double time_s = 0.0;
  std::int32_t image = 0;
  int object = 0;  ///< brightest first
  int kind = 0;    ///< 0 not matched, 1 star, 2 target, 3 hot pixel
  std::int32_t star = 0;
  float x_px = 0.0F, y_px = 0.0F;  ///< on the detector
  friend bool operator==(const ObjectRow&, const ObjectRow&) = default;
};

/// What navigation by the pose network said of an image (fsw/packets/vbar.lcm, telemetry_pose), and what was true at
/// its exposure (poses.csv, only if a run has such navigation). Counts are since the start.
struct PoseRow {
  double time_s = 0.0;       ///< middle of the exposure, since the mission's epoch
  double step_time_s = 0.0;  ///< of the step that told of it
  std::int64_t step = 0;
  std::int32_t image = 0;
  int status = 0;  ///< what came of it; 0: a pose
  int region_is_predicted = 0, fate = 0, filter_runs = 0, has_attitude = 0, tiles_missing = 0;
  Triple region_px{};                               ///< of the crop: centre, side
  int pnp_inliers = 0;                              ///< 0: no pose
  Quadruple pnp_q_camera_body{1.0, 0.0, 0.0, 0.0};  ///< to camera axes from the target's body; w, x, y, z
  Triple pnp_position_camera_m{};                   ///< of the target's centre of mass
  double pnp_mean_square = 0.0;                     ///< of whitened residuals
  Quadruple q_camera_body{1.0, 0.0, 0.0, 0.0};      ///< as navigation has it after the image
  Triple position_camera_m{}, rate_body_radps{};
  LowerTriangle6 covariance_attitude{};  ///< turn about the body axes (rad), rate (rad/s)
  LowerTriangle6 covariance_a_roe_m2{};
  Sextuple a_roe_osculating_m{};
  double nis = 0.0;  ///< of all keypoints folded in
  std::int32_t nis_degrees = 0;
  double acceleration_psd = 0.0;
  std::int32_t images_used = 0, images_refused = 0, keypoints_used = 0, keypoints_refused = 0;
  std::int32_t attitude_restarts = 0, restarts = 0, tiles_refused = 0;
  // The truth. Errors are estimated less true; absent where the flight software gave nothing.
  std::optional<double> range_m, sunlit;
  std::optional<double> pnp_error_x_m, pnp_error_y_m, pnp_error_z_m, pnp_error_deg;        ///< in camera axes
  std::optional<double> attitude_error_deg;                                                ///< in all
  std::optional<double> attitude_error_x_deg, attitude_error_y_deg, attitude_error_z_deg;  ///< about body axes
  std::optional<double> rate_error_radps;
  std::optional<double> nees, attitude_nees;  ///< of osculating ROE, of turn and rate: six degrees of freedom each
  friend bool operator==(const PoseRow&, const PoseRow&) = default;
};

/// A keypoint of such an image (keypoints.csv).
struct KeypointRow {
  double time_s = 0.0;
  std::int32_t image = 0;
  int keypoint = 0;
  int fate = 0;  ///< 0 not usable, 1 refused, 2 folded in, 3 usable, but no filter to take it
  float peak = 0.0F;
  float x_px = 0.0F, y_px = 0.0F;  ///< on the detector
  float covariance_xx_px2 = 0.0F, covariance_xy_px2 = 0.0F, covariance_yy_px2 = 0.0F;
  std::optional<double> error_x_px, error_y_px;
  friend bool operator==(const KeypointRow&, const KeypointRow&) = default;
};

/// An image worth looking at, with marks about what was found in it (gallery.csv and gallery/<image>.png).
struct GalleryImage {
  double time_s = 0.0;
  std::int32_t image = 0;
  std::string caption;
  std::vector<std::uint8_t> png;  ///< the file's bytes
  friend bool operator==(const GalleryImage&, const GalleryImage&) = default;
};

/// A maneuver from command to execution (maneuvers.csv).
struct ManeuverRow {
  int maneuver_id = 0, waypoint_index = -1, solver = -1;
  double command_time_s = 0.0, execution_time_s = 0.0;
  bool accepted = false;
  Triple commanded_dv_rtn_mps{}, executed_dv_rtn_mps{};
  friend bool operator==(const ManeuverRow&, const ManeuverRow&) = default;
};

/// A residual of navigation (residuals.csv); none with ideal navigation. In the unit that the sensor's name ends in.
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

/// Of the bearings to a target that is no larger than a pixel.
struct BearingError {
  double mean = 0.0;  ///< size
  double std = 0.0;   ///< of each axis about the bias
  double bias = 0.0;  ///< size of the mean
  friend bool operator==(const BearingError&, const BearingError&) = default;
};

struct ImageCounts {
  int images = 0;
  int with_bearing = 0;
  int wrong_targets = 0;  ///< images whose choice is not the target
  friend bool operator==(const ImageCounts&, const ImageCounts&) = default;
};

/// Of navigation by the pose network.
struct PoseFigures {
  int images = 0;
  int with_pose = 0;                 ///< by PnP
  int poses_over_10_deg = 0;         ///< of them, more than 10 deg off
  double keypoint_error_px = 0.0;    ///< median of those usable
  double keypoint_chi_square = 0.0;  ///< median normalised squared error of those usable; 1.39 is honest
  /// Position error over the images of a lit target alone, m.
  MeanAndDeviation lit_navigation_error_m;
  std::optional<double> attitude_nees;  ///< mean; turn and rate, 6 is honest
  int attitude_restarts = 0, restarts = 0;
  friend bool operator==(const PoseFigures&, const PoseFigures&) = default;
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
  /// Mean normalised estimation error squared of the relative state over the steps of navigation_error_m, or over the
  /// images that angles-only navigation used; 6 is honest.
  std::optional<double> navigation_nees;
  // Angles-only navigation only.
  std::optional<BearingError> bearing_error_arcsec;
  std::optional<MeanAndDeviation> star_attitude_error_arcsec;  ///< of the boresight
  std::optional<ImageCounts> images;
  // Navigation by the pose network only.
  std::optional<PoseFigures> pose;
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
    // Of a digital camera, on a thread of its own: beside the others, not part of their sum.
    double render_s = 0.0, detector_s = 0.0, packing_s = 0.0;
    friend bool operator==(const WallShare&, const WallShare&) = default;
  } wall_share;
  Provenance provenance;
  friend bool operator==(const Summary&, const Summary&) = default;
};

struct RunRecord {
  Summary summary;
  std::vector<WaypointRow> waypoints;
  std::vector<TruthRow> truth;
  std::vector<AttitudeRow> attitudes;
  std::vector<EstimateRow> estimates;
  std::vector<GnssRow> gnss;
  std::vector<ImageRow> images;
  std::vector<ObjectRow> objects;
  std::vector<PoseRow> poses;
  std::vector<KeypointRow> keypoints;
  std::vector<GalleryImage> gallery;
  std::vector<ManeuverRow> maneuvers;
  std::vector<ResidualRow> residuals;
  friend bool operator==(const RunRecord&, const RunRecord&) = default;
};

}  // namespace vbar::report
