#pragma once
// A flight computer as a simulation sees it, wherever the flight software runs: packets of a step in, packets of the
// step out. Nothing else passes between the two.

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace vbar::pil {

/// The bytes of one space packet (fsw/packets/packet.h).
using Packet = std::vector<std::uint8_t>;

/// The flight computer can no longer be used; the message is one a user can act on.
class FlightComputerError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a step cost on the flight computer, as far as that computer can tell.
struct StepReport {
  bool present = false;           ///< the computer sent a report
  std::string unit = "none";      ///< "none", "instructions" (emulator) or "cycles" (silicon)
  std::uint64_t count = 0;        ///< in `unit`
  std::uint32_t stack_bytes = 0;  ///< high-water mark since start-up; 0 if not measured
};

/// Since the flight computer was started, both directions and both ends of the link.
struct LinkStatistics {
  std::uint64_t bytes_sent = 0;         ///< by the host, as they go over the wire (coded)
  std::uint64_t bytes_received = 0;     ///< by the host
  std::uint64_t frames_resent = 0;      ///< data frames sent more than once
  std::uint64_t frames_rejected = 0;    ///< broken, out of order, or of another session
  std::uint64_t frames_duplicated = 0;  ///< good, but already there
  std::uint64_t strangers_ignored = 0;  ///< datagrams from an address that is not the flight computer's
  std::uint64_t polls = 0;              ///< times the host had to ask for an overdue answer
};

struct StepResult {
  std::vector<Packet> packets;  ///< from the flight software, in its order; the step report is not among them
  StepReport report;
  double compute_wall_s = 0.0;  ///< wall-clock time of the whole exchange, link included
};

class FlightComputer {
 public:
  FlightComputer() = default;
  FlightComputer(const FlightComputer&) = delete;
  FlightComputer& operator=(const FlightComputer&) = delete;
  virtual ~FlightComputer() = default;

  /// Hands over the packets of `step`, the last of them the tick, and returns when the answer is complete. Steps are
  /// numbered upwards from any start. Throws FlightComputerError.
  virtual StepResult step(std::uint32_t step, std::span<const Packet> packets) = 0;

  [[nodiscard]] virtual LinkStatistics statistics() const = 0;

  /// Where the flight software runs and what it calls itself, for reports.
  [[nodiscard]] virtual std::string description() const = 0;

  /// Ends the flight software in an orderly way. Also done, less patiently, by the destructor.
  virtual void close() = 0;
};

}  // namespace vbar::pil
