#include "fsw/guidance/drift_assessment.h"

#include <algorithm>

#include "fsw/fdir/safety_monitor.h"
#include "fsw/math/math.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::guidance {
namespace {

/// Longest outage as a multiple of the timeout of the safety monitor: an eclipse as long as the timeout, and the time
/// in sunlight that the monitor accepts beside it.
constexpr double kLongestOutage = 1.0 + fdir::SafetyMonitor::kLitShare;

}  // namespace

safety::RetreatSettings retreat_settings(const safety_configuration& configuration, double margin_m) {
  return {.contact_distance = configuration.contact_distance_m,
          .margin = margin_m,
          .horizon = configuration.horizon_s,
          .recession = configuration.recession_m,
          .a_da_error_m = configuration.semi_major_axis_error_m,
          .differential_drag = configuration.differential_drag};
}

Assessment assess_drift_now(const DriftSituation& situation, double unmeasured_s,
                            const safety_configuration& configuration, RetreatSequence& retreat) {
  Assessment assessment;
  const orbit::QnsElements& servicer = situation.orbits.servicer;
  const Vector6 roe = orbit::roe_from_qns(servicer, situation.orbits.target);
  safety::RetreatSettings settings = retreat_settings(configuration, situation.bound.radial_normal);
  settings.unmeasured = std::min(unmeasured_s, kLongestOutage * configuration.data_timeout_s);
  const auto passive = safety::assess_drift(servicer, roe, configuration.horizon_s, situation.bound);
  const auto at_once = safety::find_delayed_retreat(servicer, servicer.a * roe, 0.0, settings);
  const auto delayed =
      safety::find_delayed_retreat(servicer, servicer.a * roe, configuration.retreat_delay_s, settings);
  if (!passive.ok() || !at_once.ok() || !delayed.ok()) return assessment;
  const auto probability = safety::retreat_probability(at_once.value(), situation.covariance_m2, settings);
  if (!probability.ok()) return assessment;
  retreat.prepare(situation.orbits.epoch, at_once.value().burn);
  assessment.is_known = true;
  const double revolution_s = 2.0 * math::kPi / orbit::mean_motion(servicer.a);
  assessment.position_bound_m = math::hypot(
      situation.bound.radial_normal, situation.bound.along_track + situation.bound.along_track_rate * revolution_s);
  assessment.passive_distance = passive.value().spatial.distance;
  assessment.retreat_distance = delayed.value().burn.distance;
  assessment.collision_probability = probability.value().spatial;
  assessment.collision_probability_in_plane = probability.value().radial_normal;
  return assessment;
}

}  // namespace vbar::fsw::guidance
