#pragma once
// The relative navigation filter estimates the target's orbit and attitude with respect to the servicer from all
// sensors, beside the servicer's absolute orbit, at one epoch.
//
// State: x = [ROE (-), accelerations (m/s^2) | attitude error (rad), rate (rad/s), inertia ratios (-) | blocks of
// sources] (components and units of all: state.h)
//
// Propagation: x <- f(x), P <- A P A' + Q, with A and Q of the head by sigma points (unscented.h: Julier, Uhlmann
// 2004): both orbits in gravity of degree 20 (relative_orbit.h), the attitude as a rigid body (target_attitude.h:
// USQUE, Crassidis and Markley 2003).
//
// Update: x <- x + P H' (H P H' + R)^-1 z, decorrelated by the Cholesky factor of R
// (fsw/estimation/measurement_batch.h).
//
// Measurement sources (fsw/sources) turn records of their sensors into batches. The filter does not depend on which
// sensor they came from: the blocks of the sources are a list, whose members carry their own process models. Activating
// or deactivating a block changes no other block. No source re-initialises the absolute orbit.

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/filter/absolute_orbit.h"
#include "fsw/filter/apriori.h"
#include "fsw/filter/burn.h"
#include "fsw/filter/propagation.h"
#include "fsw/filter/relative_orbit.h"
#include "fsw/filter/state.h"
#include "fsw/filter/target_attitude.h"
#include "fsw/orbit/earth_rotation.h"

namespace vbar::fsw::filter {

/// Holds 1-sigma values of the initial states and of unmodelled effects.
struct FilterSettings {
  orbit::EarthOrientation earth;
  double burn_sigma = 2e-6;           ///< m/s, per axis of a burn
  double burn_sigma_relative = 1e-3;  ///< share of the size of a burn
  [[nodiscard]] BurnErrors burn_errors() const { return {burn_sigma, burn_sigma_relative}; }
  AbsoluteOrbitSettings absolute_orbit;
  RelativeOrbitSettings relative_orbit;
  TargetAttitudeSettings attitude;
  estimation::BlockSettings<MeasurementBlocks> processes;  ///< settings of the blocks of measurement sources
};

/// States how the relative orbit is known.
enum class SolutionStatus : std::uint8_t {
  kNone,
  kApriori,       ///< from the a-priori orbit alone: sufficient to point a camera, not to plan
  kInconsistent,  ///< estimated, but contradicted by measurements: a source has to initialise it again
  kEstimated,     ///< from measurements, or a-priori ROE of preceding navigation
};

/// Identifies a measurement source.
struct MeasurementSource {
  std::int32_t bit = 0;         ///< navigation_configuration::kUse...
  bool confirms_orbit = false;  ///< its updates determine the relative orbit, which other sources then leave unchanged

  /// Index of the bit.
  [[nodiscard]] constexpr std::size_t place() const {
    std::size_t place = 0;
    while (place < 31 && bit >> place != 1) ++place;
    return place;
  }
};

/// A burn of the servicer as applied, or the part of it between two measurements as an impulse at its middle.
struct Impulse {
  GpsTime time;
  Vector3 dv_eci = Vector3::Zero();  ///< m/s
  Vector3 dv_rtn = Vector3::Zero();  ///< the same, in the servicer's RTN before it
};

class RelativeNavigationFilter {
 public:
  /// Replaces the settings. Estimates stay; a block that is active keeps its present value and variance.
  void configure(const FilterSettings& settings);
  [[nodiscard]] const FilterSettings& settings() const { return settings_; }

  /// Sets a new a-priori orbit of the target, which is used while nothing better is known.
  void set_apriori(const TargetApriori& apriori);

  /// Propagates both estimates to `time`, not before the epoch, including the burns of the servicer (in order of time)
  /// from the epoch until then: a measurement at the time of an impulse precedes it. Burns that last act on what of
  /// their interval is left.
  void advance_to(GpsTime time, std::span<const filter::Burn> burns);
  [[nodiscard]] GpsTime epoch() const { return epoch_; }
  /// The last propagation of the relative estimate, of at most one segment: for its verification.
  [[nodiscard]] const HeadMotion& last_motion() const { return motion_; }
  /// The latest burns until the epoch, in order of time, at most kMaxImpulses.
  [[nodiscard]] std::span<const Impulse> impulses() const { return std::span(impulses_).first(impulse_count_); }
  static constexpr std::size_t kMaxImpulses = 32;

  /// Processes a single-point position at the epoch; returns false if it was rejected.
  bool update_absolute_orbit(const AbsolutePosition& position);
  [[nodiscard]] const AbsoluteOrbitFilter& absolute_orbit() const { return absolute_orbit_; }
  [[nodiscard]] orbit::CartesianState servicer() const { return absolute_orbit_.state(); }
  /// Initialises both estimates with negligible covariance: both states at the epoch are known (ideal navigation).
  void set_states(const orbit::CartesianState& servicer, const orbit::CartesianState& target);

  /// Initialises the relative orbit (dimensionless ROE); all blocks but the attitude's keep their state.
  void initialize_relative(const Vector6& roe, const Matrix6& covariance, SolutionStatus solution_status);
  /// Marks the present estimate as insufficient to plan, after contradicting measurements.
  void mark_inconsistent() {
    if (solution_status_ == SolutionStatus::kEstimated) solution_status_ = SolutionStatus::kInconsistent;
  }
  [[nodiscard]] SolutionStatus solution_status() const {
    return absolute_orbit_.started() ? solution_status_ : SolutionStatus::kNone;
  }
  [[nodiscard]] bool has_relative() const { return solution_status() != SolutionStatus::kNone; }
  /// Returns the target's state; kNotReady without a relative orbit.
  [[nodiscard]] Result<orbit::CartesianState> target() const;

