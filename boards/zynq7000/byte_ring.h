#pragma once
// Ring of bytes from an interrupt handler to the main loop: one writer, one reader, no lock. If it is full the newest
// byte is dropped and counted; bytes in the ring are never overwritten.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace vbar::boards::zynq7000 {

template <std::size_t kBytes>
class ByteRing {
  static_assert(kBytes > 0 && (kBytes & (kBytes - 1)) == 0 && kBytes <= 0x80000000U, "a power of two");

 public:
  /// Adds a byte; for the writer.
  void push(std::uint8_t byte) {
    const std::uint32_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) >= kBytes) {
      dropped_.store(dropped_.load(std::memory_order_relaxed) + 1U, std::memory_order_relaxed);
      return;
    }
    bytes_[head % kBytes] = byte;
    head_.store(head + 1U, std::memory_order_release);
  }

  /// Removes the oldest byte; for the reader. Returns false if the ring is empty.
  bool pop(std::uint8_t& byte) {
    const std::uint32_t tail = tail_.load(std::memory_order_relaxed);
    if (head_.load(std::memory_order_acquire) == tail) {
      return false;
    }
    byte = bytes_[tail % kBytes];
    tail_.store(tail + 1U, std::memory_order_release);
    return true;
  }

  [[nodiscard]] bool empty() const {
    return head_.load(std::memory_order_acquire) == tail_.load(std::memory_order_acquire);
  }
  [[nodiscard]] std::uint32_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

 private:
  std::array<std::uint8_t, kBytes> bytes_{};
  std::atomic<std::uint32_t> head_{0};  // both count bytes ever moved, modulo 2^32
  std::atomic<std::uint32_t> tail_{0};
  std::atomic<std::uint32_t> dropped_{0};
};

}  // namespace vbar::boards::zynq7000
