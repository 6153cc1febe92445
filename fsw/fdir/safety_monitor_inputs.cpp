#include "fsw/fdir/safety_monitor_inputs.h"

#include "fsw/filter/propagation.h"
#include "fsw/gnss/single_point.h"
#include "fsw/math/math.h"
#include "fsw/messaging/message_fields.h"
#include "fsw/orbit/sun.h"

namespace vbar::fsw::fdir {
namespace {

/// Largest share by which the exposure of a resolved target differs from the commanded one: rounding.
constexpr double kSameExposure = 0.1;

bool is_for_resolved_target(const imaging::ImageAssembly& image, const pose_configuration& keypoints) {
  const double exposure_s = image.exposure_s();
  return exposure_s == 0.0 || math::abs(exposure_s - keypoints.exposure_s) < kSameExposure * keypoints.exposure_s;
}

fdir::SafetyMonitorCamera safety_monitor_camera(const camera_configuration& camera) {
  return {
      .focal_length_px = camera.focal_length_px[0], .dark_level_dn = camera.dark_level_dn, .noise_dn = camera.noise_dn};
}

}  // namespace

std::optional<CodeBaseline> code_baseline(const gnss::GnssFrontEnd& gnss, const orbit::EarthOrientation& earth) {
  const gnss::EpochBuffer& theirs = gnss.waiting(gnss::Receiver::kTarget);
  for (std::size_t k = theirs.size(); k-- > 0;) {  // in order of time
    const GpsTime tag = theirs[k].receiver_time;
    const gnss::ObservationEpoch* ours = gnss.waiting(gnss::Receiver::kServicer).find(tag);
    if (ours == nullptr) continue;
    const auto frame = gnss::EarthFrame::at(tag, earth);
    const auto their_point = gnss::single_point(theirs[k], gnss.ephemerides(), frame);
    const auto our_point = gnss::single_point(*ours, gnss.ephemerides(), frame);
    if (!their_point.ok() || !our_point.ok()) return std::nullopt;
    const Vector3 apart = their_point.value().position_eci - our_point.value().position_eci;
    return CodeBaseline{.time = tag, .range_m = math::sqrt(apart.squaredNorm())};
  }
  return std::nullopt;
}

Result<bool> is_sunlit(const gnss::ObservationEpoch& epoch, const gnss::EphemerisStore& ephemerides,
                       const orbit::EarthOrientation& earth) {
  const GpsTime tag = epoch.receiver_time;
  const auto point = gnss::single_point(epoch, ephemerides, gnss::EarthFrame::at(tag, earth));
  if (!point.ok()) return point.status();
  return filter::is_sunlit(point.value().position_eci, orbit::sun_position_gcrf(tag).normalized());
}

void update_safety_monitor(fdir::SafetyMonitor& guard, const messaging::Inbox& inbox,
                           const messaging::Telecommands& telecommands, std::optional<vbar::attitude>& attitude,
                           double navigation_range_m) {
  const auto& attitudes = inbox.queue<vbar::attitude>();
  for (std::size_t k = 0; k < attitudes.size(); ++k) {
    if (messaging::is_rotation(attitudes[k].value.q_eci_body)) attitude = attitudes[k].value;
  }
  for (std::size_t unit = 0; attitude && unit < packets::kCameras; ++unit) {
    const imaging::ImageAssembly& image = inbox.image(unit);
    const auto* camera = telecommands.in_force<camera_configuration>(unit);
    const auto* keypoints = telecommands.in_force<pose_configuration>(unit);
    if (!image.has_image() || camera == nullptr || keypoints == nullptr) continue;
    if (!is_for_resolved_target(image, *keypoints)) continue;
    const Matrix3 R_eci_camera =
        messaging::rotation(attitude->q_eci_body) * messaging::rotation(camera->q_camera_body).transpose();
    const fdir::Illumination illumination{.line_of_sight = R_eci_camera.col(2),
                                          .to_sun = orbit::sun_position_gcrf(image.image_time()).normalized()};
    guard.take_image(image.image_time(), image.view(), safety_monitor_camera(*camera), illumination,
                     navigation_range_m);
  }
  const auto& reports = inbox.queue<executed_maneuver>();
  for (std::size_t k = 0; k < reports.size(); ++k) {
    const executed_maneuver& report = reports[k].value;
    if (report.accepted != 0 && report.maneuver_id >= 0)
      guard.take_report(report.maneuver_id, messaging::vector(report.dv_rtn));
  }
}

void update_safety_monitor_by_codes(fdir::SafetyMonitor& guard, const gnss::GnssFrontEnd& gnss,
                                    const orbit::EarthOrientation& earth, double navigation_range_m) {
  if (const auto codes = code_baseline(gnss, earth)) {
    guard.take_code_baseline(codes->time, codes->range_m, navigation_range_m);
  }
  const gnss::EpochBuffer& own = gnss.waiting(gnss::Receiver::kServicer);
  if (own.size() == 0) return;
  const gnss::ObservationEpoch& newest = own[own.size() - 1];
  const auto sunlit = is_sunlit(newest, gnss.ephemerides(), earth);
  if (sunlit.ok()) guard.take_sunlight(newest.receiver_time, sunlit.value());
}

void check_verdicts(const fdir::SafetyMonitorVerdicts& verdicts, GpsTime now, faults::FaultMonitor& faults) {
  const auto check = [&](std::int32_t fault, const fdir::Verdict& verdict) {
    if (!verdict.is_checked) return;
    faults.check(now, {.fault = fault, .is_detected = verdict.is_alarm, .argument = verdict.value});
  };
  check(telemetry_health::kFaultGuardRange, verdicts.range);
  check(telemetry_health::kFaultGuardSilence, verdicts.silence);
  check(telemetry_health::kFaultGuardBurns, verdicts.burns);
  check(telemetry_health::kFaultGuardClosing, verdicts.closing);
}

}  // namespace vbar::fsw::fdir
