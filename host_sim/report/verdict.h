#pragma once
// Verdict on a mission: its outcome, decided from the record of its run and the truth in that record. No wall
// clock enters, so that a resumed or repeated flight has the same verdict.
//
// The default criteria are those of the mission itself:
// - Navigation has a valid estimate at each waypoint and, once it had one, at the end of the run.
// - The control error of a waypoint is within accepted_control_error_m.
// - The true distance is never below the keep-out radius of the leg.
// A [[limit]] of the mission on the same number replaces a criterion; every other limit is a criterion of its own.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/report/run_record.h"

namespace vbar::report {

/// Outcomes in order of severity: of several findings the last one gives the word.
enum class Outcome {
  kAchieved,
  kAchievedWithFaults,
  kNotJudged,
  kMissed,
  kNavigationLost,
  kRetreated,
  kNeverNavigated,
  kUnsafe,
  kIncomplete
};

/// A waypoint that the mission asks for.
struct Goal {
  int index = 0;
  double time_s = 0.0;             ///< since the mission's epoch
  double keep_out_radius_m = 0.0;  ///< radius of the leg that ends here
  double size_m = 0.0;             ///< size of the relative orbit: norm of its elements times the semi-major axis
};

/// A limit of the mission against the numbers of the summary.
struct JudgedLimit {
  std::string key;
  std::string missed;  ///< the sentence that says by what; empty: met
};

/// Goals of a mission for its run.
struct Goals {
  bool approaches = false;         ///< guidance flies the waypoint table
  bool retreats = false;           ///< a retreat is what the mission commands
  double keep_out_radius_m = 0.0;  ///< where no waypoint states its own
  double dv_max_mps = 0.0;
  std::vector<Goal> waypoints;  ///< in order of time
  std::vector<JudgedLimit> limits;
};

struct Verdict {
  Outcome outcome = Outcome::kIncomplete;
  std::string reason;                 ///< one sentence without a full stop
  std::vector<int> missed_waypoints;  ///< whose control error is not accepted
};

/// Control errors that count as reaching a waypoint: a two-thousandth of the leg that ends there, and a fifth of the
/// smallest keep-out margin (Goal::size_m less the keep-out radius) of the mission's waypoints after the start. The
/// first is the scale of a transfer: relative orbital elements neglect terms of the order of the eccentricity and of
/// the separation over the orbit's radius, 1e-3 of the leg, of which corrections on the way leave less than half, and
/// the next leg removes such an error at a two-thousandth of its delta-v. The second is the scale of the mission's end:
/// four fifths of the margin remain for the navigation error and the drift after a missed burn. One for each row of the
/// record; the first leg begins at the true place at the start.
[[nodiscard]] std::vector<double> accepted_control_error_m(const RunRecord& record, const Goals& goals);

/// Returns the verdict of a record whose summary is evaluated (summarise.h) and says whether the run is complete.
[[nodiscard]] Verdict verdict_of(const RunRecord& record, const Goals& goals);

/// "navigation lost", as terminal, summary, page and campaigns print it.
[[nodiscard]] std::string_view word_of(Outcome outcome);

/// One sentence on the outcome, for the reader of the word.
[[nodiscard]] std::string_view meaning_of(Outcome outcome);

/// Returns the outcome that a word stands for; kIncomplete for an unknown one.
[[nodiscard]] Outcome outcome_of(std::string_view word);

/// A mission that is achieved, or whose run was too short for any criterion.
[[nodiscard]] bool is_favourable(Outcome outcome);

/// Figure of a testbed whose digital twin took over: since when, in hours of the mission.
inline constexpr std::string_view kHandedOver = "handed_over_h";

/// "achieved: 10 waypoints reached, ..."
[[nodiscard]] std::string verdict_line(const Summary& summary);

}  // namespace vbar::report
