#include "host_sim/app/connect_flight_computer.h"

#include <algorithm>
#include <stdexcept>

#include "host_sim/io/process_limits.h"
#include "pil_bridge/make_flight_computer.h"

namespace vbar::app {

const mission::Spacecraft& flying_spacecraft(const mission::Mission& mission) {
  const auto flying =
      std::ranges::find_if(mission.spacecraft, [](const auto& s) { return s.flight_computer.has_value(); });
  if (flying == mission.spacecraft.end())
    throw std::runtime_error(
        "no spacecraft of the mission has a flight computer (vbar propagate flies a mission without)");
  return *flying;
}

namespace {

pil::FlightComputerOptions options_for(const mission::Spacecraft& spacecraft) {
  const mission::FlightComputer& wanted = *spacecraft.flight_computer;
  pil::FlightComputerOptions options;
  options.target = pil::target_from_name(mission::name_of(wanted.target));
  options.link = pil::link_from_name(mission::name_of(wanted.link));
  options.spacecraft = spacecraft.number;
  options.library = wanted.library;
  options.step_budget = static_cast<std::uint64_t>(wanted.step_budget);
  options.image = wanted.image;
  options.memory_bytes = io::kDefaultMemoryBytes;
  if (wanted.library.empty()) options.article = pil::linked_test_article();
  if (wanted.target == mission::FlightTarget::kBoard) {
    const bool serial = wanted.link == mission::FlightLink::kSerial;
    options.endpoint = serial ? wanted.device : wanted.address + ":" + std::to_string(wanted.port);
    if (wanted.baud) options.baud = static_cast<unsigned>(*wanted.baud);
  } else if (wanted.baud) {
    options.paced_bits_per_s = *wanted.baud;
  }
  return options;
}

}  // namespace

std::string flight_software_file(const mission::Spacecraft& spacecraft) {
  try {
    return pil::software_file(options_for(spacecraft));
  } catch (const pil::FlightComputerError&) {
    return {};  // connect_flight_computer says so
  }
}

std::unique_ptr<pil::FlightComputer> connect_flight_computer(const mission::Spacecraft& spacecraft,
                                                             const std::optional<io::WiredReceiver>& receiver) {
  pil::FlightComputerOptions options = options_for(spacecraft);
  options.receiver = receiver;
  return pil::make_flight_computer(options);
}

}  // namespace vbar::app
