#include "host_sim/simulation/flight_computer.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "fsw/link/frame.h"
#include "host_sim/io/child_process.h"
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
  options.telecommand_key_file = wanted.telecommand_key_file;
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

namespace {

constexpr int kBoardBaud = 921600;
constexpr double kBitsPerByte = 10.0;  // 8N1

int baud_of(const mission::FlightComputer& computer) {
  if (computer.target == mission::FlightTarget::kInProcess || computer.link != mission::FlightLink::kSerial) return 0;
  return computer.baud.value_or(computer.target == mission::FlightTarget::kBoard ? kBoardBaud : 0);
}

std::uint64_t bytes_of(const pil::LinkStatistics& link) {
  return link.bytes_sent + link.bytes_received;
}

}  // namespace

std::string slow_line(const mission::FlightComputer& computer, fsw::Duration step_period,
                      std::span<const pil::Packet> first_packets) {
  const int baud = baud_of(computer);
  if (baud == 0) return {};
  // The least that COBS adds is two bytes a frame.
  constexpr std::size_t kFrameBytes = fsw::link::kFrameHeaderBytes + fsw::link::kFrameCrcBytes + 2;
  std::size_t bytes = 0;
  for (const pil::Packet& packet : first_packets) bytes += packet.size() + kFrameBytes;
  const double line_s = static_cast<double>(bytes) * kBitsPerByte / baud, period_s = fsw::seconds(step_period);
  if (line_s <= period_s) return {};
  return fmt::format(
      "flight_computer.baud = {}: the {} bytes of the telecommands of the first step take {:.1f} s on the line, and a "
      "step "
      "lasts {:g} s; at least {:.0f} baud are needed",
      baud, bytes, line_s, period_s, std::ceil(static_cast<double>(bytes) * kBitsPerByte / period_s));
}

LineUsage::LineUsage(const mission::FlightComputer& computer, fsw::Duration step_period,
                     const pil::LinkStatistics& before)
    : baud_(baud_of(computer)), step_period_s_(fsw::seconds(step_period)), bytes_so_far_(bytes_of(before)) {}

void LineUsage::after_step(const pil::LinkStatistics& link) {
  const std::uint64_t bytes = bytes_of(link);
  const std::uint64_t of_step = bytes - bytes_so_far_;
  bytes_so_far_ = bytes;
  bytes_ += of_step;
  bytes_of_step_max_ = std::max(bytes_of_step_max_, of_step);
  ++steps_;
}

void LineUsage::summarise(report::Summary::Link& summary) const {
  summary.baud = baud_;
  if (baud_ == 0 || steps_ == 0) return;
  const double share_of_byte = kBitsPerByte / baud_ / step_period_s_;
  summary.step_share_max = static_cast<double>(bytes_of_step_max_) * share_of_byte;
  summary.step_share_mean = static_cast<double>(bytes_) / static_cast<double>(steps_) * share_of_byte;
}

}  // namespace vbar::app
