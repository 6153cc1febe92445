#pragma once
// Telecommands as an adversary on the link makes them: of each kind any number, from a seed. The adversary has seen
// every genuine telecommand, and has no key.

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "fsw/packets/big_endian.h"
#include "fsw/packets/crc.h"
#include "fsw/packets/messages.h"
#include "fsw/packets/security_trailer.h"

namespace vbar::fsw::messaging::test {

using Bytes = std::vector<std::uint8_t>;

enum class Hostility : std::uint8_t {
  kUnauthenticated,  ///< without a trailer
  kAltered,          ///< one bit, with a CRC that fits
  kDamaged,          ///< one bit, with the CRC of before
  kReplayed,         ///< accepted before
  kDelayed,          ///< genuine, but a later one was accepted before it arrived
  kOtherIndex,       ///< of the key, under another index
  kOtherKey,         ///< with the code of another key
  kCut,              ///< some of its last bytes are missing, with length and CRC that fit
  kTruncated,        ///< ends before its end
  kExtended,         ///< some bytes were inserted, with length and CRC that fit
  kSpliced,          ///< with the trailer of another one that was lost
  kGuessed,          ///< with a code that was guessed
};
inline constexpr std::array<const char*, 12> kHostilities = {
    "unauthenticated", "altered by a bit", "damaged",        "replayed",
    "delayed",         "of another index", "of another key", "cut",
    "truncated",       "extended",         "spliced",        "with a guessed code"};

class TelecommandSender {
 public:
  static constexpr std::uint8_t kSpacecraft = 1;

  explicit TelecommandSender(std::uint32_t seed) : random_(seed) {
    for (std::uint8_t& byte : security_.key) byte = static_cast<std::uint8_t>(random_());
    security_.index = packets::kHostKeyIndex;
    security_.sequence = std::uint64_t{1} << 60U;
    sequence_ = security_.sequence;
  }

  /// What the flight software starts with.
  [[nodiscard]] const packets::TelecommandSecurity& security() const { return security_; }

  /// Sequence number of the last genuine one.
  [[nodiscard]] std::uint64_t reached() const { return sequence_; }

  /// Returns the next genuine telecommand, of any kind, for the flight software to accept.
  Bytes genuine() {
    sequence_ += 1 + random_() % 1000;
    Bytes bytes = secured(plain(), security_.key, security_.index, sequence_);
    sent_.push_back(bytes);
    return bytes;
  }

  /// Returns a hostile one.
  Bytes hostile(Hostility kind) {
    const packets::TelecommandKey& key = security_.key;
    switch (kind) {
      case Hostility::kUnauthenticated:
        return plain();
      case Hostility::kAltered:
        return altered(fresh());
      case Hostility::kDamaged:
        return flipped(fresh(), 0);
      case Hostility::kReplayed:
        return sent_[random_() % sent_.size()];
      case Hostility::kDelayed:
        return secured(plain(), key, security_.index, sequence_ - random_() % 1000);
      case Hostility::kOtherIndex:
        return secured(plain(), key, static_cast<std::uint16_t>(security_.index + 1 + random_() % 0xFFFE),
                       sequence_ + 1 + random_() % 1000);
      case Hostility::kOtherKey: {
        packets::TelecommandKey other = key;
        const std::size_t bit = random_() % (8 * other.size());
        other[bit / 8] = static_cast<std::uint8_t>(other[bit / 8] ^ (1U << bit % 8));
        return secured(plain(), other, security_.index, sequence_ + 1 + random_() % 1000);
      }
      case Hostility::kCut: {
        Bytes bytes = fresh();
        const std::size_t variable = bytes.size() - packets::kPacketHeaderBytes - packets::kPacketCrcBytes;
        bytes.resize(bytes.size() - 1 - random_() % variable);
        return sealed(std::move(bytes));
      }
      case Hostility::kTruncated: {
        Bytes bytes = fresh();
        bytes.resize(random_() % bytes.size());
        return bytes;
      }
      case Hostility::kExtended: {
        Bytes bytes = fresh();
        const std::size_t at = packets::kPacketHeaderBytes + random_() % (bytes.size() - packets::kPacketHeaderBytes);
        const std::size_t room = packets::kMaxPacketBytes - bytes.size();
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), 1 + random_() % std::min<std::size_t>(room, 64),
                     static_cast<std::uint8_t>(random_()));
        return sealed(std::move(bytes));
      }
      case Hostility::kSpliced: {
        Bytes bytes = fresh();
        const Bytes other = fresh();
        const std::size_t count = packets::kSecurityTrailerBytes + packets::kPacketCrcBytes;
        std::copy(other.end() - count, other.end(), bytes.end() - count);
        return sealed(std::move(bytes));
      }
      case Hostility::kGuessed: {
        Bytes bytes = fresh();
        for (std::size_t k = 0; k < packets::kSecurityCodeBytes; ++k)
          bytes[bytes.size() - packets::kPacketCrcBytes - 1 - k] = static_cast<std::uint8_t>(random_());
        return sealed(std::move(bytes));
      }
    }
    return {};
  }

  /// Corrects the length field and the CRC of a packet, as an adversary would.
  static Bytes sealed(Bytes bytes) {
    const std::span<std::uint8_t> all(bytes);
    packets::write_big_endian(static_cast<std::uint16_t>(bytes.size() - 7), all, 4);
    const std::size_t crc_at = bytes.size() - packets::kPacketCrcBytes;
    packets::write_big_endian(packets::crc16_ccitt_false(all.first(crc_at)), all, crc_at);
    return bytes;
  }

 private:
  /// A genuine one with the next sequence number, which the adversary has kept from arriving.
  Bytes fresh() { return secured(plain(), security_.key, security_.index, sequence_ + 1 + random_() % 1000); }

  /// A telecommand without a trailer, valid but for its zeros.
  Bytes plain() {
    std::size_t kinds = 0;
    packets::for_each_telecommand([&]<class Message>() { ++kinds; });
    std::size_t chosen = random_() % kinds;
    Bytes bytes(packets::kMaxPacketBytes);
    packets::PacketHeader header;
    header.time = {static_cast<std::int64_t>(random_())};
    header.spacecraft = kSpacecraft;
    header.sequence_count = static_cast<std::uint16_t>(random_() & 0x3FFFU);
    packets::for_each_telecommand([&]<class Message>() {
      if (chosen-- != 0) return;
      bytes.resize(packets::encode(header, Message{}, bytes).value());
    });
    return bytes;
  }

  static Bytes secured(const Bytes& packet, const packets::TelecommandKey& key, std::uint16_t index,
                       std::uint64_t sequence) {
    Bytes bytes(packets::kMaxPacketBytes);
    const packets::HmacSha256 hmac(key);
    bytes.resize(packets::write_secured(packet, hmac, index, sequence, bytes).value());
    return bytes;
  }

  /// Flips one bit, with a CRC that fits. A length field that is wrong makes no packet, and sealed() corrects it.
  Bytes altered(const Bytes& bytes) {
    Bytes other = bytes;
    while (other == bytes) other = sealed(flipped(bytes, packets::kPacketCrcBytes));
    return other;
  }

  /// Flips one bit before the last `kept` bytes.
  Bytes flipped(Bytes bytes, std::size_t kept) {
    const std::size_t bit = random_() % (8 * (bytes.size() - kept));
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1U << bit % 8));
    return bytes;
  }

  std::mt19937 random_;
  packets::TelecommandSecurity security_;
  std::uint64_t sequence_ = 0;  ///< of the last genuine one
  std::vector<Bytes> sent_;
};

}  // namespace vbar::fsw::messaging::test
