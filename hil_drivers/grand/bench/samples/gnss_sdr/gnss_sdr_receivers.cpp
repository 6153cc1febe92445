#include "hil_drivers/grand/bench/samples/gnss_sdr/gnss_sdr_receivers.h"

#include <stdexcept>
#include <utility>

#include "hil_drivers/grand/bench/generator/oem628_end.h"
#include "hil_drivers/grand/bench/samples/gnss_sdr/gnss_sdr_measurements.h"

namespace vbar::grand::bench {

ReceiverFactory gnss_sdr_receivers(const Scenario& scenario, const std::filesystem::path& directory) {
  if (scenario.pace != Pace::kRealTime)
    throw std::invalid_argument("gnss-sdr receives in real time only: pace is lock_step; accepted is real_time");
  return [vehicles = scenario.vehicles, seed = scenario.seed, directory](
             std::size_t index, std::shared_ptr<const twins::gnss::Constellation> constellation) {
    const VehicleScenario& vehicle = vehicles[index];
    GnssSdrSettings settings;
    settings.directory = directory / (vehicle.name + ".gnss_sdr");
    auto measurements = std::make_unique<GnssSdrMeasurements>(settings, constellation, seed, vehicle.name);
    return receiver_end(Receiver(vehicle.receiver, constellation, seed, vehicle.name, std::move(measurements)));
  };
}

}  // namespace vbar::grand::bench
