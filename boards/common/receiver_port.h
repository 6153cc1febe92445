#pragma once
// Bytes of the GNSS receiver that is wired to the board: kept between two ticks, and cut at the tick into the packets
// of the step.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/packets/messages.h"

namespace vbar::boards {

/// Next bytes as two packets of the same content: `input` (gnss_bytes) for the flight software, `mirror` (wired_bytes)
/// for the host.
struct WiredPiece {
  std::size_t count = 0;  ///< bytes of the receiver in it; 0: none are waiting, and the packets are empty
  std::size_t input_size = 0;
  std::size_t mirror_size = 0;
  std::array<std::uint8_t, fsw::packets::kMaxPacketBytes> input{};
  std::array<std::uint8_t, fsw::packets::kMaxPacketBytes> mirror{};
};

/// Queue of received bytes, first in, first out. If it is full the newest bytes are dropped and counted; waiting bytes
/// are never overwritten.
class ReceiverPort {  // NOLINT(cppcoreguidelines-pro-type-member-init): see bytes_
 public:
  /// Size of the ring: 5.7 s of a line at 115200 baud; a step of 10 s of a receiver with 60 signals brings 3 to 8 kB.
  static constexpr std::size_t kRingBytes = std::size_t{64} * 1024;
  /// Packets of one step: fewer than the flight software accepts (64), and they leave room in the answer. Further bytes
  /// wait for the next step.
  static constexpr std::size_t kPacketsPerStep = 48;

  /// Begins a session: nothing is waiting, and all counts are zero. `spacecraft` is the number in packet headers.
  void open(std::uint8_t spacecraft);
  void close() { is_open_ = false; }
  /// Returns false if the session has no receiver on the board.
  [[nodiscard]] bool is_open() const { return is_open_; }

  void take(std::span<const std::uint8_t> bytes);

  /// Number of bytes received since the session began, and of those that were dropped.
  [[nodiscard]] std::uint64_t received() const { return received_; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  [[nodiscard]] std::size_t waiting() const { return size_; }

  /// Writes the oldest bytes waiting, at most those of one packet, to `piece`, tagged with the time of the step. They
  /// wait until `accept`.
  void next_piece(fsw::GpsTime step_time, WiredPiece& piece) const;
  /// Removes the bytes of `piece`, the result of the last next_piece, after its packets were delivered.
  void accept(const WiredPiece& piece);

  /// Begins a step, before its pieces: their sequence counts are then in ascending order, which is the order in which
  /// the flight software processes packets of one time.
  void begin_step();

 private:
  // Left uninitialised on purpose: only bytes that were written are read.
  std::array<std::uint8_t, kRingBytes> bytes_;
  std::size_t begin_ = 0;  ///< position of the oldest byte
  std::size_t size_ = 0;
  std::uint64_t received_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint16_t sequence_count_ = 0;
  std::uint8_t spacecraft_ = 0;
  bool is_open_ = false;
};

}  // namespace vbar::boards
