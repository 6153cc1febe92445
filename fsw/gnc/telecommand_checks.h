#pragma once
// Whether the values of a telecommand are within their valid ranges, of each kind by itself; and whether two valid
// telecommands agree with each other. A new telecommand needs its is_valid here: the store does not compile without it.

#include "fsw/gnc/camera_configuration.h"
#include "fsw/gnc/gnss_configuration.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw::gnc {

// Those of navigation and cameras stand with their conversion: gnss_configuration.h, camera_configuration.h.

/// One to sixteen waypoints in order of time, within the domain of the relative-orbit models.
[[nodiscard]] bool is_valid(const waypoint_table& table);
[[nodiscard]] bool is_valid(const gnc_configuration& configuration);
[[nodiscard]] bool is_valid(const mode_command& command);
/// A bound orbit with positive standard deviations.
[[nodiscard]] bool is_valid(const target_apriori& apriori);
/// Noise and bias of up to a kilometre.
[[nodiscard]] inline bool is_valid(const range_configuration& c) {
  return c.noise_sigma_m > 0.0 && c.noise_sigma_m <= 1e3 && c.bias_sigma_m >= 0.0 && c.bias_sigma_m <= 1e3;
}

}  // namespace vbar::fsw::gnc
