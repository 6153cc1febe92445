#pragma once
// The relative orbit from differences of carrier phase and code: one unscented filter over the relative orbit, the
// differential accelerations, the antenna offsets, clocks, and the carrier ambiguities in metres.
//
// The orbit is sampled; all other states enter linearly through the Jacobian (fsw/estimation/unscented.h). Receiver
// clocks are free at every epoch. The phase centres' jitter is a state of its own, new at every epoch, because it moves
// the ranges of all satellites together: as noise of each signal it would be independent, which it is not. Antenna
// offsets are constant in each body: for a spacecraft with constant attitude they are equivalent to a displacement, and
// only the dynamics separate the two - radial and cross-track well, along-track not at all. They are therefore
// estimated, and their unobservable part stays in the covariance.
//
// Carrier phases may carry a time-correlated error beside their white noise (an RF generator's channels, multipath):
// a phase is then range + ambiguity + wander + noise, with one first-order Gauss-Markov state a channel. An average
// over its correlation time does not reduce it, which a filter that takes it for white would assume. The integers are
// held on the ambiguities alone; their covariance is marginal, so that the integer validation includes the wander.

#include <array>
#include <cstdint>
#include <optional>

#include "fsw/core/gps_time.h"
#include "fsw/estimation/estimate.h"
#include "fsw/estimation/layout.h"
#include "fsw/navigation/differential.h"
#include "fsw/navigation/phase_channels.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::navigation {

/// 1-sigma values of the initial state and of unmodelled effects.
struct RelativeFilterSettings {
  double start_velocity_sigma = 0.2;       ///< m/s, in addition to the mean motion times the separation
  double acceleration_sigma = 3e-8;        ///< m/s^2, of differential drag, radiation pressure and gravity, per axis
  double acceleration_time_s = 1500.0;     ///< their correlation time
  double antenna_offset_sigma_m = 3.2e-3;  ///< per axis of each antenna with respect to its nominal position
  double phase_centre_jitter_m = 1.0e-3;   ///< per axis of each antenna, from epoch to epoch
  double phase_wander_sigma_m = 0.0;       ///< of the phase of one receiver's channel; 0: phase noise is white
  double phase_wander_time_s = 0.0;        ///< its correlation time, above 0 where the sigma is
  double code_bias_sigma_m = 2.0;          ///< between signals, of the difference of two receivers
  double maneuver_sigma = 2e-6;            ///< m/s, per axis of a burn
  double maneuver_sigma_relative = 2e-3;   ///< of its size
};

/// A-priori state of one receiver at an epoch.
struct ReceiverPlatform {
  orbit::CartesianState state;  ///< of the centre of mass at the tag
  Matrix3 R_eci_body = Matrix3::Identity();
  Vector3 antenna_body_m = Vector3::Zero();  ///< nominal phase centre, from the centre of mass
  double clock_m = 0.0;                      ///< c times the receiver clock's advance
};

/// Results of one epoch.
struct RelativeUpdate {
  std::int32_t codes_used = 0;
  std::int32_t codes_refused = 0;
  std::int32_t phases_used = 0;
  std::int32_t phases_refused = 0;
  std::int32_t slips = 0;
  std::int32_t contradictions = 0;  ///< held channels released although their receivers reported no loss of lock
  double code_nis = 0.0;            ///< sums over the observations used; each is expected to be near their number
  double phase_nis = 0.0;
};

class RelativeFilter {
 public:
  struct RelativeOrbit {
    static constexpr int kSize = 6;  ///< target minus servicer, position m and velocity m/s, ECI
  };
  struct EmpiricalAcceleration {
    static constexpr int kSize = 3;  ///< m/s^2, RTN, of the target over the servicer
  };
  struct ServicerAntenna {
    static constexpr int kSize = 3;  ///< offset from the nominal position, m, body
  };
  struct TargetAntenna {
    static constexpr int kSize = 3;
  };
  struct PhaseCentreJitter {
    static constexpr int kSize = 3;  ///< m, ECI, of the pair
  };
  struct ClockDifference {
    static constexpr int kSize = 1;  ///< m
  };
  struct CodeBiases {
    static constexpr int kSize = 3;  ///< m, of GPS L2, Galileo E1, BeiDou B1I over GPS L1
  };
  struct Ambiguities {
    static constexpr int kSize = static_cast<int>(kPhaseChannels);  ///< m, single differences
  };
  struct PhaseWander {
    static constexpr int kSize = static_cast<int>(kPhaseChannels);  ///< m, single differences; idle without wander
  };
  using State = estimation::Layout<RelativeOrbit, EmpiricalAcceleration, ServicerAntenna, TargetAntenna,
                                   PhaseCentreJitter, ClockDifference, CodeBiases, Ambiguities, PhaseWander>;
  using Estimate = estimation::Estimate<State::kSize>;

