#pragma once
// Subject of a fault: packets, and measurement sources of navigation.

#include <cstdint>
#include <optional>
#include <utility>

#include "fsw/packets/messages.h"
#include "host_sim/mission/mission.h"

namespace vbar::faults {

/// Kind and header unit of packets.
using StreamKey = std::pair<fsw::packets::Apid, std::uint8_t>;

/// The packets of the sensor concerned; empty if there is none.
[[nodiscard]] std::optional<StreamKey> stream_of(const mission::Mission& mission, const mission::Fault& fault);

/// The sources of navigation that a fault concerns: a sum of navigation_configuration::kUse.
[[nodiscard]] std::int32_t aids_concerned(const mission::Mission& mission, const mission::Fault& fault);

}  // namespace vbar::faults
