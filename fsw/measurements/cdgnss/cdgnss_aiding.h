#pragma once
// Differences of two receivers' code and phase as an aid of the filter: when they start, pause and fail.
//
//   waiting -> starting (code baselines compared with the filter) -> aiding <-> suspended (silent) | failed
//   (contradicted)
//
// The coarse baseline of codes initialises the relative orbit only if the filter has none but an a-priori one. An orbit
// of other sensors is never re-initialised: phases join it once three consecutive baselines agree with it.

#include <cstdint>
#include <optional>

#include "fsw/gnss/ephemeris.h"
#include "fsw/gnss/observation.h"
#include "fsw/gnss/single_point.h"
#include "fsw/measurements/aid.h"
#include "fsw/measurements/cdgnss/ambiguity_resolution.h"
#include "fsw/measurements/cdgnss/carrier_filter.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw::measurements {

struct CarrierSettings {
  CarrierFilterSettings filter;
  AmbiguitySettings ambiguities;
  Vector3 servicer_antenna_body_m = Vector3::Zero();  ///< nominal phase centres, from the centres of mass
  Vector3 target_antenna_body_m = Vector3::Zero();
  double start_sigma_m = 5.0;         ///< of a code baseline, per axis, in addition to that of its geometry
  double start_velocity_sigma = 0.2;  ///< m/s, per axis, at most: two code baselines are usually better
};

/// Observations of both receivers with one tag, at which the filter stands.
struct PairEpoch {
  const gnss::ObservationEpoch& ours;
  const gnss::ObservationEpoch& theirs;
  double servicer_clock_m = 0.0;  ///< by the servicer's single-point solution
  std::optional<Matrix3> R_eci_servicer;
  std::optional<Matrix3> R_eci_target;
  const gnss::EphemerisStore& ephemerides;
  const gnss::EarthFrame& frame;
};

struct CarrierCounters {
  std::int32_t pairs = 0;         ///< epochs of both receivers processed
  std::int32_t no_solution = 0;   ///< pairs without a single-point solution of the target, or without attitude
  std::int32_t not_admitted = 0;  ///< pairs while starting or failed, or of another time than the filter's
  std::int32_t codes_rejected = 0;
  std::int32_t phases_rejected = 0;
  std::int32_t slips = 0;
  std::int32_t starts = 0;    ///< of the relative orbit, by a code baseline
  std::int32_t restarts = 0;  ///< starts after the first
  std::int32_t failures = 0;  ///< the own blocks were discarded
};

class CdgnssAiding {
 public:
  static constexpr filter::MeasurementSource kSource{.bit = navigation_configuration::kUseCarrierPair,
                                                     .confirms_orbit = true};

  /// Replaces the settings. If those of the blocks have changed, the blocks are discarded at the next epoch.
  void configure(const CarrierSettings& settings);

  /// Processes a pair; false if it was not used.
  bool process(const PairEpoch& pair, filter::RelativeNavigationFilter& filter);

  /// Suspends, at each step, after kSilence without a pair, and releases the ambiguities after kKept.
  void watch(GpsTime now, filter::RelativeNavigationFilter& filter);

  /// Suspends the source, whose pairs will not be processed for a time: deactivates the states of an epoch and the
  /// ambiguities; the orbit stays.
  void suspend(GpsTime now, filter::RelativeNavigationFilter& filter);

  /// Deactivates the own blocks; the orbit stays.
  void stop(GpsTime now, filter::RelativeNavigationFilter& filter);

  /// Counts an epoch of both receivers that could not be used because the servicer's had no solution.
  void count_no_solution() { ++counters_.no_solution; }

  /// Notes that another source has estimated the relative orbit since: this one does not re-initialise it any more.
  void share_orbit() { owns_orbit_ = false; }
  [[nodiscard]] bool owns_orbit() const { return owns_orbit_; }

