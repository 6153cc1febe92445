#pragma once
// UART of the Zynq (Cadence IP, UG585 chapter 19), 8 data bits, no parity, 1 stop bit, no flow control.
//
// Reception is by interrupt into a ring, for either depth of the receive FIFO: 64 bytes on silicon, 16 on the emulator.
// Transmission waits for space in the FIFO, for a bounded time.

#include <cstddef>
#include <cstdint>
#include <span>

#include "boards/zynq7000/byte_ring.h"

namespace vbar::boards::zynq7000 {

/// UART that only sends, for the console: usable at any time, in a fault handler too.
class UartTransmitter {
 public:
  explicit constexpr UartTransmitter(std::uintptr_t base) : base_(base) {}

  /// Resets and configures the UART; bytes on the line before are lost.
  void open(std::uint32_t baud) const;

  /// Sends all of `bytes` unless the line stalls for two seconds: then the others are dropped and the result is false.
  bool write(std::span<const std::uint8_t> bytes) const;

 private:
  std::uintptr_t base_;
};

/// Bidirectional UART. One object per UART, never moved: the interrupt handler holds its address.
class Uart {
 public:
  /// Size of the ring: sufficient for a full window of frames that arrives while a step runs.
  static constexpr std::size_t kRingBytes = 64 * 1024;

  constexpr Uart(std::uintptr_t base, unsigned interrupt) : base_(base), interrupt_(interrupt), transmitter_(base) {}
  Uart(const Uart&) = delete;
  Uart& operator=(const Uart&) = delete;

  void open(std::uint32_t baud);

  /// Reads the next received byte; false if there is none.
  bool read(std::uint8_t& byte) { return received_.pop(byte); }
  /// Reads the FIFO without waiting for its interrupt. To be called with interrupts masked.
  void take_received() { drain(); }
  [[nodiscard]] bool has_input() const { return !received_.empty(); }

  /// Writes as UartTransmitter::write does; counts the bytes dropped.
  void write(std::span<const std::uint8_t> bytes);

  /// Number of FIFO overruns, of bytes dropped by a full ring, of writes cut short by a stalled line.
  [[nodiscard]] std::uint32_t overruns() const { return overruns_; }
  [[nodiscard]] std::uint32_t bytes_dropped() const { return received_.dropped(); }
  [[nodiscard]] std::uint32_t writes_stalled() const { return writes_stalled_; }

 private:
  static void on_interrupt(void* self);
  void drain();
  bool take_waiting();

  std::uintptr_t base_;
  unsigned interrupt_;
  UartTransmitter transmitter_;
  ByteRing<kRingBytes> received_;
  std::uint32_t overruns_ = 0;
  std::uint32_t writes_stalled_ = 0;
};

}  // namespace vbar::boards::zynq7000
