#pragma once
// Inputs of the safety monitor in a step: images, attitude and burns from the packets; single-point solutions of both
// receivers, from the epochs and ephemerides that navigation decodes as well; and the range that navigation states.

#include "fsw/faults/fault_monitor.h"
#include "fsw/gnc/inbox.h"
#include "fsw/gnc/telecommands.h"
#include "fsw/guard/guard.h"
#include "fsw/orbit/earth_rotation.h"
#include "fsw/sources/gnss/gnss_front_end.h"

namespace vbar::fsw::gnc {

/// Holds the distance of the antennas by the pseudoranges of the newest epoch that both receivers have.
struct CodeBaseline {
  GpsTime time;
  double range_m = 0.0;
};
/// Returns the code baseline; nothing without a common epoch, or if either receiver has no single-point solution in it.
std::optional<CodeBaseline> code_baseline(const sources::GnssFrontEnd& gnss, const orbit::EarthOrientation& earth);

/// Returns whether the single-point solution of an epoch is outside the shadow of the Earth. Errors of single_point().
Result<bool> is_sunlit(const gnss::ObservationEpoch& epoch, const navigation::EphemerisStore& ephemerides,
                       const orbit::EarthOrientation& earth);

/// Passes the packets of the step to the safety monitor. `attitude` is the last one received; those of the step replace
/// it.
void feed_guard(guard::Guard& guard, const Inbox& inbox, const Telecommands& telecommands,
                std::optional<vbar::attitude>& attitude, double navigation_range_m);

/// Passes the single-point solutions of the newest epochs to the safety monitor: the code baseline, and whether the
/// servicer is in sunlight.
void feed_guard_codes(guard::Guard& guard, const sources::GnssFrontEnd& gnss, const orbit::EarthOrientation& earth,
                      double navigation_range_m);

/// Passes the verdicts of the safety monitor to the fault monitor.
void check_verdicts(const guard::GuardVerdicts& verdicts, GpsTime now, faults::FaultMonitor& faults);

}  // namespace vbar::fsw::gnc
