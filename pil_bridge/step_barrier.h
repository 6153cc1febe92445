#pragma once
// The host's side of the step barrier (fsw/link/frame.h): go-back-N both ways, with polls for overdue answers. Whatever
// the line loses, corrupts, repeats or delays, `exchange` returns the flight computer's one answer to the step, or
// throws.

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fsw/link/batch.h"
#include "fsw/link/frame.h"
#include "pil_bridge/flight_computer.h"
#include "pil_bridge/transport.h"

namespace vbar::pil {

struct BarrierTiming {
  /// Silence after which the host polls; doubled up to `poll_limit` without progress. Well above the time of a step:
  /// a poll that arrives during the step would be included in the cost that the flight computer measures.
  std::chrono::milliseconds poll_after{500};
  std::chrono::milliseconds poll_limit{4000};
  /// Time limit without any progress.
  std::chrono::milliseconds give_up_after{30000};
  std::chrono::milliseconds hello_period{100};
  /// Longest wait for the first answer to a hello.
  std::chrono::milliseconds boot_limit{30000};
  /// Longest time without another byte of a receiver that is wired to the flight computer, while a step waits for its
  /// bytes.
  std::chrono::milliseconds wired_limit{2000};
};

struct BarrierCounters {
  std::uint64_t frames_resent = 0;
  std::uint64_t frames_rejected = 0;
  std::uint64_t frames_duplicated = 0;
  std::uint64_t polls = 0;
};

/// The board answers, but no longer flies this session: a reset has ended it.
class SessionLost : public LinkError {
 public:
  using LinkError::LinkError;
};

class StepBarrier {
 public:
  /// `watch` is called periodically during a wait; it may throw to end it.
  StepBarrier(FrameTransport& transport, std::uint32_t session, const BarrierTiming& timing,
              std::function<void()> watch);

  /// Sends hello until the board answers, which makes it construct the flight software of `spacecraft`, with its
  /// receiver on a line of its own at `receiver_baud` if that is not 0 and with a budget of each step, in the unit of
  /// the board's step reports, if that is not 0; returns the name of the board. Throws LinkError, also with the reason
  /// of a board that cannot run its flight software.
  std::string connect(std::uint8_t spacecraft, std::uint32_t receiver_baud = 0, std::uint64_t step_budget = 0);

  /// Number of bytes that the receiver's line has brought to the board since the hello; nothing if the board has not
  /// answered by `deadline`. Throws LinkError.
  std::optional<std::uint64_t> receiver_count(Clock::time_point deadline);

  /// Sends the packets of `step` and returns the packets of the answer. Throws LinkError, SessionLost if the board has
  /// been reset since connect().
  std::vector<Packet> exchange(std::uint32_t step, std::span<const Packet> packets);

  /// Returns the wait of the last exchange: from the last packet handed to the line, or handed to it again, to the
  /// first packet of the answer.
  [[nodiscard]] Clock::duration waited() const { return first_answer_ - last_sent_; }

  /// The snapshot of the flight software between two steps; empty if it gives none. Throws LinkError.
  std::vector<std::uint8_t> read_snapshot();

  /// Gives the flight software a snapshot before the first step. Returns the status of its restoration, 0 if it was
  /// accepted.
  /// Throws LinkError.
  std::int32_t write_snapshot(std::span<const std::uint8_t> snapshot);

  /// Sends the goodbye of the session. Not acknowledged.
  void goodbye();

  [[nodiscard]] BarrierCounters counters() const;

 private:
  /// State of one exchange.
  struct Exchange {
    std::uint32_t step = 0;
    std::span<const Packet> packets;
    std::vector<Packet> answer;
    std::uint16_t acknowledged = 0;  ///< packets received by the board without a gap
    std::uint16_t sent = 0;          ///< packets sent, from the first on
    bool poll_pending = false;       ///< sent, and not answered yet
    std::uint16_t sent_before_poll = 0;
    bool gap_reported = false;  ///< polled because of a gap in the answer, and no progress since
  };

  void send_window(Exchange& exchange);
  void poll(Exchange& exchange);
  // Processes a frame; true if it is progress.
  bool take(Exchange& exchange, const fsw::link::FrameView& frame);
  bool take_acknowledgement(Exchange& exchange, std::uint16_t held);
  bool take_answer(Exchange& exchange, const fsw::link::FrameView& frame);
  /// Sends a question until there is an answer of type `answer` that `accepts` takes. Throws LinkError.
  void ask(fsw::link::FrameType question, std::span<const std::uint8_t> payload, fsw::link::FrameType answer,
           const std::function<bool(std::span<const std::uint8_t>)>& accepts);
  void send(const fsw::link::FrameHeader& header, std::span<const std::uint8_t> payload = {});
  /// The next valid frame of this session, no value at `deadline`. Others are counted.
  std::optional<fsw::link::FrameView> receive(Clock::time_point deadline);

  FrameTransport& transport_;
  std::uint32_t session_;
  BarrierTiming timing_;
  std::function<void()> watch_;
  fsw::link::BatchSender inputs_;
  fsw::link::BatchReceiver outputs_;
  BarrierCounters counters_;
  Clock::time_point last_sent_, first_answer_;
  std::array<std::uint8_t, fsw::link::kMaxFrameBytes> frame_{};
};

}  // namespace vbar::pil
