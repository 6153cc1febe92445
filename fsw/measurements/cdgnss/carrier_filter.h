#pragma once
// Update of the filter's relative estimate by differences of code and carrier phase: codes and outlying ones, channels
// of phases and their cycle slips, ambiguities that are held or released.
//
// The clock difference is free at every epoch. The jitter of the phase centres is a state of its own, new at every
// epoch, because it moves the ranges of all satellites together. Antenna offsets are constant in each body: for
// constant attitudes they are equivalent to a displacement, and only the dynamics separate the two. Phases may carry a
// time-correlated error beside their white noise, one Gauss-Markov state a channel (PhaseWander). Integers are
// held on the ambiguities alone; their covariance is marginal, so that their validation includes the wander.

#include <array>
#include <cstdint>
#include <optional>

#include "fsw/filter/relative_navigation_filter.h"
#include "fsw/gnss/differential.h"
#include "fsw/measurements/cdgnss/displacement_test.h"
#include "fsw/measurements/cdgnss/single_differences.h"

namespace vbar::fsw::measurements {

/// 1-sigma values of the states of the receivers.
struct CarrierFilterSettings {
  double antenna_offset_sigma_m = 3.2e-3;  ///< per axis of each antenna with respect to its nominal position
  double phase_centre_jitter_m = 1.0e-3;   ///< per axis of each antenna, from epoch to epoch
  double code_bias_sigma_m = 2.0;          ///< between signals, of the difference of two receivers

  bool operator==(const CarrierFilterSettings&) const = default;
};

/// Results of one epoch.
struct CarrierUpdate {
  std::int32_t codes_used = 0;
  std::int32_t codes_rejected = 0;
  std::int32_t phases_used = 0;
  std::int32_t phases_rejected = 0;
  std::int32_t slips = 0;
  std::int32_t contradictions = 0;  ///< held channels released although their receivers reported no loss of lock
  /// Likelihood ratio of the displacement to which the estimate was opened; 0: it was not contradicted.
  double displacement_ratio = 0.0;
  double code_nis = 0.0;  ///< sums over the observations used; each is expected to be near their number
  double phase_nis = 0.0;
};

class CarrierFilter {
 public:
  /// Replaces the settings. A changed sigma of the offsets replaces what widen_antennas() has made of the former one.
  void configure(const CarrierFilterSettings& settings);

  /// Activates the antenna offsets, the code biases and the empirical acceleration, those of them that are inactive.
  void activate_blocks(filter::RelativeNavigationFilter& filter) const;
  /// Deactivates all blocks of the receivers and releases all channels; the orbit keeps its covariance.
  void deactivate_blocks(filter::RelativeNavigationFilter& filter);
  /// Deactivates the states of an epoch: clock difference and jitter.
  static void deactivate_epoch_states(filter::RelativeNavigationFilter& filter);
  /// Releases all channels, ambiguities and wander; the orbit keeps its covariance.
  void deactivate_channels(filter::RelativeNavigationFilter& filter);

  /// Processes the differences of an epoch; the filter stands at its tag and has a relative orbit.
  CarrierUpdate process_epoch(const gnss::DifferentialEpoch& epoch, const AntennaPlatform& servicer,
                              const AntennaPlatform& target, filter::RelativeNavigationFilter& filter);

  /// The single differences of two channels of one signal differ by an integer number of cycles, held from now on.
  void hold(filter::RelativeNavigationFilter& filter, std::size_t place, std::size_t reference, double cycles);
  /// Releases all integers; the orbit's covariance is inflated by `position_sigma_m` and the corresponding velocity:
  /// wrong integers may have shifted it by as much.
  void release(filter::RelativeNavigationFilter& filter, double position_sigma_m);

