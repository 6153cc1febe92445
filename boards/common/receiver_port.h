#pragma once
// Bytes of the GNSS receiver that is wired to the board: kept between two ticks, and divided at the tick into the
// packets of the step.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/packets/messages.h"

namespace vbar::boards {

/// Holds the next bytes as two packets of the same content: `input` (gnss_bytes) for the flight software, `mirror`
/// (wired_bytes) for the host.
struct WiredPiece {
  std::size_t count = 0;  ///< bytes of the receiver in each packet; 0: none are waiting, and the packets are empty
  std::size_t input_size = 0;
  std::size_t mirror_size = 0;
  std::array<std::uint8_t, fsw::packets::kMaxPacketBytes> input{};
  std::array<std::uint8_t, fsw::packets::kMaxPacketBytes> mirror{};
};

/// Queues the bytes, first in, first out. If it is full, the newest bytes are dropped and counted; waiting bytes are
/// never overwritten.
class ReceiverPort {  // NOLINT(cppcoreguidelines-pro-type-member-init): see bytes_
 public:
  /// Size of the queue: 5.7 s of a line at 115200 baud. A receiver with 60 signals brings 3 to 8 kB in a step of 10 s.
  static constexpr std::size_t kRingBytes = std::size_t{64} * 1024;
  /// Largest number of packets of one step: fewer than the flight software accepts (64), with room left in the answer.
  /// The remaining bytes wait for the next step.
  static constexpr std::size_t kPacketsPerStep = 48;

  /// Begins a session: discards the waiting bytes and sets all counts to zero. `spacecraft` as in packet headers.
  void open(std::uint8_t spacecraft);
  void close() { is_open_ = false; }
  /// Returns whether the session has a receiver on the board.
  [[nodiscard]] bool is_open() const { return is_open_; }

  void take(std::span<const std::uint8_t> bytes);

  /// Return the bytes received since the session began, and those among them that were dropped.
  [[nodiscard]] std::uint64_t received() const { return received_; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  [[nodiscard]] std::size_t waiting() const { return size_; }

  /// Writes the oldest bytes waiting, at most those of one packet, to `piece`, tagged with the time of the step. They
  /// wait until `accept`.
  void next_piece(fsw::GpsTime step_time, WiredPiece& piece) const;
  /// Removes the bytes of `piece`, the result of the last next_piece: its packets were delivered.
  void accept(const WiredPiece& piece);

  /// Begins a step, before its pieces: their sequence counts are then in ascending order, in which the flight software
  /// processes packets of one time.
  void begin_step();

 private:
  // Left uninitialised on purpose: only bytes that were written are read.
  std::array<std::uint8_t, kRingBytes> bytes_;
  std::size_t begin_ = 0;  ///< place of the oldest byte
  std::size_t size_ = 0;
  std::uint64_t received_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint16_t sequence_count_ = 0;
  std::uint8_t spacecraft_ = 0;
  bool is_open_ = false;
};

}  // namespace vbar::boards
