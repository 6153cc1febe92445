#pragma once
// Inputs of the safety monitor in a step: images, attitude and burns from the packets; single-point solutions of both
// receivers, from the epochs and ephemerides that navigation decodes as well; and the range that navigation states.

#include "fsw/faults/fault_monitor.h"
#include "fsw/fdir/safety_monitor.h"
#include "fsw/gnss/gnss_front_end.h"
#include "fsw/messaging/inbox.h"
#include "fsw/messaging/telecommands.h"
#include "fsw/orbit/earth_rotation.h"

namespace vbar::fsw::fdir {

/// Holds the distance of the antennas by the pseudoranges of the newest epoch that both receivers have.
struct CodeBaseline {
  GpsTime time;
  double range_m = 0.0;
};
/// Returns the code baseline; nothing without a common epoch, or if either receiver has no single-point solution in it.
std::optional<CodeBaseline> code_baseline(const gnss::GnssFrontEnd& gnss, const orbit::EarthOrientation& earth);

/// Returns whether the single-point solution of an epoch is outside the shadow of the Earth. Errors of single_point().
Result<bool> is_sunlit(const gnss::ObservationEpoch& epoch, const gnss::EphemerisStore& ephemerides,
                       const orbit::EarthOrientation& earth);

/// Passes the packets of the step to the safety monitor. `attitude` is the last one received; those of the step replace
/// it.
void update_safety_monitor(fdir::SafetyMonitor& guard, const messaging::Inbox& inbox,
                           const messaging::Telecommands& telecommands, std::optional<vbar::attitude>& attitude,
                           double navigation_range_m);

/// Passes the single-point solutions of the newest epochs to the safety monitor: the code baseline, and whether the
/// servicer is in sunlight.
void update_safety_monitor_by_codes(fdir::SafetyMonitor& guard, const gnss::GnssFrontEnd& gnss,
                                    const orbit::EarthOrientation& earth, double navigation_range_m);

/// Passes the verdicts of the safety monitor to the fault monitor.
void check_verdicts(const fdir::SafetyMonitorVerdicts& verdicts, GpsTime now, faults::FaultMonitor& faults);

}  // namespace vbar::fsw::fdir
