#include "boards/zynq7000/ethernet.h"

#include <algorithm>
#include <array>

#include "boards/zynq7000/cpu.h"
#include "boards/zynq7000/interrupts.h"
#include "boards/zynq7000/memory_map.h"
#include "boards/zynq7000/timer.h"

namespace vbar::boards::zynq7000 {
namespace {

constexpr std::uintptr_t kNetworkControl = kGem0 + 0x00U;
constexpr std::uintptr_t kNetworkConfiguration = kGem0 + 0x04U;
constexpr std::uintptr_t kDmaConfiguration = kGem0 + 0x10U;
constexpr std::uintptr_t kTransmitStatus = kGem0 + 0x14U;
constexpr std::uintptr_t kReceiveQueue = kGem0 + 0x18U;
constexpr std::uintptr_t kTransmitQueue = kGem0 + 0x1CU;
constexpr std::uintptr_t kReceiveStatus = kGem0 + 0x20U;
constexpr std::uintptr_t kInterruptStatus = kGem0 + 0x24U;
constexpr std::uintptr_t kInterruptEnable = kGem0 + 0x28U;
constexpr std::uintptr_t kInterruptDisable = kGem0 + 0x2CU;
constexpr std::uintptr_t kHashLow = kGem0 + 0x80U;
constexpr std::uintptr_t kHashHigh = kGem0 + 0x84U;
constexpr std::uintptr_t kAddressLow = kGem0 + 0x88U;
constexpr std::uintptr_t kAddressHigh = kGem0 + 0x8CU;

constexpr std::uint32_t kControlReceive = 1U << 2;
constexpr std::uint32_t kControlTransmit = 1U << 3;
constexpr std::uint32_t kControlManagement = 1U << 4;
constexpr std::uint32_t kControlClearStatistics = 1U << 5;
constexpr std::uint32_t kControlStartTransmission = 1U << 9;
constexpr std::uint32_t kControlRunning = kControlReceive | kControlTransmit | kControlManagement;

constexpr std::uint32_t kAllInterrupts = 0x07FFFEFFU;
constexpr std::uint32_t kInterruptReceived = 1U << 1;
constexpr std::uint32_t kInterruptReceiveRingFull = 1U << 2;
constexpr std::uint32_t kReceiveNoBuffer = 1U << 0;

// Descriptors (UG585 chapter 16).
struct Descriptor {
  volatile std::uint32_t address;
  volatile std::uint32_t status;
};
constexpr std::uint32_t kReceiveUsed = 1U << 0;  // in `address`: the processor's, until it clears it
constexpr std::uint32_t kReceiveWrap = 1U << 1;
constexpr std::uint32_t kReceiveWhole = (1U << 14) | (1U << 15);  // in `status`: start and end of frame in one buffer
constexpr std::uint32_t kReceiveLength = 0x1FFFU;
constexpr std::uint32_t kTransmitUsed = 1U << 31;  // in `status`: the processor's, until it clears it
constexpr std::uint32_t kTransmitWrap = 1U << 30;
constexpr std::uint32_t kTransmitLast = 1U << 15;

constexpr std::size_t kBufferBytes = 1536;
constexpr std::size_t kReceiveBuffers = 64;   // two windows of the link: the session's and that of another sender
constexpr std::size_t kTransmitBuffers = 40;  // one window and some
constexpr std::uint64_t kSendSpan = timer_span_ms(100);

struct Rings {
  alignas(64) std::array<Descriptor, kReceiveBuffers> receive;
  alignas(64) std::array<Descriptor, kTransmitBuffers> transmit;
  alignas(64) std::array<std::array<std::uint8_t, kBufferBytes>, kReceiveBuffers> received;
  alignas(64) std::array<std::array<std::uint8_t, kBufferBytes>, kTransmitBuffers> transmitted;
};
// One controller, one set of rings, in uncached memory according to the linker script.
[[gnu::section(".dma")]] Rings rings;

std::uint32_t bus_address(const void* pointer) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(pointer));  // the map is flat
}

void prepare_rings() {
  for (std::size_t i = 0; i < kReceiveBuffers; ++i) {
    rings.receive[i].status = 0;
    rings.receive[i].address = bus_address(rings.received[i].data()) | (i + 1 == kReceiveBuffers ? kReceiveWrap : 0U);
  }
  for (std::size_t i = 0; i < kTransmitBuffers; ++i) {
    rings.transmit[i].address = bus_address(rings.transmitted[i].data());
    rings.transmit[i].status = kTransmitUsed | (i + 1 == kTransmitBuffers ? kTransmitWrap : 0U);
  }
  synchronize();
}

std::uint32_t configuration(const PhyLink& link) {
  constexpr std::uint32_t kStripCheckSequence = 1U << 17;
  constexpr std::uint32_t kSlowestManagementClock = 7U << 18;  // bus clock / 224: within 2.5 MHz on any board
  std::uint32_t value = kStripCheckSequence | kSlowestManagementClock;
  value |= link.full_duplex ? 1U << 1 : 0U;
  value |= link.rate == LineRate::k100Mbps ? 1U << 0 : 0U;
  value |= link.rate == LineRate::k1000Mbps ? 1U << 10 : 0U;
  return value;
}

}  // namespace

