#pragma once
// navigate: the state of servicer and target at the time of the step, from the relative navigation filter at its own
// epoch and the servicer's own maneuvers since. Between measurements the state is propagated under J2.
//
// Late inputs are used: each step rebuilds the state from a reference state, that of the last measurement, and the
// maneuvers after it. A commanded maneuver is assumed executed as commanded until the actuator reports otherwise, so
// that neither a late nor a lost report causes guidance to repeat it.

#include <array>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/messaging/inbox.h"
#include "fsw/messaging/telecommands.h"
#include "fsw/navigation/measurement_scheduler.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::navigation {

enum class NavigationSource : std::int8_t {
  kNone = 0,
  kPropagated = 1,
  kIdeal = 2,
  kGnssFloat = 3,
  kGnssFixed = 4,
  kAnglesOnly = 5,
  kPose = 6,
};

/// Holds the navigation solution at `epoch`.
struct NavigationState {
  bool valid = false;       ///< sufficient for planning
  bool has_target = false;  ///< sufficient for pointing a camera
  NavigationSource source = NavigationSource::kNone;
  GpsTime epoch;
  GpsTime last_measurement;  ///< or of the formation that previous navigation handed over, if that is later
  orbit::CartesianState servicer;
  orbit::CartesianState target;
  /// 1 sigma of the relative position (m) and velocity (m/s) in the servicer's RTN.
  Vector6 sigma_rtn = Vector6::Zero();
};

class NavigationSolution {
 public:
  /// Configures and updates `measurements`, and propagates its estimate to `now`. Entries of the inbox tagged after
  /// `now` or before the reference state are counted as unusable.
  void update(GpsTime now, const messaging::Telecommands& telecommands, messaging::Inbox& inbox,
              MeasurementScheduler& measurements);

  /// Notes a commanded maneuver: `dv_rtn` (m/s) at `time`, which lies after the last update.
  void expect_maneuver(std::int32_t maneuver_id, GpsTime time, const Vector3& dv_rtn);

  [[nodiscard]] const NavigationState& state() const { return state_; }

  /// Returns whether a measurement source that uses a camera is selected: the camera is pointed before the telecommands
  /// of the source are complete.
  [[nodiscard]] bool uses_camera() const { return uses_camera_; }

  /// Returns 1 sigma of a * ROE (m, six components) at the state, for the estimate of `filter`.
  [[nodiscard]] Vector6 sigma_a_roe_m(const filter::RelativeNavigationFilter& filter) const;
  /// Returns the covariance of a * ROE (m^2) at the state, for the estimate of `filter`.
  [[nodiscard]] Matrix6 a_roe_covariance_m2(const filter::RelativeNavigationFilter& filter) const;

 private:
  /// Holds the states of both spacecraft at one instant, before any impulse of that instant.
  struct Pair {
    GpsTime epoch;
    orbit::CartesianState servicer;
    orbit::CartesianState target;
  };
  void configure(const messaging::Telecommands& telecommands);
  void adopt_estimate(const MeasurementScheduler& measurements);
  void set_reference(const Pair& estimated);
  void drop_state();
  [[nodiscard]] std::span<const filter::Burn> own_burns() const { return std::span(maneuvers_).first(maneuver_count_); }
  [[nodiscard]] filter::Burn burn_of(std::int32_t maneuver_id, GpsTime time, const Vector3& dv_rtn) const;
  [[nodiscard]] NavigationSource source_of(GpsTime now, const MeasurementScheduler& measurements) const;
  void set_uncertainty(GpsTime now, const filter::RelativeNavigationFilter& filter);
  void take_maneuvers(GpsTime now, messaging::Inbox& inbox);
  void take_report(GpsTime time, const executed_maneuver& report, messaging::Inbox& inbox);
  void move_reference(GpsTime time);
  [[nodiscard]] Result<Pair> flown_to(GpsTime time) const;
  [[nodiscard]] Result<orbit::CartesianState> coasted(const orbit::CartesianState& servicer, GpsTime from,
                                                      GpsTime to) const;
  void remember(const filter::Burn& maneuver);
  void discard(std::int64_t maneuver_id);
  void discard_before(GpsTime time);

  static constexpr std::size_t kMaxManeuvers = 64;  // twice the number that guidance may have commanded ahead

  NavigationState state_;
  bool has_reference_ = false;
  Pair reference_;
  std::array<filter::Burn, kMaxManeuvers> maneuvers_{};  ///< in order of time, none before the reference state
  std::size_t maneuver_count_ = 0;

  bool uses_camera_ = false;
  GpsTime handed_over_;               ///< by previous navigation, as a-priori ROE
  double thrust_acceleration_ = 0.0;  ///< m/s^2; 0: burns are impulses
};

}  // namespace vbar::fsw::navigation
