#pragma once

#include <memory>
#include <vector>

#include "fsw/packets/packet.h"
#include "host_sim/sensors/sensor_kind.h"

namespace vbar::sensors {

/// The source of a sensor's packets about `carrier`, if a testbed provides whole packets: a sensor in another process.
/// Null for any other source. Throws std::runtime_error
/// if the testbed cannot, and without a run.
[[nodiscard]] std::unique_ptr<twins::PacketSource> packets_of_testbed(const mission::Sensor& sensor,
                                                                      const MakeContext& context,
                                                                      const mission::Spacecraft& carrier,
                                                                      std::vector<fsw::packets::Apid> allowed,
                                                                      std::uint8_t unit);

/// The same for a kind of sensor that no testbed provides otherwise: throws std::runtime_error for such a source.
[[nodiscard]] std::unique_ptr<twins::PacketSource> only_packets_of_testbed(const mission::Sensor& sensor,
                                                                           const MakeContext& context,
                                                                           fsw::packets::Apid allowed);

}  // namespace vbar::sensors
