#pragma once
// The relative navigation filter: the servicer's own orbit and one relative estimate for all sensors, at one epoch.
//
// Sources (fsw/sources) turn records of their sensors into batches of measurements; the filter propagates, is updated
// by batches, and does not depend on which sensor they came from: the blocks of the sources are a list, whose members
// carry their own process models. Activating or deactivating a block changes no other block; no source re-initialises
// the own orbit.

#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/navigation/burn.h"
#include "fsw/orbit/earth_rotation.h"
#include "fsw/trunk/apriori.h"
#include "fsw/trunk/own_orbit.h"
#include "fsw/trunk/relative_orbit.h"
#include "fsw/trunk/state.h"
#include "fsw/trunk/target_attitude.h"

namespace vbar::fsw::filter {

/// 1-sigma values of the initial states and of unmodelled effects.
struct FilterSettings {
  orbit::EarthOrientation earth;
  double burn_sigma = 2e-6;           ///< m/s, per axis of a burn
  double burn_sigma_relative = 1e-3;  ///< of its size
  AbsoluteOrbitSettings absolute_orbit;
  RelativeOrbitSettings relative_orbit;
  TargetAttitudeSettings attitude;
  estimation::BlockSettings<MeasurementBlocks> processes;  ///< of the blocks of measurement sources
};

/// How the relative orbit is known.
enum class SolutionStatus : std::uint8_t {
  kNone,
  kApriori,       ///< from the a-priori orbit alone: sufficient to point a camera, not to plan
  kInconsistent,  ///< estimated, but contradicted by measurements: a source has to initialise it again
  kEstimated,     ///< from measurements, or a-priori ROE of preceding navigation
};

/// A measurement source as the filter distinguishes it.
struct MeasurementSource {
  std::int32_t bit = 0;         ///< navigation_configuration::kUse...
  bool confirms_orbit = false;  ///< its updates determine the relative orbit, which other sources then leave unchanged

  [[nodiscard]] constexpr std::size_t place() const {
    return static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(bit)));
  }
};

/// A burn of the servicer as applied.
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

  /// A new a-priori orbit of the target. It is used while nothing better is known.
  void set_apriori(const TargetApriori& apriori);

  /// Propagates both estimates to `time`, not before the epoch, including the burns of the servicer (in order of time)
  /// from the epoch until then: a measurement at the time of a burn precedes it.
  void advance_to(GpsTime time, std::span<const navigation::Burn> burns);
  [[nodiscard]] GpsTime epoch() const { return epoch_; }
  /// The last propagation of the relative estimate, of at most one segment: for its verification.
  [[nodiscard]] const HeadMotion& last_motion() const { return motion_; }
  /// The latest burns until the epoch, in order of time, at most kMaxImpulses.
  [[nodiscard]] std::span<const Impulse> impulses() const { return std::span(impulses_).first(impulse_count_); }
  static constexpr std::size_t kMaxImpulses = 32;

  /// A single-point position at the epoch; false if it was rejected.
  bool update_absolute_orbit(const AbsolutePosition& position);
  [[nodiscard]] const AbsoluteOrbitFilter& absolute_orbit() const { return absolute_orbit_; }
  [[nodiscard]] orbit::CartesianState servicer() const { return absolute_orbit_.state(); }
  /// Both states at the epoch are known (ideal navigation): initialises both estimates with negligible covariance.
  void set_states(const orbit::CartesianState& servicer, const orbit::CartesianState& target);

  /// Initialises the relative orbit (dimensionless ROE); all blocks but the attitude's keep their state.
  void initialize_relative(const Vector6& roe, const Matrix6& covariance, SolutionStatus solution_status);
  /// Contradicting measurements: the present estimate no longer suffices to plan.
  void mark_inconsistent() {
    if (solution_status_ == SolutionStatus::kEstimated) solution_status_ = SolutionStatus::kInconsistent;
  }
  [[nodiscard]] SolutionStatus solution_status() const {
    return absolute_orbit_.started() ? solution_status_ : SolutionStatus::kNone;
  }
  [[nodiscard]] bool has_relative() const { return solution_status() != SolutionStatus::kNone; }
  /// kNotReady without a relative orbit.
  [[nodiscard]] Result<orbit::CartesianState> target() const;

  [[nodiscard]] Vector6 roe() const { return estimate_.mean().head<6>(); }
  [[nodiscard]] Matrix6 roe_covariance() const { return estimate_.head_covariance<6>(); }
  /// Osculating a * ROE, m, and its covariance, m^2; a: the servicer's. Zero without a relative orbit.
  [[nodiscard]] Vector6 a_roe_m() const;
  [[nodiscard]] Matrix6 a_roe_covariance_m2() const;
  /// Covariance of the target's position from the servicer, ECI axes, m^2; zero if there is none.
  [[nodiscard]] Matrix3 position_covariance_eci() const;

  /// Attitude and rate of the target (TargetAttitude::initialize); the errors of keypoints are re-initialised.
  void initialize_attitude(const navigation::AttitudeState& attitude, const Matrix6& covariance);
  /// Deactivates the attitude, the errors of keypoints and the origin of the keypoints; the orbit stays.
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

  /// After contradicting measurements: as after an unknown burn of `velocity_sigma`, m/s, with a sigma of the distance
  /// along track, m.
  void inflate_relative(double velocity_sigma, double along_track_sigma_m);
  /// The innovations of a source are larger than its covariances state, by this mean normalised square: the covariance
  /// of the relative orbit is multiplied by it.
  void scale_relative_covariance(double factor);
  /// The same of the servicer's own orbit as inflate_relative().
  void inflate_absolute_orbit(double velocity_sigma);

  /// Times that the relative estimate had to be discarded because it was not a covariance any more.
  [[nodiscard]] int failures() const { return failures_; }

 private:
  void coast_to(GpsTime time);
  void advance_relative(const OrbitStep& step);
  void add_impulse(const Vector3& dv_rtn);
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
