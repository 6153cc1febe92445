#pragma once
// A flight computer that fails for a time: its packets are lost, and it takes no steps. Afterwards it continues, or
// it is re-initialised, with or without the snapshot of its last step.

#include <functional>
#include <memory>
#include <vector>

#include "host_sim/faults/fault_schedule.h"
#include "host_sim/faults/reported_orbit.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::faults {

class FaultyComputer final : public pil::FlightComputer {
 public:
  using Start = std::function<std::unique_ptr<pil::FlightComputer>()>;

  /// `computer` must outlive it. `start` makes another one in its place; `telecommands` are sent to that one before
  /// its first step, as the ground would when the computer asks for its configuration, with the relative orbit that
  /// its telemetry reported last.
  FaultyComputer(pil::FlightComputer& computer, std::shared_ptr<const FaultSchedule> schedule, Start start,
                 std::vector<pil::Packet> telecommands);

  pil::StepResult step(std::uint32_t step, std::span<const pil::Packet> packets) override;
  [[nodiscard]] pil::LinkStatistics statistics() const override { return present().statistics(); }
  [[nodiscard]] std::string description() const override { return present().description(); }
  void close() override { present().close(); }

 private:
  pil::StepResult step_of(pil::FlightComputer& computer, std::uint32_t step, std::span<const pil::Packet> packets);
  [[nodiscard]] pil::FlightComputer& present() const { return restarted_ ? *restarted_ : computer_; }

  pil::FlightComputer& computer_;
  std::shared_ptr<const FaultSchedule> schedule_;
  Start start_;
  std::vector<pil::Packet> telecommands_;
  ReportedOrbit reported_;
  std::unique_ptr<pil::FlightComputer> restarted_;
  bool must_restart_ = false;
  std::vector<std::uint8_t> snapshot_;  ///< snapshot of the step before a reboot that keeps the state
};

/// Whether the faults contain one of the flight computer.
[[nodiscard]] bool concern_computer(const std::vector<mission::Fault>& faults);

}  // namespace vbar::faults