  /// Root of the sum of squares of both antennas' estimated offsets, over their assumed 1 sigma: beyond what a normal
  /// distribution allows, the nominal position of an antenna is wrong. A baseline shifted by d is divided among both,
  /// d / 2 each: the result is d over the sigma of the difference, of all axes that the dynamics observe.
  [[nodiscard]] double antenna_misfit(const filter::Estimate& estimate) const;
  /// 1 sigma of the offsets, per axis, m, as assumed at present.
  [[nodiscard]] double antenna_sigma_m() const { return antenna_sigma_m_; }
  /// The offsets may be larger by `factor` than assumed so far.
  void widen_antennas(filter::RelativeNavigationFilter& filter, double factor);

  [[nodiscard]] const PhaseChannels& channels() const { return channels_; }
  /// Index in the estimate of a channel's ambiguity, and of its wander.
  [[nodiscard]] static constexpr int ambiguity_index(std::size_t place) {
    return filter::kAt<Ambiguities> + static_cast<int>(place);
  }
  [[nodiscard]] static constexpr int wander_index(std::size_t place) {
    return filter::kAt<PhaseWander> + static_cast<int>(place);
  }

 private:
  enum class Observable : unsigned char { kCode, kPhase };

  struct Edit {
    bool has_outlying_code = false;
    std::optional<std::size_t> channel;
  };

  void renew_epoch_states(const AntennaPlatform& servicer, const AntennaPlatform& target, filter::Estimate& estimate);
  void follow_ionosphere(filter::RelativeNavigationFilter& filter) const;
  void find_outlying_codes(const gnss::DifferentialEpoch& epoch, const filter::Estimate& estimate);
  bool test_orbit(Observable observable, const gnss::DifferentialEpoch& epoch, filter::RelativeNavigationFilter& filter,
                  CarrierUpdate& update);
  [[nodiscard]] Displacement displacement_by(Observable observable, const gnss::DifferentialEpoch& epoch,
                                             const filter::Estimate& estimate);
  /// Whether the ambiguity of a channel was determined after `since`.
  [[nodiscard]] bool is_of_displaced_orbit(std::size_t place, GpsTime since) const {
    const PhaseChannel& channel = channels_[place];
    return channel.in_use && channel.epochs > 0 && channel.first_seen > since;
  }
  [[nodiscard]] int proven_in(const gnss::DifferentialEpoch& epoch) const;
  bool open_orbit(const Displacement& displacement, Observable observable, GpsTime now,
                  filter::RelativeNavigationFilter& filter);
  void use_codes(const gnss::DifferentialEpoch& epoch, filter::Estimate& estimate, CarrierUpdate& update);
  void follow_channels(const gnss::DifferentialEpoch& epoch, filter::Estimate& estimate, CarrierUpdate& update);
  void find_slips_by_median(const gnss::DifferentialEpoch& epoch, filter::Estimate& estimate, CarrierUpdate& update);
  void use_phases(const gnss::DifferentialEpoch& epoch, filter::RelativeNavigationFilter& filter,
                  CarrierUpdate& update);
  static void deactivate(std::size_t place, filter::Estimate& estimate);
  void lose(std::size_t place, filter::Estimate& estimate);
  void contradict(std::size_t place, filter::Estimate& estimate, CarrierUpdate& update);

  CarrierFilterSettings settings_;
  double antenna_sigma_m_ = CarrierFilterSettings{}.antenna_offset_sigma_m;
  PhaseChannels channels_;
  DisplacementTest test_;
  std::optional<GpsTime> last_epoch_;  ///< processed before the present one
  std::optional<GpsTime> verified_;    ///< the phases of enough proven channels have agreed with the orbit last
  DifferenceRows rows_;
  std::array<Edit, gnss::kMaxObservations> edits_{};
};

/// Jacobian of the ROE (dimensionless) with respect to the target's inertial state (m, m/s), by central differences.
[[nodiscard]] Result<Matrix6> roe_from_target_jacobian(const orbit::CartesianState& servicer,
                                                       const orbit::CartesianState& target);

}  // namespace vbar::fsw::measurements
