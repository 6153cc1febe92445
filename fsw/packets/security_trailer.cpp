#include "fsw/packets/security_trailer.h"

#include <algorithm>

#include "fsw/packets/big_endian.h"
#include "fsw/packets/crc.h"

namespace vbar::fsw::packets {
namespace {

constexpr std::size_t kLengthOffset = 4;
constexpr std::size_t kBytesBeforeLengthCounts = 7;  ///< the six of the primary header, and one
constexpr std::size_t kIndexBytes = 2;
constexpr std::size_t kSequenceBytes = 8;
static_assert(kIndexBytes + kSequenceBytes + kSecurityCodeBytes == kSecurityTrailerBytes);

/// Returns the value of a hexadecimal digit; 16 for another character.
constexpr unsigned digit_value(char c) {
  if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0');
  if (c >= 'a' && c <= 'f') return static_cast<unsigned>(c - 'a') + 10U;
  if (c >= 'A' && c <= 'F') return static_cast<unsigned>(c - 'A') + 10U;
  return 16U;
}

constexpr bool is_space(char c) {
  return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

}  // namespace

Result<TelecommandKey> parse_telecommand_key(std::span<const char> text) {
  while (!text.empty() && is_space(text.back())) text = text.first(text.size() - 1);
  for (const char c : text) {
    if (digit_value(c) > 15U) return Status::kInvalidArgument;
  }
  if (text.size() < 2 * kTelecommandKeyBytes) return Status::kTooShort;
  if (text.size() > 2 * kTelecommandKeyBytes) return Status::kTooLong;
  TelecommandKey key{};
  for (std::size_t k = 0; k < key.size(); ++k)
    key[k] = static_cast<std::uint8_t>(digit_value(text[2 * k]) << 4U | digit_value(text[2 * k + 1]));
  return key;
}

Result<std::size_t> write_secured(std::span<const std::uint8_t> packet, const HmacSha256& hmac, std::uint16_t index,
                                  std::uint64_t sequence, std::span<std::uint8_t> out) {
  const Result<PacketView> view = parse_packet(packet);
  if (!view.ok()) return view.status();
  if (view.value().payload.size() > kMaxSecuredPayloadBytes) return Status::kTooLong;
  const std::size_t size = packet.size() + kSecurityTrailerBytes;
  if (out.size() < size) return Status::kTooLong;
  const std::size_t index_at = packet.size() - kPacketCrcBytes;
  const std::size_t code_at = index_at + kIndexBytes + kSequenceBytes;
  const std::size_t crc_at = code_at + kSecurityCodeBytes;
  std::copy_n(packet.begin(), index_at, out.begin());
  write_big_endian(static_cast<std::uint16_t>(size - kBytesBeforeLengthCounts), out, kLengthOffset);
  write_big_endian(index, out, index_at);
  write_big_endian(sequence, out, index_at + kIndexBytes);
  const Sha256Digest code = hmac.code_of(out.first(code_at));
  std::copy_n(code.begin(), kSecurityCodeBytes, out.begin() + static_cast<std::ptrdiff_t>(code_at));
  write_big_endian(crc16_ccitt_false(out.first(crc_at)), out, crc_at);
  return size;
}

void TelecommandAuthentication::require(const TelecommandSecurity& security) {
  hmac_ = HmacSha256(security.key);
  index_ = security.index;
  sequence_ = security.sequence;
  is_required_ = true;
}

Result<PacketView> TelecommandAuthentication::verify(std::span<const std::uint8_t> bytes, const PacketView& packet) {
  if (!is_required_ || !is_telecommand_apid(packet.header.apid)) return packet;
  if (packet.payload.size() < kSecurityTrailerBytes) return Status::kTooShort;
  const std::size_t payload_bytes = packet.payload.size() - kSecurityTrailerBytes;
  const std::span<const std::uint8_t> trailer = packet.payload.subspan(payload_bytes);
  const std::size_t code_at = kPacketHeaderBytes + payload_bytes + kIndexBytes + kSequenceBytes;
  const Sha256Digest code = hmac_.code_of(bytes.first(code_at));
  const bool is_genuine =
      are_same(std::span(code).first<kSecurityCodeBytes>(), trailer.subspan(kIndexBytes + kSequenceBytes));
  if (!is_genuine || read_big_endian<std::uint16_t>(trailer, 0) != index_) return Status::kBadChecksum;
  const auto sequence = read_big_endian<std::uint64_t>(trailer, kIndexBytes);
  if (sequence <= sequence_) return Status::kBadSequence;
  sequence_ = sequence;
  return PacketView{packet.header, packet.payload.first(payload_bytes)};
}

void TelecommandAuthentication::raise_sequence(std::uint64_t sequence) {
  sequence_ = std::max(sequence_, sequence);
}

std::array<std::uint8_t, kSecurityCodeBytes> TelecommandAuthentication::code_of(
    std::span<const std::uint8_t> first, std::span<const std::uint8_t> second) const {
  std::array<std::uint8_t, kSecurityCodeBytes> code{};
  if (!is_required_) return code;
  const Sha256Digest whole = hmac_.code_of(first, second);
  std::copy_n(whole.begin(), code.size(), code.begin());
  return code;
}

}  // namespace vbar::fsw::packets
