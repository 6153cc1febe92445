#pragma once
// The two checksums of the wire formats.

#include <cstdint>
#include <span>

namespace vbar::fsw::packets {

/// Returns CRC-16/CCITT-FALSE (CCSDS 132.0-B-3, 4.1.6): polynomial 0x1021, start 0xFFFF, not reflected, no final XOR.
[[nodiscard]] std::uint16_t crc16_ccitt_false(std::span<const std::uint8_t> bytes);

/// Returns CRC-32 (IEEE 802.3): polynomial 0x04C11DB7, start 0xFFFFFFFF, reflected, final XOR 0xFFFFFFFF.
[[nodiscard]] std::uint32_t crc32_ieee(std::span<const std::uint8_t> bytes);

}  // namespace vbar::fsw::packets
