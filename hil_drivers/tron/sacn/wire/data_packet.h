#pragma once
// Data packets of ANSI E1.31-2018 (sACN: DMX512 over UDP), big-endian:
//
//     0  u16 0x0010, u16 0, "ASC-E1.17" padded to 12 bytes       root layer
//    16  flags 0x7 and length - 16, u32 4, CID[16]
//    38  flags 0x7 and length - 38, u32 2, source name[64]       framing layer
//   108  u8 priority, u16 universe of synchronisation, u8 sequence, u8 options, u16 universe
//   115  flags 0x7 and length - 115, u8 2, u8 0xA1, u16 0, u16 1, u16 1 + slots
//   125  u8 start code, slots

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace vbar::tron::sacn {

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;
using Cid = std::array<std::uint8_t, 16>;  ///< identifies a source

inline constexpr std::uint16_t kPort = 5568;
inline constexpr std::size_t kMaxSlots = 512;
inline constexpr std::size_t kSlotsAt = 126;
inline constexpr std::size_t kMaxPacketBytes = kSlotsAt + kMaxSlots;
inline constexpr std::size_t kSourceNameBytes = 64;  ///< the last one of them NUL
inline constexpr int kMaxPriority = 200;
inline constexpr std::uint16_t kMaxUniverse = 63999;

struct DataPacket {
  Cid cid{};
  std::string source_name;
  std::uint8_t priority = 100;
  std::uint16_t synchronisation = 0;  ///< universe; 0: none
  std::uint8_t sequence = 0;
  bool is_preview = false;     ///< not meant for lights
  bool is_terminated = false;  ///< the source ends; the slots are without meaning
  bool is_synchronisation_forced = false;
  std::uint16_t universe = 1;
  std::uint8_t start_code = 0;  ///< 0: levels
  std::vector<std::uint8_t> slots;
  friend bool operator==(const DataPacket&, const DataPacket&) = default;
};

/// Replaces the content of `datagram`. Throws std::invalid_argument for a field that E1.31 does not permit.
void encode_data_packet(const DataPacket& packet, Bytes& datagram);

/// Decodes bytes from the network. Throws std::invalid_argument with the position of the error.
[[nodiscard]] DataPacket decode_data_packet(ByteSpan datagram);

}  // namespace vbar::tron::sacn