  [[nodiscard]] const CarrierUpdate& last_update() const { return last_update_; }
  [[nodiscard]] std::optional<GpsTime> last_pair() const { return last_pair_; }
  [[nodiscard]] const AmbiguityReport& report() const { return ambiguities_.report(); }
  [[nodiscard]] bool is_fixed() const { return aid_.state() == AidState::kAiding && ambiguities_.is_fixed(); }
  [[nodiscard]] const CarrierCounters& counters() const { return counters_; }
  [[nodiscard]] const CarrierFilter& filter() const { return filter_; }
  [[nodiscard]] Aid& aid() { return aid_; }
  [[nodiscard]] const Aid& aid() const { return aid_; }

  static constexpr Duration kSilence = duration_of_seconds(30);
  /// Ambiguities are kept through outages: the lock times of both receivers at the end of one tell which still hold.
  static constexpr Duration kKept = duration_of_seconds(3600);
  /// An empirical acceleration that has decayed to its stationary distribution is deactivated.
  static constexpr Duration kEmpiricalKept = duration_of_seconds(7200);
  static constexpr Duration kFailedPause = duration_of_seconds(600);
  /// Time between the two baselines that initialise the orbit.
  static constexpr Duration kBaselinesApart = duration_of_seconds(60);
  static constexpr int kMinAgreeing = 3;
  /// The orbit is contradicted by most codes in this number of consecutive epochs.
  static constexpr int kMaxContradicted = 5;
  /// Estimated offsets of the antennas beyond this multiple of their sigma contradict the sigma, which then grows by
  /// that multiple: an offset along the track, which is an orbit as well, may be as large as those that are observed.
  /// Of chi-square with three degrees of freedom, 1.5e-4 is beyond its square; offsets within the sum of a centre of
  /// mass in a ball of 3 mm and a phase centre at 5 mm reach 3.5.
  static constexpr double kMaxAntennaMisfit = 4.5;

 private:
  struct CodeBaseline {
    Vector3 relative_eci = Vector3::Zero();  ///< of the centres of mass at the tag, m
    double sigma_m = 0.0;                    ///< per axis
    double noise_m = 0.0;                    ///< the part of sigma_m that differs from epoch to epoch
  };
  struct FirstBaseline {
    GpsTime time;
    CodeBaseline baseline;
  };

  [[nodiscard]] std::optional<CodeBaseline> code_baseline(const PairEpoch& pair, const gnss::SinglePoint& their_point,
                                                          const filter::RelativeNavigationFilter& filter) const;
  bool admit(const PairEpoch& pair, const gnss::SinglePoint& their_point, filter::RelativeNavigationFilter& filter);
  bool begin_orbit(const PairEpoch& pair, const gnss::SinglePoint& their_point,
                   filter::RelativeNavigationFilter& filter);
  [[nodiscard]] bool agrees(const PairEpoch& pair, const gnss::SinglePoint& their_point,
                            const filter::RelativeNavigationFilter& filter) const;
  void discard(filter::RelativeNavigationFilter& filter);
  void give_up(GpsTime time, filter::RelativeNavigationFilter& filter);
  void judge(GpsTime time, filter::RelativeNavigationFilter& filter);
  void judge_integers(filter::RelativeNavigationFilter& filter);
  void judge_antennas(filter::RelativeNavigationFilter& filter);

  CarrierSettings settings_;
  bool has_changed_ = false;
  Aid aid_;
  CarrierFilter filter_;
  AmbiguityResolution ambiguities_;
  gnss::DifferentialEpoch differences_;
  std::optional<GpsTime> last_pair_;
  std::optional<FirstBaseline> first_baseline_;  ///< while the relative orbit is initialised
  bool owns_orbit_ = false;
  bool must_begin_ = false;  ///< the own orbit was given up
  int agreeing_in_a_row_ = 0;
  int contradicted_in_a_row_ = 0;  ///< epochs whose codes were mostly rejected
  CarrierCounters counters_;
  CarrierUpdate last_update_;
};

}  // namespace vbar::fsw::measurements
