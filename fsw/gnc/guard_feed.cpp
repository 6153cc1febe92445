#include "fsw/gnc/guard_feed.h"

#include "fsw/gnc/message_fields.h"
#include "fsw/math/math.h"
#include "fsw/navigation/propagation.h"
#include "fsw/navigation/single_point.h"
#include "fsw/orbit/sun.h"

namespace vbar::fsw::gnc {
namespace {

/// Largest share by which the exposure of a resolved target differs from the commanded one: rounding.
constexpr double kSameExposure = 0.1;

bool is_for_resolved_target(const imaging::ImageAssembly& image, const pose_configuration& keypoints) {
  const double exposure_s = image.exposure_s();
  return exposure_s == 0.0 || math::abs(exposure_s - keypoints.exposure_s) < kSameExposure * keypoints.exposure_s;
}

guard::GuardCamera guard_camera(const camera_configuration& camera) {
  return {
      .focal_length_px = camera.focal_length_px[0], .dark_level_dn = camera.dark_level_dn, .noise_dn = camera.noise_dn};
}

}  // namespace

std::optional<CodeBaseline> code_baseline(const sources::GnssFrontEnd& gnss, const orbit::EarthOrientation& earth) {
  const navigation::EpochBuffer& theirs = gnss.waiting(sources::Receiver::kTarget);
  for (std::size_t k = theirs.size(); k-- > 0;) {  // in order of time
    const GpsTime tag = theirs[k].receiver_time;
    const gnss::ObservationEpoch* ours = gnss.waiting(sources::Receiver::kServicer).find(tag);
    if (ours == nullptr) continue;
    const auto frame = navigation::EarthFrame::at(tag, earth);
    const auto their_point = navigation::single_point(theirs[k], gnss.ephemerides(), frame);
    const auto our_point = navigation::single_point(*ours, gnss.ephemerides(), frame);
    if (!their_point.ok() || !our_point.ok()) return std::nullopt;
    const Vector3 apart = their_point.value().position_eci - our_point.value().position_eci;
    return CodeBaseline{.time = tag, .range_m = math::sqrt(apart.squaredNorm())};
  }
  return std::nullopt;
}

Result<bool> is_sunlit(const gnss::ObservationEpoch& epoch, const navigation::EphemerisStore& ephemerides,
                       const orbit::EarthOrientation& earth) {
  const GpsTime tag = epoch.receiver_time;
  const auto point = navigation::single_point(epoch, ephemerides, navigation::EarthFrame::at(tag, earth));
  if (!point.ok()) return point.status();
  return navigation::is_sunlit(point.value().position_eci, orbit::sun_position_gcrf(tag).normalized());
}

void feed_guard(guard::Guard& guard, const Inbox& inbox, const Telecommands& telecommands,
                std::optional<vbar::attitude>& attitude, double navigation_range_m) {
  const auto& attitudes = inbox.queue<vbar::attitude>();
  for (std::size_t k = 0; k < attitudes.size(); ++k) {
    if (is_rotation(attitudes[k].value.q_eci_body)) attitude = attitudes[k].value;
  }
  for (std::size_t unit = 0; attitude && unit < packets::kCameras; ++unit) {
    const imaging::ImageAssembly& image = inbox.image(unit);
    const auto* camera = telecommands.in_force<camera_configuration>(unit);
    const auto* keypoints = telecommands.in_force<pose_configuration>(unit);
    if (!image.has_image() || camera == nullptr || keypoints == nullptr) continue;
    if (!is_for_resolved_target(image, *keypoints)) continue;
    const Matrix3 R_eci_camera = rotation(attitude->q_eci_body) * rotation(camera->q_camera_body).transpose();
    const guard::Illumination illumination{.line_of_sight = R_eci_camera.col(2),
                                           .to_sun = orbit::sun_position_gcrf(image.image_time()).normalized()};
    guard.take_image(image.image_time(), image.view(), guard_camera(*camera), illumination, navigation_range_m);
  }
  const auto& reports = inbox.queue<executed_maneuver>();
  for (std::size_t k = 0; k < reports.size(); ++k) {
    const executed_maneuver& report = reports[k].value;
    if (report.accepted != 0 && report.maneuver_id >= 0) guard.take_report(report.maneuver_id, vector(report.dv_rtn));
  }
}

void feed_guard_codes(guard::Guard& guard, const sources::GnssFrontEnd& gnss, const orbit::EarthOrientation& earth,
                      double navigation_range_m) {
  if (const auto codes = code_baseline(gnss, earth)) {
    guard.take_code_baseline(codes->time, codes->range_m, navigation_range_m);
  }
  const navigation::EpochBuffer& own = gnss.waiting(sources::Receiver::kServicer);
  if (own.size() == 0) return;
  const gnss::ObservationEpoch& newest = own[own.size() - 1];
  const auto sunlit = is_sunlit(newest, gnss.ephemerides(), earth);
  if (sunlit.ok()) guard.take_sunlight(newest.receiver_time, sunlit.value());
}

void check_verdicts(const guard::GuardVerdicts& verdicts, GpsTime now, faults::FaultMonitor& faults) {
  const auto check = [&](std::int32_t fault, const guard::Verdict& verdict) {
    if (!verdict.is_checked) return;
    faults.check(now, {.fault = fault, .is_detected = verdict.is_alarm, .argument = verdict.value});
  };
  check(telemetry_health::kFaultGuardRange, verdicts.range);
  check(telemetry_health::kFaultGuardSilence, verdicts.silence);
  check(telemetry_health::kFaultGuardBurns, verdicts.burns);
  check(telemetry_health::kFaultGuardClosing, verdicts.closing);
}

}  // namespace vbar::fsw::gnc
