#pragma once
// The packets of one answer, kept until the next step so that any of them can be sent again.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/packets/packet.h"

namespace vbar::boards {

/// Keeps the answer of a step until the next step, so that it can be sent again. If it is full, the newest packet is
/// dropped and counted.
inline constexpr std::size_t kOutboxBytes = std::size_t{128} * 1024;
inline constexpr std::size_t kOutboxPackets = 256;

class Outbox {  // NOLINT(cppcoreguidelines-pro-type-member-init): see bytes_
 public:
  void clear();

  /// Adds a packet of the flight software. Returns false and keeps nothing if its size is not that of a packet, or if
  /// no room would be left for a report.
  [[nodiscard]] bool append(std::span<const std::uint8_t> packet);
  /// Adds the packet that closes the answer. There is always room for one.
  void append_report(std::span<const std::uint8_t> packet);

  [[nodiscard]] std::uint16_t count() const { return count_; }
  /// Returns packet `index` below count(), in order of arrival.
  [[nodiscard]] std::span<const std::uint8_t> packet(std::uint16_t index) const;

 private:
  void store(std::span<const std::uint8_t> packet);

  // Left uninitialised on purpose: start-up need not write elements beyond count_.
  std::array<std::uint8_t, kOutboxBytes> bytes_;
  std::array<std::uint32_t, kOutboxPackets> end_;  ///< end of packet i in bytes_; it begins where its predecessor ends
  std::uint16_t count_ = 0;
};

}  // namespace vbar::boards
