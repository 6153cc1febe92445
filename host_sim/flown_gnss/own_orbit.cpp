#include "host_sim/flown_gnss/own_orbit.h"

namespace vbar::flown_gnss {

OwnOrbit::OwnOrbit(const fsw::filter::AbsoluteOrbitSettings& settings, const fsw::gnss::RangeErrors& range_errors,
                   const fsw::orbit::EarthOrientation& earth, const fsw::Vector3& antenna_body_m)
    : filter_(std::make_unique<fsw::filter::RelativeNavigationFilter>()) {
  fsw::filter::FilterSettings filter;
  filter.earth = earth;
  filter.absolute_orbit = settings;
  filter_->configure(filter);
  aiding_.set_antenna(antenna_body_m);
  aiding_.set_range_errors(range_errors);
}

void OwnOrbit::process(std::span<const std::uint8_t> bytes, const fsw::Matrix3& R_eci_body,
                       const std::function<void(const OwnOrbitEpoch&, const fsw::gnss::ObservationEpoch&)>& on_epoch) {
  for (const std::uint8_t byte : bytes) {
    switch (decoder_.push(byte)) {
      case fsw::gnss::ReceiverUpdate::kEphemeris:
        static_cast<void>(ephemerides_.put(decoder_.ephemeris()));
        break;
      case fsw::gnss::ReceiverUpdate::kObservations: {
        const fsw::gnss::ObservationEpoch& epoch = decoder_.observations();
        const auto frame = fsw::gnss::EarthFrame::at(epoch.receiver_time, filter_->settings().earth);
        filter_->advance_to(epoch.receiver_time, {});
        const auto point = aiding_.process(epoch, R_eci_body, ephemerides_, frame, *filter_);
        const fsw::filter::AbsoluteOrbitFilter& orbit = filter_->absolute_orbit();
        on_epoch({epoch.receiver_time, point, orbit.started(), orbit.state(), orbit.covariance(), orbit.nis()}, epoch);
        break;
      }
      case fsw::gnss::ReceiverUpdate::kNone:
      case fsw::gnss::ReceiverUpdate::kIonosphere:
      case fsw::gnss::ReceiverUpdate::kClock:
      case fsw::gnss::ReceiverUpdate::kPosition:
        break;
    }
  }
}

}  // namespace vbar::flown_gnss