  explicit RelativeFilter(const RelativeFilterSettings& settings = {}) : settings_(settings) {}

  /// Resets all but the settings.
  void reset();

  /// Replaces the settings and resets all else.
  void configure(const RelativeFilterSettings& settings) {
    settings_ = settings;
    reset();
  }

  /// Initialises at `time` with a relative position (m, ECI) known to `sigma_m` per axis.
  void begin(GpsTime time, const Vector3& position_eci, double sigma_m, double mean_motion);

  [[nodiscard]] bool started() const { return started_; }
  [[nodiscard]] GpsTime epoch() const { return epoch_; }

  /// Propagates the estimate to `time`; `servicer` is its absolute state at the current epoch.
  void advance_to(GpsTime time, const orbit::CartesianState& servicer);

  /// A burn of the servicer at the epoch.
  void add_servicer_impulse(const Vector3& dv_eci);

  /// Processes the differences of an epoch; the filter must be at its time. `servicer` and `target`: platforms, the
  /// state of the target is not used.
  RelativeUpdate take(const DifferentialEpoch& epoch, const ReceiverPlatform& servicer, const ReceiverPlatform& target);

  /// The single differences of two channels of one signal differ by an integer number of cycles, held from now on.
  void hold(std::size_t place, std::size_t reference, double cycles);

  /// Releases all integers; the orbit keeps its covariance, inflated by `position_sigma_m` and the corresponding
  /// velocity: wrong integers may have shifted it by as much.
  void release(double position_sigma_m);

  [[nodiscard]] const Estimate& estimate() const { return estimate_; }
  [[nodiscard]] const PhaseChannels& channels() const { return channels_; }
  /// Index in the estimate of a channel's ambiguity.
  [[nodiscard]] static constexpr int ambiguity_index(std::size_t place) {
    return State::offset<Ambiguities>() + static_cast<int>(place);
  }
  /// Index in the estimate of a channel's wander.
  [[nodiscard]] static constexpr int wander_index(std::size_t place) {
    return State::offset<PhaseWander>() + static_cast<int>(place);
  }
  [[nodiscard]] Vector3 position_eci() const { return estimate_.mean().head<3>(); }
  [[nodiscard]] Vector3 velocity_eci() const { return estimate_.mean().segment<3>(3); }

 private:
  static constexpr int kHead = RelativeOrbit::kSize + EmpiricalAcceleration::kSize;  ///< sampled
  static constexpr int kGeometry = State::offset<Ambiguities>();                     ///< all but ambiguities
  using Geometry = Eigen::Matrix<double, kGeometry, 1>;

  /// Measurement model of an observation about the state before the first update of the epoch.
  struct Row {
    Geometry jacobian = Geometry::Zero();  ///< of the range difference, clock included, code bias not
    double predicted = 0.0;
    double extra_variance = 0.0;  ///< of the nonlinearity
    bool has_outlying_code = false;
    std::optional<std::size_t> channel;
  };

  Status linearise(const DifferentialEpoch& epoch, const ReceiverPlatform& servicer, const ReceiverPlatform& target);
  void renew_epoch_states(const ReceiverPlatform& servicer, const ReceiverPlatform& target);
  void find_outlying_codes(const DifferentialEpoch& epoch);
  void use_codes(const DifferentialEpoch& epoch, RelativeUpdate& update);
  void follow_channels(const DifferentialEpoch& epoch, RelativeUpdate& update);
  void find_slips_by_median(const DifferentialEpoch& epoch, RelativeUpdate& update);
  void use_phases(const DifferentialEpoch& epoch, RelativeUpdate& update);
  void begin_channel(std::size_t place, double value_m);
  void deactivate(std::size_t place);
  void advance_wander(double dt);
  void lose(std::size_t place);
  void contradict(std::size_t place, RelativeUpdate& update);
  [[nodiscard]] double residual(const Row& row, double measured) const;
  [[nodiscard]] double code_residual(const Row& row, const DifferentialObservation& observation) const;
  [[nodiscard]] Estimate::Vector code_jacobian(const Row& row, gnss::Signal signal) const;
  [[nodiscard]] double phase_residual(const Row& row, std::size_t place, double measured) const;
  [[nodiscard]] static Estimate::Vector full_jacobian(const Row& row);
  [[nodiscard]] Estimate::Vector phase_jacobian(const Row& row, std::size_t place) const;

  RelativeFilterSettings settings_;
  bool started_ = false;
  GpsTime epoch_;
  Estimate estimate_;
  PhaseChannels channels_;
  std::array<Row, gnss::kMaxObservations> rows_{};
  Geometry reference_ = Geometry::Zero();  ///< the linearisation point of the rows
};

}  // namespace vbar::fsw::navigation
