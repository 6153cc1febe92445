#pragma once
// The executive of every board: frames in, flight software stepped at the barrier, frames out (the board's side of
// fsw/link/frame.h). The only part specific to a board is its `Platform`.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "boards/common/outbox.h"
#include "boards/common/receiver_port.h"
#include "boards/common/snapshot_port.h"
#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/link/batch.h"
#include "fsw/link/frame.h"
#include "fsw/messaging/vbar_gnc.h"
#include "fsw/packets/security_trailer.h"

namespace vbar::boards {

/// Unit of Platform::counter, with the numbers of step_report.unit.
enum class CounterUnit : std::int8_t { kNone = 0, kEmulatedTimerTicks = 1, kCycles = 2 };

/// Holds the functions of a board. All receive `context`; none may block indefinitely.
struct Platform {
  void* context = nullptr;
  const char* name = "";                                                       ///< ASCII, shown to the host
  void (*send)(void* context, std::span<const std::uint8_t> frame) = nullptr;  ///< one frame to the host, uncoded
  std::uint64_t (*counter)(void* context) = nullptr;                           ///< cost counter; may be null
  std::uint32_t (*stack_high_water)(void* context) = nullptr;                  ///< bytes; may be null
  CounterUnit counter_unit = CounterUnit::kNone;
  /// Budget of a step in units of `counter`, unless the hello states another; 0: none.
  std::uint64_t step_budget = 0;
  /// Notify a watchdog of each session, of the first packet of each step and of the end of the step. Each may be null.
  void (*session_begins)(void* context, std::uint32_t session, std::uint64_t step_budget) = nullptr;
  void (*step_begins)(void* context, std::uint32_t step) = nullptr;
  void (*step_ends)(void* context, bool within_budget) = nullptr;
  /// Prepares the line on which a GNSS receiver is wired to the board for this rate, and discards the bytes received
  /// before. Returns false without such a line, or if the host uses it as its link. 0 baud: the session has no receiver
  /// there. Null: the board has no such line.
  bool (*open_receiver)(void* context, std::uint32_t baud) = nullptr;
  /// Moves the received bytes of that line to `out` and returns their number. Null as above.
  std::size_t (*read_receiver)(void* context, std::span<std::uint8_t> out) = nullptr;
  /// Key that telecommands need. Null: they need none.
  const fsw::packets::TelecommandSecurity* telecommand_security = nullptr;
  /// Notifies a board that retains it through a reset of the sequence number that telecommands must exceed, before each
  /// step executes those that have arrived. May be null.
  void (*telecommands_accepted)(void* context, std::uint64_t sequence) = nullptr;
};

/// Follows the name of a board in the answer to a hello, if its telecommands need a key.
inline constexpr char kAuthenticates[] = ", telecommands authenticated";

/// Room for the flight software's state (vbar_gnc_state_size() must not exceed it), and how it is aligned.
inline constexpr std::size_t kGncStateBytes = std::size_t{8} * 1024 * 1024;
inline constexpr std::size_t kGncStateAlignment = 64;

enum class Activity : std::uint8_t { kIdle, kStepped, kGoodbye };

/// Holds the payload of a kHello (fsw/link/frame.h).
struct Hello {
  std::uint8_t spacecraft = 0;
  std::optional<std::uint32_t> receiver_baud;  ///< of the line on which a receiver is wired to the board
  std::uint64_t step_budget = 0;               ///< in units of Platform::counter; 0: that of the board

  /// Returns nothing for a payload whose size is not that of a hello.
  static std::optional<Hello> parse(std::span<const std::uint8_t> payload);
};

/// Executes the protocol of the link. There is one executive per image, in static memory (it is large). It is neither
/// thread-safe nor re-entrant, and does not move: the flight software holds its address.
///
/// A kHello of another session constructs a new flight software and discards all else; one of the same session is only
/// answered again. A flight software that does not fit this executive is never run: the kHelloAck states the reason
/// ("error: ..."). A step that exceeds its budget is the last one: its answer remains available, and frames of the next
/// step are answered by a kHelloAck with the reason.
///
/// With a key each flight software demands sequence numbers above those of all before it, so that a new session does
/// not accept the telecommands of an earlier one.
class FlightExecutive {
 public:
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): gnc_state_ is cleared when a session begins
  explicit FlightExecutive(const Platform& platform)
      : platform_(platform),
        telecommand_sequence_(platform.telecommand_security == nullptr ? 0 : platform.telecommand_security->sequence) {}
  FlightExecutive(const FlightExecutive&) = delete;
  FlightExecutive& operator=(const FlightExecutive&) = delete;

