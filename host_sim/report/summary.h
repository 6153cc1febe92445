#pragma once
// summary.json: what scripts and CI read of a run. Facts are known of a run alone; figures follow from its tables
// (summarise.h).

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <vbar/fields.h>

#include "host_sim/report/provenance.h"

namespace vbar::report {

struct MeanAndDeviation {
  double mean = 0.0, std = 0.0;
};

/// Error of the bearings to a target that is no larger than a pixel.
struct BearingError {
  double mean = 0.0;  ///< size
  double std = 0.0;   ///< standard deviation of each axis about the bias
  double bias = 0.0;  ///< size of the mean
};

/// The estimate of the last step until a selected time, and the last consistency figures since the one before.
struct Sample {
  double time_h = 0.0;  ///< after the epoch
  std::optional<double> navigation_error_m = {}, navigation_error_r_m = {}, navigation_error_t_m = {},
                        navigation_error_n_m = {}, navigation_velocity_error_mps = {};
  /// Uncertainty as navigation claims it: square root of the sum of the variances, and each axis.
  std::optional<double> sigma_m = {}, sigma_r_m = {}, sigma_t_m = {}, sigma_n_m = {}, sigma_velocity_mps = {};
  std::optional<double> nees = {}, nees_dimension = {}, nis = {}, nis_dimension = {};
};

/// Counts of the measurements of a source, its failures and, in real time, its late starts.
struct SourceFigures {
  std::string name;  ///< "servicer/gnss"
  std::string kind;  ///< "digital", "recorded" or the name of a testbed
  std::int64_t epochs = 0, failures = 0;
  std::string last_failure;  ///< why; all reasons are in notes.csv
  std::uint64_t late = 0;
  double latest_s = 0.0;               ///< largest lateness
  std::uint64_t packets_rejected = 0;  ///< packets of impossible times or values; all reasons are in notes.csv
};

/// Figures of a testbed on the run, by name with the unit: "edges_missing", "bench".
using TestbedFigures = std::map<std::string, std::variant<double, std::string>>;

/// Burns against the thrust that the mission states (statistics.h).
struct Thrust {
  double max_thrust_n = 0.0, mass_kg = 0.0;  ///< facts of the mission
  int burns = 0;                             ///< executed burns of the flight software
  int burns_too_long = 0;                    ///< would last longer than the time to the next one
  double longest_burn_s = 0.0, longest_burn_at_h = 0.0;
};

/// What the flight software sent and failed to do, in numbers of steps and of packets. Steps in which a fault of the
/// mission had the flight computer off do not count.
struct FlightOutput {
  std::uint64_t steps = 0;
  std::uint64_t steps_failed = 0;  ///< whose function returned a status other than 0; in process only
  std::int32_t last_status = 0;    ///< status of the last of these
  std::uint64_t steps_silent = 0;  ///< without any packet
  std::uint64_t packets = 0;
  std::uint64_t packets_invalid = 0;  ///< that are not whole, or not of a valid content
  std::uint64_t packets_dropped = 0;  ///< not of a packet's size, or more than an answer holds
  std::uint64_t inputs_refused = 0;   ///< packets given to it whose reception returned a status other than 0
};

/// Facts about a run that its tables do not hold.
struct RunFacts {
  std::string mission;
  std::uint64_t seed = 0;
  bool complete = false;
  std::string incomplete_reason;
  std::string verdict = "incomplete";  ///< report::word_of(Outcome), by the goals of the mission (verdict.h)
  std::string verdict_reason;          ///< one sentence
  std::vector<int> missed_waypoints;
  std::string flight_computer, flight_software, camera, gnss, navigation;
  std::string target;  ///< the spacecraft that is approached
  double simulated_s = 0.0, wall_s = 0.0, speed_factor = 0.0;
  /// Distance, by the draws of this run, between the true places of the antennas and those that navigation assumes, for
  /// bodies with parallel axes. It is the error of navigation that assumes the nominal places; navigation that
  /// estimates them from the motion may do better.
  std::optional<double> static_floor_m;
  std::string commands_sha256, telemetry_sha256;
  FlightOutput flight_output;
  struct Link {
    std::uint64_t bytes = 0, frames_resent = 0, frames_rejected = 0, frames_duplicated = 0, strangers_ignored = 0;
    int baud = 0;                                        ///< rate of a serial line; 0: none, or as fast as it goes
    double step_share_max = 0.0, step_share_mean = 0.0;  ///< share of a step's period that its bytes take at that rate
    // Bytes of a receiver that is wired to the flight computer (pil::WiredStatistics).
    std::uint64_t wired_bytes = 0, wired_bytes_dropped = 0, wired_bytes_missing = 0, wired_timeouts = 0;
  } link;
  struct Deadlines {
    std::uint64_t compute_overruns = 0, wakeups_late = 0, link_late = 0, simulation_late = 0;
  } deadlines;
  std::vector<SourceFigures> sources;
  std::map<std::string, TestbedFigures> testbeds;  ///< by the name of the testbed, which is its key in summary.json
  struct WallShare {
    double truth_s = 0.0, flight_s = 0.0, link_s = 0.0, other_s = 0.0;
    // Time of a digital camera, on a thread of its own: beside the others, not part of their sum.
    double render_s = 0.0, detector_s = 0.0, packing_s = 0.0;
  } wall_share;
  std::vector<std::string> data_notes;  ///< on data that are missing, predicted or used in part
  Provenance provenance;
};

struct Summary : RunFacts {
  /// Over all steps with a valid estimate; from the first fix on if there was one.
  std::optional<MeanAndDeviation> navigation_error_m, navigation_velocity_error_mps;
  std::optional<MeanAndDeviation> attitude_error_deg;
  std::optional<double> first_fix_s;  ///< GNSS: since the start: the first step whose estimate is by fixed ambiguities
  /// Mean normalised estimation error squared of the relative state over the steps of navigation_error_m, or over the
  /// images that angles-only navigation used; 6 if consistent.
  std::optional<double> navigation_nees;
  std::optional<double> navigation_nees_dimension;
  /// Mean normalised innovation squared over all measurement updates, and the mean number of innovations in it, which
  /// it equals if consistent.
  std::optional<double> navigation_nis, navigation_nis_dimension;
  std::vector<Sample> samples;  ///< at the times that the mission selects
  // Angles-only navigation only.
  std::optional<BearingError> bearing_error_arcsec;
  std::optional<MeanAndDeviation> star_attitude_error_arcsec;  ///< error of the boresight
  /// Figures of modules: numbers by name, for each subject ("pose") or sensor.
  std::map<std::string, std::map<std::string, double>> sensor_figures;
  /// The flight software reported that it never navigated, and no estimate was valid: a fault of the run.
  bool never_navigated = false;
  std::optional<double> min_distance_m, min_distance_at_h;  ///< true, to the target
  double dv_mps = 0.0;
  int maneuvers = 0;
  std::optional<Thrust> thrust;  ///< thrust of a mission that states one
  struct FlightStep {
    std::uint64_t count = 0, max = 0;
    double mean = 0.0;
    std::string unit = "none";
    std::uint32_t stack_bytes_max = 0;
  } flight_step;
  std::optional<telemetry_health> health;  ///< what the flight software counted until its last step
};

}  // namespace vbar::report
