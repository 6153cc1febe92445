#pragma once
// Packets of a sensor that a testbed provides whole.

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fsw/packets/packet.h"
#include "host_sim/sensors/sensor_kind.h"

namespace vbar::sensors {

/// Returns why a packet of an allowed message cannot be a measurement of the sensor; empty if it can.
using FaultOfValue = std::function<std::string(const fsw::packets::PacketView&)>;

/// Limits of one epoch: packets beyond are rejected.
struct PacketLimits {
  std::size_t packets_max = 65535;
  FaultOfValue fault_of_value = {};
};

/// Makes the source of a sensor's packets about `carrier`, if a testbed provides whole packets: a sensor in another
/// process. Null for any other source. `kind`: that of the sensor. Throws std::runtime_error if the testbed cannot, and
/// without a run.
[[nodiscard]] std::unique_ptr<twins::PacketSource> packets_of_testbed(const mission::Sensor& sensor,
                                                                      const SensorKind& kind,
                                                                      const MakeContext& context,
                                                                      const mission::Spacecraft& carrier,
                                                                      std::vector<fsw::packets::Apid> allowed,
                                                                      std::uint8_t unit, PacketLimits limits = {});

/// Returns such a source for a kind of sensor that testbeds provide in no other form: throws std::runtime_error for
/// another source of a testbed.
[[nodiscard]] std::unique_ptr<twins::PacketSource> only_packets_of_testbed(const mission::Sensor& sensor,
                                                                           const SensorKind& kind,
                                                                           const MakeContext& context,
                                                                           fsw::packets::Apid allowed,
                                                                           FaultOfValue fault_of_value = {});

}  // namespace vbar::sensors