  /// Processes one received frame, whole and uncoded: answers it, and runs the step that it completes. Returns kStepped
  /// also for a batch without a tick: its answer is the report alone, and nothing was stepped.
  Activity on_frame(std::span<const std::uint8_t> frame);

  /// Counts frames that a board dropped before they were complete (COBS errors, foreign datagrams), for the step
  /// report.
  void count_rejected(std::uint32_t frames) { counters_.rejected += frames; }

  /// Returns true during a session whose receiver is wired to the board.
  [[nodiscard]] bool has_receiver() const { return receiver_.is_open(); }

  /// States that a reset has ended `session`; to be called once. Until the next hello, the host of that session
  /// receives `error` ("error: ...", at most 120 characters, which must remain valid).
  void lose_session(std::uint32_t session, const char* error);

  /// Reads the bytes that the line of the receiver has brought. A board calls it when bytes have arrived, so that its
  /// own buffer does not overflow between two ticks.
  void read_receiver();

 private:
  /// Counts since the session began, for the step report.
  struct Counters {
    std::uint32_t received = 0;         ///< frames handed to on_frame
    std::uint32_t rejected = 0;         ///< among these (or before them): broken, of another session, out of order
    std::uint32_t duplicated = 0;       ///< among these: held or run already
    std::uint32_t packets_dropped = 0;  ///< from the flight software: outbox full, or not of a packet's size
    std::uint32_t ticks_missing = 0;    ///< batches that did not end in a tick
  };

  static void sink(void* context, const std::uint8_t* packet, std::size_t size);

  void on_hello(const fsw::link::FrameView& frame);
  void answer_hello();
  Activity on_data(const fsw::link::FrameView& frame);
  /// Returns true for the step of the present answer and for every step before it.
  [[nodiscard]] bool already_run(std::uint32_t step) const;
  void on_poll(const fsw::link::FrameHeader& header);

  void begin_session(std::uint32_t session, std::span<const std::uint8_t> hello_payload);
  /// Returns the budget of a step that a hello states, or else the board's; 0 without a counter to compare it with.
  [[nodiscard]] std::uint64_t budget_of(const std::optional<Hello>& hello) const;
  /// Starts what the hello asks for. Returns null, or else the text for the host.
  const char* start(const std::optional<Hello>& hello);
  /// Constructs the flight software. Returns null, or else the text for the host.
  const char* start_flight_software(std::uint8_t spacecraft);
  /// Gives the key of the board to the new flight software. Null, or else the text for the host.
  const char* require_authentication();
  /// Opens the receiver's line, if the hello asks for it. Returns null, or else the text for the host.
  const char* open_receiver(const std::optional<std::uint32_t>& baud);
  void close_receiver();
  void on_receiver_poll();
  void on_snapshot_poll(const fsw::link::FrameView& frame);
  void on_snapshot_piece(const fsw::link::FrameView& frame);
  /// Passes the bytes of the receiver's line to the flight software, and to the host in the answer.
  void deliver_receiver_bytes(fsw::GpsTime step_time);
  void begin_step(std::uint32_t step);
  void close_step(std::span<const std::uint8_t> last_packet);
  void append_step_report(std::uint64_t cost);

  void send_answer();
  void send_frame(const fsw::link::FrameHeader& header, std::span<const std::uint8_t> payload) const;
  [[nodiscard]] std::uint64_t read_counter() const;

  Platform platform_;
  Counters counters_;
  bool has_session_ = false;
  bool has_state_ = false;   ///< gnc_state_ holds a flight software, running or not
  bool can_fly_ = false;     ///< a flight software is running in gnc_state_
  bool has_answer_ = false;  ///< outbox_ holds the answer of inputs_.step()
  std::uint32_t session_ = 0;
  std::uint8_t spacecraft_ = 0;
  std::uint16_t report_count_ = 0;
  std::uint64_t step_budget_ = 0;       ///< 0: none
  std::uint64_t telecommand_sequence_;  ///< which telecommands must exceed; of a session that has begun, at its begin
  fsw::GpsTime step_time_;
  const char* hello_text_ = "";
  fsw::link::BatchReceiver inputs_;
  fsw::link::BatchSender answer_;
  Outbox outbox_;
  ReceiverPort receiver_;
  SnapshotPort snapshot_;
  alignas(kGncStateAlignment) std::array<std::byte, kGncStateBytes> gnc_state_;
};

}  // namespace vbar::boards
