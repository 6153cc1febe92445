#include "host_sim/sensors/sensor_kind.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "host_sim/sensors/installed_testbeds.h"

namespace vbar::sensors {

std::unique_ptr<twins::PacketSource> packets_of_testbed(const mission::Sensor& sensor, const SensorKind& kind,
                                                        const MakeContext& context, const mission::Spacecraft& carrier,
                                                        std::vector<fsw::packets::Apid> allowed, std::uint8_t unit,
                                                        PacketLimits limits) {
  const testbeds::TestbedKind* const testbed = testbeds::find_testbed(sensor.settings->source);
  if (testbed == nullptr) return nullptr;
  if (context.outlook == nullptr)
    throw std::runtime_error(fmt::format("source {}: \"{}\" is a testbed, which is part of a run only",
                                         source_name(carrier, sensor), sensor.settings->source));
  const auto run = context.testbeds.run_of(*testbed, {context.mission, context.data_directory, *context.outlook});
  return run->make_packets({.name = source_name(carrier, sensor),
                            .allowed = std::move(allowed),
                            .spacecraft = context.servicer.number,
                            .unit = unit,
                            .truth_is_compared = kind.compares_measurements,
                            .packets_max = limits.packets_max,
                            .fault_of_value = std::move(limits.fault_of_value)});
}

std::unique_ptr<twins::PacketSource> only_packets_of_testbed(const mission::Sensor& sensor, const SensorKind& kind,
                                                             const MakeContext& context, fsw::packets::Apid allowed,
                                                             FaultOfValue fault_of_value) {
  constexpr std::size_t kPacketsMax = 64;  // one is nominal
  auto packets = packets_of_testbed(sensor, kind, context, context.servicer, {allowed},
                                    unit_of(sensor, context.servicer), {kPacketsMax, std::move(fault_of_value)});
  if (!packets && testbeds::find_testbed(sensor.settings->source) != nullptr)
    throw std::runtime_error(
        fmt::format("testbed \"{}\" has no sensor of kind {}", sensor.settings->source, sensor.kind));
  return packets;
}

}  // namespace vbar::sensors
