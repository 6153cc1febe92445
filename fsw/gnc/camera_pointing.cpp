#include "fsw/gnc/camera_pointing.h"

#include "fsw/orbit/propagate.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::gnc {
namespace {

/// The state of `epoch` at `time`, not before it.
Result<orbit::CartesianState> flown(orbit::CartesianState state, GpsTime epoch, GpsTime time,
                                    std::span<const navigation::Burn> burns) {
  for (const navigation::Burn& burn : burns) {
    if (burn.time < epoch || burn.time >= time) continue;
    const Result<orbit::CartesianState> coasted = orbit::propagate_j2(state, seconds(burn.time - epoch));
    if (!coasted.ok()) return coasted.status();
    state = orbit::apply_impulse_rtn(coasted.value(), burn.dv_rtn);
    epoch = burn.time;
  }
  return orbit::propagate_j2(state, seconds(time - epoch));
}

}  // namespace

std::optional<orbit::CartesianState> servicer_at(GpsTime time, const navigation::GnssNavigation& own_orbit,
                                                 std::span<const navigation::Burn> burns) {
  if (!own_orbit.has_servicer() || own_orbit.epoch() > time) return std::nullopt;
  const auto servicer = flown(own_orbit.servicer(), own_orbit.epoch(), time, burns);
  if (!servicer.ok()) return std::nullopt;
  return servicer.value();
}

}  // namespace vbar::fsw::gnc
