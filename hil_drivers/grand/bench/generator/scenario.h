#pragma once
// Scenario file of the emulator: all parameters of generator and receivers that do not come over the wires.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "fsw/core/gps_time.h"
#include "hil_drivers/grand/bench/control/control_servers.h"
#include "hil_drivers/grand/bench/generator/fault.h"
#include "hil_drivers/grand/bench/generator/sky.h"
#include "hil_drivers/grand/bench/receiver/receiver_settings.h"
#include "hil_drivers/grand/generators/generator.h"
#include "host_sim/twins/gnss/constellation.h"

namespace vbar::grand::bench {

struct VehicleScenario {
  std::string name;
  std::size_t com_ports = 2;
  ReceiverSettings receiver;
};

struct Scenario {
  std::uint64_t seed = 1;
  Pace pace = Pace::kLockStep;
  double speed_factor = 1.0;                 ///< real time: generator time per time of the host's clock
  fsw::Duration engine_latency{40'000'000};  ///< real time: lag of the motion behind the edges
  fsw::Duration join{165'000'000};           ///< value until a command sets it
  fsw::Duration start_shift;                 ///< the radiated scenario's time minus the commanded one (a fault)
  double pps_jitter_ns = 0.0;                ///< one sigma of each edge
  twins::gnss::ConstellationSettings constellation;
  SkySettings sky;
  std::vector<VehicleScenario> vehicles;
  ControlSettings control;
  std::vector<Fault> faults;

  [[nodiscard]] std::vector<std::string> vehicle_names() const;
};

/// Reads the file with the assignments "path=value" in place of its values. Throws MissionError.
Scenario read_scenario(const std::filesystem::path& file, const std::vector<std::string>& assignments);

}  // namespace vbar::grand::bench