  [[nodiscard]] Vector6 roe() const { return estimate_.mean().head<6>(); }
  [[nodiscard]] Matrix6 roe_covariance() const { return estimate_.head_covariance<6>(); }
  /// Osculating a * ROE, m, and its covariance, m^2; a: the servicer's. Zero without a relative orbit.
  [[nodiscard]] Vector6 a_roe_m() const;
  [[nodiscard]] Matrix6 a_roe_covariance_m2() const;
  /// Covariance of the target's position from the servicer, ECI axes, m^2; zero if there is none.
  [[nodiscard]] Matrix3 position_covariance_eci() const;

  /// Initialises attitude and rate of the target (TargetAttitude::initialize), and the blocks that are initialised with
  /// them.
  void initialize_attitude(const filter::AttitudeState& attitude, const Matrix6& covariance);
  /// Deactivates the attitude and the blocks that follow it; the orbit stays.
  void deactivate_attitude();
  [[nodiscard]] bool has_attitude() const { return TargetAttitude::is_known(estimate_); }
  [[nodiscard]] TargetAttitude& attitude() { return attitude_; }
  [[nodiscard]] const TargetAttitude& attitude() const { return attitude_; }

  [[nodiscard]] RelativeOrbit& relative_orbit() { return relative_orbit_; }
  [[nodiscard]] const RelativeOrbit& relative_orbit() const { return relative_orbit_; }
  [[nodiscard]] Estimate& estimate() { return estimate_; }
  [[nodiscard]] const Estimate& estimate() const { return estimate_; }

  /// Lends the workspace of the filter for one batch, large and therefore not on the stack: to be filled and handed to
  /// update().
  [[nodiscard]] MeasurementBatch& workspace() { return workspace_; }
  /// Updates the relative estimate by the measurements in use (estimation::update), and confirms the orbit if the
  /// source does. False, with nothing changed, if the noise is not positive definite; otherwise `batch` then holds the
  /// residuals after the update.
  bool update(const MeasurementSource& source, MeasurementBatch& batch);
  /// Moves the attitude error into its reference and checks the estimate: due after every change of estimate() by other
  /// means than update().
  void finish_update();

  /// Records that the source has updated the relative orbit at the epoch, by other means than update().
  void confirm_relative(const MeasurementSource& source) { confirmed_[source.place()] = epoch_; }
  /// Whether a source other than this one has updated the relative orbit within kConfirmation of the epoch. Then the
  /// orbit is not changed because measurements of this one contradict it.
  [[nodiscard]] bool is_confirmed_by_others(const MeasurementSource& source) const;
  /// Whether a source that determines the relative orbit far better than any image updates it at present: the
  /// innovations of a camera are then the errors of that camera.
  [[nodiscard]] bool is_precisely_determined() const;
  /// What the source of a block adapts of its process, from now on and whatever the settings.
  template <class Block>
  [[nodiscard]] typename Block::Adaptation& adaptation() {
    return adaptations_.of<Block>();
  }
  static constexpr std::size_t kMaxSources = 8;
  static constexpr Duration kConfirmation = duration_of_seconds(900);

  /// Inflates the relative orbit after contradicting measurements, as after an unknown burn of `velocity_sigma`, m/s,
  /// with a sigma of the distance along track, m.
  void inflate_relative(double velocity_sigma, double along_track_sigma_m);
  /// Inflates the relative orbit as after a burn of `velocity_sigma`, m/s per axis, at an unknown time since `since`:
  /// an estimate that measurements have confirmed then can have become wrong in this way only. At most an orbit back.
  void inflate_by_burn(GpsTime since, double velocity_sigma);
  /// Multiplies the covariance of the relative orbit by `factor`, the mean normalised square by which the innovations
  /// of a source are larger than its covariances state.
  void scale_relative_covariance(double factor);
  /// Inflates the servicer's absolute orbit, as inflate_relative() does the relative one.
  void inflate_absolute_orbit(double velocity_sigma);

  /// Number of times that the relative estimate had to be discarded because it was not a covariance any more.
  [[nodiscard]] int failures() const { return failures_; }

 private:
  void coast_to(GpsTime time, std::span<const filter::Burn> burns);
  void advance_relative(const OrbitStep& step);
  void add_impulse(const Vector3& dv_rtn);
  void note_thrust(const OrbitStep& step);
  void note_impulse(const Impulse& impulse);
  void refer_to_apriori();
  void keep_relative_state(const orbit::CartesianState& servicer_before, const orbit::CartesianState& target_before);
  void fail_relative();

  FilterSettings settings_;
  GpsTime epoch_;
  AbsoluteOrbitFilter absolute_orbit_;
  std::optional<Apriori> apriori_;
  SolutionStatus solution_status_ = SolutionStatus::kNone;
  RelativeOrbit relative_orbit_;
  TargetAttitude attitude_;
  Estimate estimate_;
  estimation::BlockAdaptations<MeasurementBlocks> adaptations_;
  int failures_ = 0;
  std::array<Impulse, kMaxImpulses> impulses_{};
  std::size_t impulse_count_ = 0;
  std::array<std::optional<GpsTime>, kMaxSources> confirmed_{};
  HeadMotion motion_;
  MeasurementBatch workspace_;
};

}  // namespace vbar::fsw::filter
