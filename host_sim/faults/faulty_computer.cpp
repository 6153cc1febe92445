#include "host_sim/faults/faulty_computer.h"

#include <algorithm>
#include <utility>

#include "fsw/packets/packet.h"

namespace vbar::faults {
namespace {

using mission::FaultKind;

bool is_of_computer(const mission::Fault& fault) {
  return fault.kind == FaultKind::kComputerSilent || fault.kind == FaultKind::kComputerReboot;
}

}  // namespace

bool concern_computer(const std::vector<mission::Fault>& faults) {
  return std::ranges::any_of(faults, is_of_computer);
}

FaultyComputer::FaultyComputer(pil::FlightComputer& computer, std::shared_ptr<const FaultSchedule> schedule,
                               Start start, std::vector<pil::Packet> telecommands)
    : computer_(computer),
      schedule_(std::move(schedule)),
      start_(std::move(start)),
      telecommands_(std::move(telecommands)) {}

pil::StepResult FaultyComputer::step(std::uint32_t step, std::span<const pil::Packet> packets) {
  const auto tick = packets.empty() ? fsw::Result<fsw::packets::PacketView>(fsw::Status::kNotReady)
                                    : fsw::packets::parse_packet(packets.back());
  if (tick.ok()) {
    for (const mission::Fault& fault : schedule_->faults()) {
      if (!is_of_computer(fault) || !fault.is_present(tick.value().header.time)) continue;
      const bool begins = fault.kind == FaultKind::kComputerReboot && !must_restart_;
      if (begins && fault.keeps_state) snapshot_ = present().snapshot();
      must_restart_ = must_restart_ || fault.kind == FaultKind::kComputerReboot;
      pil::StepResult off;
      off.has_flown = false;
      return off;
    }
  }
  if (!must_restart_) return step_of(present(), step, packets);
  must_restart_ = false;
  present().close();
  restarted_ = start_();
  if (!snapshot_.empty()) {
    restarted_->restore(snapshot_);
    snapshot_.clear();
    return step_of(*restarted_, step, packets);
  }
  std::vector<pil::Packet> first =
      tick.ok() ? reported_.applied_to(telecommands_, tick.value().header.time) : telecommands_;
  first.insert(first.end(), packets.begin(), packets.end());
  return step_of(*restarted_, step, first);
}

pil::StepResult FaultyComputer::step_of(pil::FlightComputer& computer, std::uint32_t step,
                                        std::span<const pil::Packet> packets) {
  pil::StepResult result = computer.step(step, packets);
  reported_.take(result.packets);
  return result;
}

}  // namespace vbar::faults
