#pragma once
// Authentication of telecommands, per space packet, with the services of CCSDS 355.0-B (Space Data Link Security): a
// security parameter index, an anti-replay sequence number and a message authentication code. All numbers are
// big-endian.
//
//   bytes 0 ... n-29    header and payload of the packet (packet.h); its length field counts the trailer too
//   bytes n-28, n-27    security parameter index: which key
//   bytes n-26 ... n-19 sequence number, greater than that of every telecommand accepted before
//   bytes n-18 ... n-3  code: the first 128 bits of HMAC-SHA-256 over all bytes before it, header included
//   last 2              CRC-16 of the packet
//
// Nothing is encrypted. Segments of a telecommand are packets, each with its own trailer.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/packets/packet.h"
#include "fsw/packets/sha256.h"

namespace vbar::fsw::packets {

inline constexpr std::size_t kSecurityCodeBytes = 16;
inline constexpr std::size_t kSecurityTrailerBytes = 2 + 8 + kSecurityCodeBytes;
/// Largest payload of a packet with a trailer.
inline constexpr std::size_t kMaxSecuredPayloadBytes = kMaxPayloadBytes - kSecurityTrailerBytes;

inline constexpr std::size_t kTelecommandKeyBytes = 32;
using TelecommandKey = std::array<std::uint8_t, kTelecommandKeyBytes>;

/// What both ends of a link hold: a key with its index, and the sequence number that the next one must exceed.
struct TelecommandSecurity {
  TelecommandKey key{};
  std::uint16_t index = 0;
  std::uint64_t sequence = 0;
};

/// The index that vbar's host states; ground software of another origin may use others.
inline constexpr std::uint16_t kHostKeyIndex = 1;

/// Returns true for APIDs of telecommands, 0x100 to 0x1FF, whether or not there is such a message.
constexpr bool is_telecommand_apid(Apid apid) {
  return (static_cast<std::uint16_t>(apid) & 0x700U) == 0x100U;
}

/// Reads a key from 64 hexadecimal digits, which white space may follow: kTooShort, kTooLong, kInvalidArgument.
Result<TelecommandKey> parse_telecommand_key(std::span<const char> text);

/// Returns the sequence number that stands for an instant of the clock of a computer, Unix time: the nanoseconds since
/// 1980-01-06. A program that begins with that of its start exceeds those of all programs before it, as long as the
/// clock is not set back.
constexpr std::uint64_t sequence_at(std::int64_t unix_s, std::int64_t ns) {
  constexpr std::int64_t kGpsEpochUnix_s = 315'964'800;
  return static_cast<std::uint64_t>((unix_s - kGpsEpochUnix_s) * kNanosecondsPerSecond + ns);
}

/// Writes `packet`, whole and with its CRC, to `out` with a trailer, and returns the new length. kTooLong if the
/// payload or `out` does not allow it; the statuses of parse_packet for an invalid packet.
Result<std::size_t> write_secured(std::span<const std::uint8_t> packet, const HmacSha256& hmac, std::uint16_t index,
                                  std::uint64_t sequence, std::span<std::uint8_t> out);

/// Verifies the trailers of telecommands, once a key has been given. Without one it accepts every packet unchanged.
class TelecommandAuthentication {
 public:
  /// Demands a trailer of every telecommand from here on.
  void require(const TelecommandSecurity& security);
  [[nodiscard]] bool is_required() const { return is_required_; }

  /// Verifies `packet`, parsed from `bytes`, and returns it without its trailer. Packets that are not telecommands are
  /// returned unchanged. kTooShort without room for a trailer; kBadChecksum for another index or a wrong code;
  /// kBadSequence if the sequence number does not exceed that of the last packet verified.
  Result<PacketView> verify(std::span<const std::uint8_t> bytes, const PacketView& packet);

  /// Sequence number of the last packet verified, or that given with the key; 0 without a key.
  [[nodiscard]] std::uint64_t sequence() const { return sequence_; }
  /// Raises the sequence number to that of a snapshot. It never decreases: a snapshot does not admit what was accepted
  /// since, nor what was sent before the key was given.
  void raise_sequence(std::uint64_t sequence);

  /// Returns the code of other data that this computer keeps outside of itself, 0 without a key. Its first byte must
  /// not be that of a telecommand packet (0x19).
  [[nodiscard]] std::array<std::uint8_t, kSecurityCodeBytes> code_of(std::span<const std::uint8_t> first,
                                                                     std::span<const std::uint8_t> second) const;

 private:
  HmacSha256 hmac_{{}};
  std::uint64_t sequence_ = 0;
  std::uint16_t index_ = 0;
  bool is_required_ = false;
};

}  // namespace vbar::fsw::packets
