#include "fsw/sources/own_gnss/own_gnss_aiding.h"

namespace vbar::fsw::sources {

Result<navigation::SinglePoint> OwnGnssAiding::process(const gnss::ObservationEpoch& epoch,
                                                       const std::optional<Matrix3>& R_eci_body,
                                                       const navigation::EphemerisStore& ephemerides,
                                                       const navigation::EarthFrame& frame,
                                                       filter::RelativeNavigationFilter& filter) {
  const GpsTime tag = epoch.receiver_time;
  if (tag != filter.epoch()) return Status::kNotReady;
  if (!aid_.is_on()) aid_.go_to(AidState::kWaiting, tag);
  watch(tag);
  const Result<navigation::SinglePoint> point = navigation::single_point(epoch, ephemerides, frame);
  if (!point.ok()) {
    ++counters_.no_solution;
    return point;
  }
  filter::AbsolutePosition position;
  position.position_eci = point.value().position_eci;
  position.covariance_m2 = point.value().covariance_m2;
  if (R_eci_body) {
    position.position_eci -= *R_eci_body * antenna_body_m_;
  } else {
    position.covariance_m2 += antenna_body_m_.squaredNorm() / 3.0 * Matrix3::Identity();
  }
  // The position is that at the instant of reception, the tag that of the receiver clock.
  position.early_s = point.value().clock_m / gnss::kSpeedOfLight;
  const bool was_started = filter.absolute_orbit().started();
  const bool is_accepted = filter.update_absolute_orbit(position);
  if (was_started) aid_.consistency().add(filter.absolute_orbit().nis(), 3);
  if (!is_accepted) {
    ++counters_.rejected;
    if (!filter.absolute_orbit().started()) aid_.go_to(AidState::kFailed, tag);
    return point;
  }
  ++counters_.used;
  last_accepted_ = tag;
  aid_.go_to(filter.absolute_orbit().started() ? AidState::kAiding : AidState::kStarting, tag);
  return point;
}

void OwnGnssAiding::watch(GpsTime now) {
  if (aid_.state() == AidState::kAiding && now - last_accepted_ > kSilence) aid_.go_to(AidState::kSuspended, now);
}

}  // namespace vbar::fsw::sources
