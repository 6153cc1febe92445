#include "boards/zynq7000/uart.h"

#include "boards/zynq7000/clocks.h"
#include "boards/zynq7000/interrupts.h"
#include "boards/zynq7000/memory_map.h"
#include "boards/zynq7000/timer.h"

namespace vbar::boards::zynq7000 {
namespace {

// Register offsets.
constexpr std::uintptr_t kControl = 0x00;
constexpr std::uintptr_t kMode = 0x04;
constexpr std::uintptr_t kInterruptEnable = 0x08;
constexpr std::uintptr_t kInterruptDisable = 0x0C;
constexpr std::uintptr_t kInterruptStatus = 0x14;
constexpr std::uintptr_t kBaudGenerator = 0x18;
constexpr std::uintptr_t kReceiveTimeout = 0x1C;
constexpr std::uintptr_t kReceiveTrigger = 0x20;
constexpr std::uintptr_t kStatus = 0x2C;
constexpr std::uintptr_t kFifo = 0x30;
constexpr std::uintptr_t kBaudDivider = 0x34;

constexpr std::uint32_t kControlReset = 0x03;    // both paths; clears itself
constexpr std::uint32_t kControlEnable = 0x14;   // both paths
constexpr std::uint32_t kControlDisable = 0x28;  // both paths
constexpr std::uint32_t kMode8N1 = 0x20;
constexpr std::uint32_t kAllInterrupts = 0x1FFF;

constexpr std::uint32_t kInterruptTrigger = 1U << 0;  // at least kTriggerLevel bytes are received
constexpr std::uint32_t kInterruptOverrun = 1U << 5;
constexpr std::uint32_t kInterruptTimeout = 1U << 8;  // fewer, and the line has been quiet

constexpr std::uint32_t kStatusReceiveTrigger = 1U << 0;
constexpr std::uint32_t kStatusReceiveEmpty = 1U << 1;
constexpr std::uint32_t kStatusTransmitEmpty = 1U << 3;
constexpr std::uint32_t kStatusTransmitFull = 1U << 4;

constexpr std::uint32_t kTriggerLevel = 8;  // must lie below both FIFO depths, or it never fires on the emulator
constexpr std::uint32_t kTimeoutBits = 10;  // in units of 4 bit times
constexpr std::size_t kSmallestFifo = 16;   // capacity of an empty transmit FIFO on every target
constexpr std::uint64_t kStallSpan = timer_span_ms(2000);

// Number of bytes the transmitter accepts without overflow, after waiting for the first; 0 when it stalls.
std::size_t wait_for_room(std::uintptr_t base) {
  std::uint32_t status = reg(base + kStatus);
  if ((status & kStatusTransmitEmpty) != 0U) {
    return kSmallestFifo;
  }
  const std::uint64_t start = global_timer();
  while ((status & kStatusTransmitFull) != 0U) {
    if (global_timer() - start > kStallSpan) {
      return 0;
    }
    status = reg(base + kStatus);
  }
  return 1;
}

}  // namespace

void UartTransmitter::open(std::uint32_t baud) const {
  const BaudDivisors divisors = baud_divisors(uart_reference_hz(), baud);
  reg(base_ + kControl) = kControlDisable;
  reg(base_ + kInterruptDisable) = kAllInterrupts;
  reg(base_ + kBaudGenerator) = divisors.generator;
  reg(base_ + kBaudDivider) = divisors.divider;
  reg(base_ + kMode) = kMode8N1;  // after the divisors: the emulator derives its receive timeout here
  reg(base_ + kReceiveTimeout) = kTimeoutBits;
  reg(base_ + kReceiveTrigger) = kTriggerLevel;
  reg(base_ + kControl) = kControlReset;
  for (int i = 0; i < 100'000 && (reg(base_ + kControl) & kControlReset) != 0U; ++i) {
  }
  reg(base_ + kControl) = kControlEnable;
  reg(base_ + kInterruptStatus) = kAllInterrupts;
}

bool UartTransmitter::write(std::span<const std::uint8_t> bytes) const {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    std::size_t room = wait_for_room(base_);
    if (room == 0) {
      return false;
    }
    for (; room > 0 && sent < bytes.size(); --room) {
      reg(base_ + kFifo) = bytes[sent++];
    }
  }
  return true;
}

void Uart::open(std::uint32_t baud) {
  transmitter_.open(baud);
  interrupts_attach(interrupt_, on_interrupt, this);
  reg(base_ + kInterruptEnable) = kInterruptTrigger | kInterruptOverrun | kInterruptTimeout;
}

void Uart::write(std::span<const std::uint8_t> bytes) {
  if (!transmitter_.write(bytes)) {
    ++writes_stalled_;
  }
}

void Uart::on_interrupt(void* self) {
  static_cast<Uart*>(self)->drain();
}

// Moves bytes that are known to be present from the FIFO to the ring, without checking for each: a check is expensive.
bool Uart::take_waiting() {
  const std::uint32_t status = reg(base_ + kStatus);
  if ((status & kStatusReceiveEmpty) != 0U) {
    return false;
  }
  const std::uint32_t count = (status & kStatusReceiveTrigger) != 0U ? kTriggerLevel : 1U;
  for (std::uint32_t i = 0; i < count; ++i) {
    received_.push(static_cast<std::uint8_t>(reg(base_ + kFifo)));
  }
  return true;
}

// Acknowledge first, then empty the FIFO, then check again: a byte that arrives after the last check raises a new
// interrupt. A timeout acknowledged after the last check would be lost, and the last bytes of a frame with it.
void Uart::drain() {
  constexpr int kPasses = 8;  // a bound on the handler; if bytes are left, the interrupt fires again
  constexpr int kDeepestFifo = 64;
  int pass = 0;
  do {
    const std::uint32_t status = reg(base_ + kInterruptStatus);
    reg(base_ + kInterruptStatus) = status;
    if ((status & kInterruptOverrun) != 0U) {
      ++overruns_;
    }
    for (int i = 0; i < kDeepestFifo && take_waiting(); ++i) {
    }
  } while (++pass < kPasses && (reg(base_ + kStatus) & kStatusReceiveEmpty) == 0U);
  reg(base_ + kInterruptStatus) = kInterruptTrigger;
}

}  // namespace vbar::boards::zynq7000
