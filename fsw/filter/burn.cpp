#include "fsw/filter/burn.h"

#include "fsw/math/math.h"

namespace vbar::fsw::filter {

double BurnErrors::of(const Vector3& dv) const {
  return sigma + sigma_relative * math::sqrt(dv.squaredNorm());
}

Thrust thrust_from(std::span<const Burn> burns, GpsTime time, const BurnErrors& errors) {
  Thrust thrust;
  for (const Burn& burn : burns) {
    if (!burn.lasts() || burn.begin() > time || burn.end() <= time) continue;
    const double duration_s = seconds(burn.duration);
    const double error = errors.of(burn.dv_rtn);
    thrust.acceleration_rtn += burn.dv_rtn / duration_s;
    thrust.psd += error * error / duration_s;
    thrust.is_on = true;
  }
  return thrust;
}

GpsTime next_edge(std::span<const Burn> burns, GpsTime time, GpsTime until) {
  GpsTime next = until;
  for (const Burn& burn : burns) {
    if (!burn.lasts()) continue;
    for (const GpsTime edge : {burn.begin(), burn.end()}) {
      if (edge > time && edge < next) next = edge;
    }
  }
  return next;
}

Burn as_reported(const Burn& commanded, const Burn& reported, GpsTime epoch) {
  Burn rest = reported;
  if (!rest.lasts() || epoch <= rest.begin() || epoch >= rest.end()) return rest;
  const double flown = seconds(epoch - rest.begin()) / seconds(rest.duration);
  rest.dv_rtn = (reported.dv_rtn - flown * commanded.dv_rtn) / (1.0 - flown);
  return rest;
}

}  // namespace vbar::fsw::filter