void Ethernet::open(const MacAddress& mac) {
  reg(kNetworkControl) = 0;
  reg(kNetworkControl) = kControlClearStatistics;
  reg(kTransmitStatus) = 0xFFU;
  reg(kReceiveStatus) = 0x0FU;
  reg(kInterruptDisable) = kAllInterrupts;
  reg(kInterruptStatus) = kAllInterrupts;
  prepare_rings();
  reg(kReceiveQueue) = bus_address(rings.receive.data());
  reg(kTransmitQueue) = bus_address(rings.transmit.data());
  reg(kHashLow) = 0;  // no multicast
  reg(kHashHigh) = 0;
  reg(kAddressLow) = static_cast<std::uint32_t>(mac[0]) | (static_cast<std::uint32_t>(mac[1]) << 8) |
                     (static_cast<std::uint32_t>(mac[2]) << 16) | (static_cast<std::uint32_t>(mac[3]) << 24);
  reg(kAddressHigh) = static_cast<std::uint32_t>(mac[4]) | (static_cast<std::uint32_t>(mac[5]) << 8);
  reg(kNetworkConfiguration) = configuration(PhyLink{});
  constexpr std::uint32_t kBursts16 = 0x10U;
  constexpr std::uint32_t kWholePacketMemory = (3U << 8) | (1U << 10);
  reg(kDmaConfiguration) = ((kBufferBytes / 64U) << 16) | kWholePacketMemory | kBursts16;
  reg(kNetworkControl) = kControlManagement;
  phy_ = Phy::find(kGem0);
  static_cast<void>(link_came_up());
  interrupts_attach(kInterruptGem0, on_interrupt, this);
  reg(kInterruptEnable) = kInterruptReceived | kInterruptReceiveRingFull;
}

bool Ethernet::link_came_up() {
  if (!waits_for_link()) {
    return link_.has_value();
  }
  link_ = phy_->link();
  if (link_.has_value()) {
    reg(kNetworkConfiguration) = configuration(*link_);
    clocks_set_ethernet(link_->rate);
    reg(kNetworkControl) = kControlRunning;
  }
  return link_.has_value();
}

bool Ethernet::has_input() const {
  return (rings.receive[next_receive_].address & kReceiveUsed) != 0U;
}

std::size_t Ethernet::receive(std::span<std::uint8_t> frame) {
  for (std::size_t i = 0; i < kReceiveBuffers && has_input(); ++i) {
    memory_barrier();
    const std::uint32_t status = rings.receive[next_receive_].status;
    const std::size_t size = status & kReceiveLength;
    const bool usable = (status & kReceiveWhole) == kReceiveWhole && size <= kBufferBytes && size <= frame.size();
    if (usable) {
      std::copy_n(rings.received[next_receive_].begin(), size, frame.begin());
    } else {
      ++frames_broken_;
    }
    release_received();
    if (usable && size > 0) {
      return size;
    }
  }
  return 0;
}

void Ethernet::release_received() {
  Descriptor& descriptor = rings.receive[next_receive_];
  memory_barrier();
  descriptor.address = descriptor.address & ~kReceiveUsed;
  next_receive_ = (next_receive_ + 1) % kReceiveBuffers;
  if ((reg(kReceiveStatus) & kReceiveNoBuffer) == 0U) {
    return;
  }
  // The ring was full, and reception stalls until it is disabled and enabled again (UG585 16.7.4).
  ++receive_overruns_;
  reg(kReceiveStatus) = kReceiveNoBuffer;
  synchronize();
  reg(kNetworkControl) = kControlRunning & ~kControlReceive;
  reg(kNetworkControl) = kControlRunning;
}

void Ethernet::send(std::span<const std::uint8_t> frame) {
  Descriptor& descriptor = rings.transmit[next_send_];
  const std::uint64_t start = global_timer();
  bool is_free = (descriptor.status & kTransmitUsed) != 0U;
  while (!is_free && global_timer() - start < kSendSpan) {
    is_free = (descriptor.status & kTransmitUsed) != 0U;
  }
  if (!is_free || !link_.has_value() || frame.size() > kBufferBytes) {
    ++sends_dropped_;
    return;
  }
  std::copy(frame.begin(), frame.end(), rings.transmitted[next_send_].begin());
  memory_barrier();
  const bool wraps = next_send_ + 1 == kTransmitBuffers;
  descriptor.status = static_cast<std::uint32_t>(frame.size()) | kTransmitLast | (wraps ? kTransmitWrap : 0U);
  synchronize();
  next_send_ = (next_send_ + 1) % kTransmitBuffers;
  reg(kTransmitStatus) = 0xFFU;
  reg(kNetworkControl) = kControlRunning | kControlStartTransmission;
}

// Frames stay in the ring until the main loop fetches them; the interrupt only ends the wait for interrupts.
void Ethernet::on_interrupt(void*) {
  reg(kInterruptStatus) = reg(kInterruptStatus);
}

}  // namespace vbar::boards::zynq7000
