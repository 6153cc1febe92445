#pragma once
// Makes the flight computer that a mission describes, started and answering.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "host_sim/io/serial_line.h"
#include "host_sim/mission/mission.h"
#include "host_sim/report/run_record.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::app {

/// The first spacecraft of the mission that has a flight computer. Throws std::runtime_error if none has.
const mission::Spacecraft& flying_spacecraft(const mission::Mission& mission);

/// The library or image that it flies; empty if the flight software is in this program, on a board, or not found.
std::string flight_software_file(const mission::Spacecraft& spacecraft);

/// `receiver`: that is wired to it, if there is one. Throws pil::FlightComputerError.
std::unique_ptr<pil::FlightComputer> connect_flight_computer(
    const mission::Spacecraft& spacecraft, const std::optional<io::WiredReceiver>& receiver = std::nullopt);

// Time that the bytes of each step take on the serial line to the flight computer: both directions one after the other,
// as the answer follows the last packet of the step.

/// Returns one sentence that names the rate of a serial line, if it cannot carry the packets of the first step, which
/// are known before the flight, within its period; empty for any other line.
[[nodiscard]] std::string slow_line(const mission::FlightComputer& computer, fsw::Duration step_period,
                                    std::span<const pil::Packet> first_packets);

class LineUsage {
 public:
  /// `before`: counts of the link before the first step. Nothing is reported for a flight computer without a serial
  /// line, or with one that is as fast as it goes.
  LineUsage(const mission::FlightComputer& computer, fsw::Duration step_period, const pil::LinkStatistics& before);

  /// `link`: as it stands after the step.
  void after_step(const pil::LinkStatistics& link);

  /// Rate and shares, into the run's summary.
  void summarise(report::Summary::Link& summary) const;

 private:
  int baud_ = 0;
  double step_period_s_ = 0.0;
  std::uint64_t bytes_so_far_ = 0;
  std::uint64_t steps_ = 0;
  std::uint64_t bytes_ = 0;
  std::uint64_t bytes_of_step_max_ = 0;
};

}  // namespace vbar::app
