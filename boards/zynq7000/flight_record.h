#pragma once
// Data of a flight that a board retains through a reset: a record in memory that a reset does not change. Its checksum
// states whether it is intact.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "boards/zynq7000/session_guard.h"

namespace vbar::boards::zynq7000 {

struct FlightRecord {
  std::uint32_t session = 0;
  std::uint32_t step = 0;
  std::uint32_t in_step = 0;              ///< 1 from the first packet of `step` to its end
  std::uint32_t expired = 0;              ///< 1: the handler of the watchdog has requested the reset
  std::uint32_t is_ethernet = 0;          ///< 1: the interface of the peer is Ethernet
  std::uint32_t port = 0;                 ///< port of the peer; the following are the peer's too
  std::array<std::uint8_t, 4> address{};  ///< IPv4
  std::array<std::uint8_t, 8> mac{};      ///< the first 6
  /// Sequence number that telecommands must exceed, its upper and its lower half; 0 without a key.
  std::array<std::uint32_t, 2> telecommand_sequence{};
};
using RecordWords = std::array<std::uint32_t, sizeof(FlightRecord) / sizeof(std::uint32_t)>;

constexpr RecordWords words_of(const FlightRecord& record) {
  return std::bit_cast<RecordWords>(record);
}

/// Returns FNV-1a. The checksum of zeros is not zero, so that memory which was never written does not count as a
/// record.
constexpr std::uint32_t checksum_of(const FlightRecord& record) {
  std::uint32_t hash = 0x811C9DC5U;
  for (const std::uint32_t word : words_of(record)) {
    for (unsigned shift = 0; shift < 32; shift += 8) {
      hash = (hash ^ ((word >> shift) & 0xFFU)) * 0x01000193U;
    }
  }
  return hash;
}

/// Writes the peer of the session to the words of a record; the next function reads it.
void set_peer(FlightRecord& record, const Sender& sender);
Sender peer_of(const FlightRecord& record);

/// Sequence number in two halves.
constexpr std::array<std::uint32_t, 2> halves_of(std::uint64_t sequence) {
  return {static_cast<std::uint32_t>(sequence >> 32U), static_cast<std::uint32_t>(sequence & 0xFFFF'FFFFU)};
}
constexpr std::uint64_t sequence_of(const FlightRecord& record) {
  return static_cast<std::uint64_t>(record.telecommand_sequence[0]) << 32U | record.telecommand_sequence[1];
}

/// Writes the reason why the session of `record` has ended, for its host: "error: ...", zero-terminated.
void describe_reset(const FlightRecord& record, std::span<char, 120> text);

}  // namespace vbar::boards::zynq7000
