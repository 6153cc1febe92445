#pragma once
// A flight computer as seen by a simulation, on any target: packets of a step in, packets of the
// step out. This is the only exchange between the two.

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace vbar::pil {

/// The bytes of one space packet (fsw/packets/packet.h).
using Packet = std::vector<std::uint8_t>;

/// The flight computer can no longer be used; the message states the reason to the user.
class FlightComputerError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Cost of a step, measured by the flight computer.
struct StepReport {
  bool present = false;           ///< the computer sent a report
  std::string unit = "none";      ///< "none", "instructions" (emulator) or "cycles" (silicon)
  std::uint64_t count = 0;        ///< in `unit`
  std::uint32_t stack_bytes = 0;  ///< high-water mark since start-up; 0 if not measured
};

/// Counts of a receiver that is wired to the flight computer, since it was started.
struct WiredStatistics {
  std::uint64_t bytes = 0;     ///< given to the flight software
  std::uint64_t dropped = 0;   ///< by the flight computer, because its buffer was full
  std::uint64_t timeouts = 0;  ///< steps that began before all bytes that were sent had arrived
  std::uint64_t missing = 0;   ///< bytes that were sent and had not arrived by these timeouts
};

/// Since the flight computer was started, both directions and both ends of the link.
struct LinkStatistics {
  std::uint64_t bytes_sent = 0;         ///< by the host, as encoded on the wire
  std::uint64_t bytes_received = 0;     ///< by the host
  std::uint64_t frames_resent = 0;      ///< data frames sent more than once
  std::uint64_t frames_rejected = 0;    ///< corrupted, out of order, or of another session
  std::uint64_t frames_duplicated = 0;  ///< valid, but received before
  std::uint64_t strangers_ignored = 0;  ///< datagrams from an address other than that of the flight computer
  std::uint64_t polls = 0;              ///< number of polls for an overdue answer
  WiredStatistics wired = {};
};

/// Statuses that the flight software's functions returned in a step, and outputs that are not in the answer.
struct StepTrouble {
  std::int32_t status = 0;  ///< status of the step (vbar_status); unknown, 0, behind a link
  /// Packets whose reception returned a status other than 0; unknown, 0, behind a link.
  std::uint32_t inputs_refused = 0;
  std::uint32_t packets_dropped = 0;  ///< that it sent, not of a packet's size or more than an answer holds
};

struct StepResult {
  std::vector<Packet> packets;  ///< from the flight software, in its order; the step report is not among them
  /// Inputs that the flight computer received on a line of its own and gave to the flight software before the tick.
  std::vector<Packet> wired = {};
  StepReport report;
  /// Wall-clock time that the flight software took of the exchange: the rest is that of the link.
  double compute_wall_s = 0.0;
  StepTrouble trouble = {};
  bool has_flown = true;  ///< false: the flight computer was off, and nothing was given to it
};

class FlightComputer {
 public:
  FlightComputer() = default;
  FlightComputer(const FlightComputer&) = delete;
  FlightComputer& operator=(const FlightComputer&) = delete;
  virtual ~FlightComputer() = default;

  /// Sends the packets of `step`, the last of them the tick, and returns when the answer is complete. Steps are
  /// numbered upwards from any start. Throws FlightComputerError.
  virtual StepResult step(std::uint32_t step, std::span<const Packet> packets) = 0;

  /// Returns the state that the flight software retains through a reboot, as of the last step (vbar_gnc_save). Empty if
  /// this target or its flight software does not provide it.
  /// Throws FlightComputerError.
  [[nodiscard]] virtual std::vector<std::uint8_t> snapshot() { return {}; }

  /// Continues from a snapshot, before the first step (vbar_gnc_restore). Throws FlightComputerError if it is refused.
  virtual void restore(std::span<const std::uint8_t> /*snapshot*/) {
    throw FlightComputerError(description() + " cannot continue from a snapshot");
  }

  [[nodiscard]] virtual LinkStatistics statistics() const = 0;

  /// Target and name of the flight software, for reports.
  [[nodiscard]] virtual std::string description() const = 0;

  /// Terminates the flight software in an orderly way. The destructor does so too, with a shorter time limit.
  virtual void close() = 0;
};

}  // namespace vbar::pil
