#include "fsw/navigation/receiver_watch.h"

namespace vbar::fsw::navigation {
namespace {

// Factor by which the interval between steps exceeds the last one in a gap, in which packets were lost.
constexpr double kGap = 1.5;

}  // namespace

double ReceiverWatch::silent_s(GpsTime newest, GpsTime now) const {
  return seconds(now - (listens_since_ && *listens_since_ > newest ? *listens_since_ : newest));
}

void ReceiverWatch::update(GpsTime now, const gnss::GnssFrontEnd& gnss, bool uses_crosslink,
                           faults::FaultMonitor& faults) {
  if (last_step_) {
    const bool has_gap = step_interval_.ns > 0 && seconds(now - *last_step_) > kGap * seconds(step_interval_);
    if (has_gap) listens_since_ = now;
    step_interval_ = now - *last_step_;
  }
  last_step_ = now;
  const auto& own = gnss.heard(gnss::Receiver::kServicer);
  if (own && own->interval.ns > 0) {
    const double silent = silent_s(own->newest, now);
    faults.check(now, {.fault = telemetry_health::kFaultReceiverSilent,
                       .is_detected = silent > kMissingEpochs * seconds(own->interval),
                       .device = navigation_configuration::kUseOwnGnss,
                       .argument = silent});
  }
  const auto& crosslink = gnss.heard(gnss::Receiver::kTarget);
  if (crosslink && uses_crosslink) {
    const double silent = silent_s(crosslink->newest, now);
    faults.check(now, {.fault = telemetry_health::kFaultCrosslinkSilent,
                       .is_detected = silent > seconds(kLongestCrosslink),
                       .device = navigation_configuration::kUseCarrierPair,
                       .argument = silent});
  }
}

}  // namespace vbar::fsw::navigation
