#pragma once
// What the guard is given in a step: images, attitude, epochs of both receivers and burns, straight from the packets.
// Nothing of navigation but the range that it states.

#include "fsw/faults/fault_monitor.h"
#include "fsw/gnc/inbox.h"
#include "fsw/gnc/telecommands.h"
#include "fsw/guard/guard.h"
#include "fsw/orbit/earth_rotation.h"
#include "fsw/sources/gnss/gnss_front_end.h"

namespace vbar::fsw::gnc {

/// Distance of the antennas by the pseudoranges of the newest epoch that both receivers have.
struct CodeBaseline {
  GpsTime time;
  double range_m = 0.0;
};
/// No value without such an epoch, or where either receiver has no single-point solution in it.
std::optional<CodeBaseline> code_baseline(const sources::GnssFrontEnd& gnss, const orbit::EarthOrientation& earth);

/// Whether the single-point solution of an epoch is outside the shadow of the Earth; status: that of single_point().
Result<bool> is_sunlit(const gnss::ObservationEpoch& epoch, const navigation::EphemerisStore& ephemerides,
                       const orbit::EarthOrientation& earth);

/// Gives the packets of the step to the guard. `attitude`: the last one received, replaced by those of the step.
void feed_guard(guard::Guard& guard, const Inbox& inbox, const Telecommands& telecommands,
                std::optional<vbar::attitude>& attitude, double navigation_range_m);

/// Gives the single-point solutions of the newest epochs to the guard: the code baseline, and the own sunlight.
void feed_guard_codes(guard::Guard& guard, const sources::GnssFrontEnd& gnss, const orbit::EarthOrientation& earth,
                      double navigation_range_m);

/// Checks its verdicts as faults.
void check_verdicts(const guard::GuardVerdicts& verdicts, GpsTime now, faults::FaultMonitor& faults);

}  // namespace vbar::fsw::gnc
