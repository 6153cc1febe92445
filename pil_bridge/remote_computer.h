#pragma once
// The host's side of a receiver that is wired to the flight computer: waits until the flight computer has what the
// receiver sent, and takes the bytes that the flight software was given out of the answer.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "host_sim/io/child_process.h"
#include "host_sim/io/serial_line.h"
#include "pil_bridge/flight_computer.h"
#include "pil_bridge/step_barrier.h"
#include "pil_bridge/transport.h"

namespace vbar::pil {

class WiredBytes {
 public:
  /// Is made when the flight computer has answered its hello: counts begin there.
  WiredBytes(io::WiredReceiver receiver, std::chrono::milliseconds limit);

  /// Asks for the number of bytes that have arrived at the flight computer; nothing if there is no answer by a
  /// deadline.
  using AskCount = std::function<std::optional<std::uint64_t>(Clock::time_point deadline)>;

  /// Returns, in lock-step, when everything the receiver has sent has arrived, or when nothing more has arrived within
  /// the limit. What has not arrived by then is missing: it is counted once and not waited for again.
  void wait(const AskCount& ask);

  /// Returns the gnss_bytes that the flight software was given, if `packet` is a wired_bytes. Throws LinkError if its
  /// content is invalid.
  std::optional<Packet> take(const Packet& packet);

  [[nodiscard]] const WiredStatistics& statistics() const { return statistics_; }

 private:
  /// Bytes sent and not arrived, negative if more have arrived; 0 if the receiver does not count.
  [[nodiscard]] std::int64_t difference() const;

  io::WiredReceiver receiver_;
  io::TerminalQueue under_way_;
  std::chrono::milliseconds limit_;
  std::uint64_t sent_before_ = 0;
  std::uint64_t arrived_ = 0;  ///< as last reported by the flight computer
  std::int64_t missing_ = 0;   ///< sent and arrived differ by this number after the last wait
  WiredStatistics statistics_;
};

// A flight computer at the other end of a link: a board, an emulated one, or a process of its own.

struct RemoteParts {
  std::string name;                           ///< "zynq_qemu over serial", for messages
  std::string role = "flight computer";       ///< before the name in messages
  std::unique_ptr<io::ChildProcess> process;  ///< the process of the flight computer, if this program started it
  std::unique_ptr<FrameTransport> transport;
  BarrierTiming timing;
  std::uint8_t spacecraft = 0;
  /// Description of the emulator; without it the board's timer ticks cannot be converted to instructions.
  std::optional<int> icount_shift;
  std::uint64_t step_budget = 0;  ///< in instructions with `icount_shift`, else in cycles; 0: that of the board
  std::optional<io::WiredReceiver> receiver = std::nullopt;  ///< receiver that is wired to the flight computer
  double line_bits_per_s = 0.0;  ///< rate of a serial line, 10 bits a byte; 0: as fast as it goes
};

/// Returns the time of an exchange that the flight computer spent computing, s. `waited_s`: from the last packet handed
/// to the line to the first of the answer. A line of a known rate buffers what it is handed: there it is what the
/// `bytes` of the exchange leave of it.
[[nodiscard]] double computing_time(double exchange_s, double waited_s, std::uint64_t bytes, double line_bits_per_s);

class RemoteComputer final : public FlightComputer {
 public:
  /// Waits until the flight computer has booted and answers. Throws FlightComputerError.
  explicit RemoteComputer(RemoteParts parts);
  ~RemoteComputer() override = default;

  StepResult step(std::uint32_t step, std::span<const Packet> packets) override;
  [[nodiscard]] std::vector<std::uint8_t> snapshot() override;
  void restore(std::span<const std::uint8_t> snapshot) override;
  [[nodiscard]] LinkStatistics statistics() const override;
  [[nodiscard]] std::string description() const override { return parts_.name + ": " + board_name_; }
  void close() override;

  /// Returns the number of the process that runs the flight computer, -1 if there is none. For tests that end it.
  [[nodiscard]] int process_id() const { return parts_.process ? parts_.process->pid() : -1; }

 private:
  /// Ends the process and throws FlightComputerError with all known information on the cause.
  [[noreturn]] void fail(const std::string& when, const std::string& cause);
  void check_process() const;
  /// The budget of a step in the unit in which the board counts.
  [[nodiscard]] std::uint64_t board_budget() const;
  [[nodiscard]] const char* count_unit() const { return parts_.icount_shift ? "instructions" : "cycles"; }
  /// Bytes in both directions so far.
  [[nodiscard]] std::uint64_t line_bytes() const;
  /// "; the 12345 bytes of the exchange so far take 103 s at 1200 baud" of a line of a known rate.
  [[nodiscard]] std::string line_text(std::uint64_t bytes) const;
  /// Takes everything out of the answer that is not from the flight software.
  void sort_answer(StepResult& result);
  /// Throws LinkError if the step took more than the budget, after which the board takes no further step.
  void check_budget(const StepReport& report) const;
  /// Keeps the counters of a packet that is a step report, fills `report`, and returns true.
  bool take_step_report(const Packet& packet, StepReport& report);

  RemoteParts parts_;
  StepBarrier barrier_;
  std::optional<WiredBytes> wired_;
  std::string board_name_;
  std::string failure_;  ///< why this computer can no longer be used; empty while it can
  bool closed_ = false;
  LinkStatistics board_counters_;      ///< the board's counters, from its last step report
  std::uint32_t packets_dropped_ = 0;  ///< also from its last step report
};

}  // namespace vbar::pil
