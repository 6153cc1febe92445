#include "fsw/packets/sha256.h"

#include <algorithm>

#include "fsw/packets/big_endian.h"

namespace vbar::fsw::packets {
namespace {

constexpr std::size_t kRounds = 64;
constexpr std::size_t kLengthBytes = 8;

// FIPS 180-4, 4.2.2: the first 32 bits of the fractional parts of the cube roots of the first 64 primes.
constexpr std::array<std::uint32_t, kRounds> kConstants{
    0x428A2F98U, 0x71374491U, 0xB5C0FBCFU, 0xE9B5DBA5U, 0x3956C25BU, 0x59F111F1U, 0x923F82A4U, 0xAB1C5ED5U,
    0xD807AA98U, 0x12835B01U, 0x243185BEU, 0x550C7DC3U, 0x72BE5D74U, 0x80DEB1FEU, 0x9BDC06A7U, 0xC19BF174U,
    0xE49B69C1U, 0xEFBE4786U, 0x0FC19DC6U, 0x240CA1CCU, 0x2DE92C6FU, 0x4A7484AAU, 0x5CB0A9DCU, 0x76F988DAU,
    0x983E5152U, 0xA831C66DU, 0xB00327C8U, 0xBF597FC7U, 0xC6E00BF3U, 0xD5A79147U, 0x06CA6351U, 0x14292967U,
    0x27B70A85U, 0x2E1B2138U, 0x4D2C6DFCU, 0x53380D13U, 0x650A7354U, 0x766A0ABBU, 0x81C2C92EU, 0x92722C85U,
    0xA2BFE8A1U, 0xA81A664BU, 0xC24B8B70U, 0xC76C51A3U, 0xD192E819U, 0xD6990624U, 0xF40E3585U, 0x106AA070U,
    0x19A4C116U, 0x1E376C08U, 0x2748774CU, 0x34B0BCB5U, 0x391C0CB3U, 0x4ED8AA4AU, 0x5B9CCA4FU, 0x682E6FF3U,
    0x748F82EEU, 0x78A5636FU, 0x84C87814U, 0x8CC70208U, 0x90BEFFFAU, 0xA4506CEBU, 0xBEF9A3F7U, 0xC67178F2U};

/// Returns x rotated to the right by 1 to 31 bits.
constexpr std::uint32_t rotated(std::uint32_t x, unsigned bits) {
  return (x >> bits) | (x << (32U - bits));
}

// FIPS 180-4, 4.1.2.

constexpr std::uint32_t sum_0(std::uint32_t x) {
  return rotated(x, 2) ^ rotated(x, 13) ^ rotated(x, 22);
}
constexpr std::uint32_t sum_1(std::uint32_t x) {
  return rotated(x, 6) ^ rotated(x, 11) ^ rotated(x, 25);
}
constexpr std::uint32_t sigma_0(std::uint32_t x) {
  return rotated(x, 7) ^ rotated(x, 18) ^ (x >> 3U);
}
constexpr std::uint32_t sigma_1(std::uint32_t x) {
  return rotated(x, 17) ^ rotated(x, 19) ^ (x >> 10U);
}
constexpr std::uint32_t choice(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return z ^ (x & (y ^ z));
}
constexpr std::uint32_t majority(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return (x & y) | (z & (x | y));
}

}  // namespace

/// FIPS 180-4, 6.2.2, with the last sixteen words of the message schedule in place of all 64.
void Sha256::compress(std::span<const std::uint8_t, kBlockBytes> block) {
  std::array<std::uint32_t, 16> words{};
  for (std::size_t t = 0; t < words.size(); ++t) {
    words[t] = static_cast<std::uint32_t>(block[4 * t]) << 24U | static_cast<std::uint32_t>(block[4 * t + 1]) << 16U |
               static_cast<std::uint32_t>(block[4 * t + 2]) << 8U | static_cast<std::uint32_t>(block[4 * t + 3]);
  }
  std::uint32_t a = state_[0], b = state_[1], c = state_[2], d = state_[3];
  std::uint32_t e = state_[4], f = state_[5], g = state_[6], h = state_[7];
  for (std::size_t t = 0; t < kRounds; ++t) {
    std::uint32_t& word = words[t % 16];
    if (t >= 16) word += sigma_1(words[(t - 2) % 16]) + words[(t - 7) % 16] + sigma_0(words[(t - 15) % 16]);
    const std::uint32_t first = h + sum_1(e) + choice(e, f, g) + kConstants[t] + word;
    const std::uint32_t second = sum_0(a) + majority(a, b, c);
    h = g;
    g = f;
    f = e;
    e = d + first;
    d = c;
    c = b;
    b = a;
    a = first + second;
  }
  const std::array<std::uint32_t, 8> last{a, b, c, d, e, f, g, h};
  for (std::size_t k = 0; k < state_.size(); ++k) state_[k] += last[k];
}

void Sha256::add(std::span<const std::uint8_t> bytes) {
  const std::size_t held = bytes_ % kBlockBytes;
  bytes_ += bytes.size();
  if (held != 0) {
    const std::size_t count = std::min(bytes.size(), kBlockBytes - held);
    std::copy_n(bytes.begin(), count, block_.begin() + static_cast<std::ptrdiff_t>(held));
    bytes = bytes.subspan(count);
    if (held + count < kBlockBytes) return;
    compress(block_);
  }
  while (bytes.size() >= kBlockBytes) {
    compress(bytes.first<kBlockBytes>());
    bytes = bytes.subspan(kBlockBytes);
  }
  std::copy(bytes.begin(), bytes.end(), block_.begin());
}

/// FIPS 180-4, 5.1.1: a bit of one, zeros, and the number of bits in the last eight bytes of a block.
Sha256Digest Sha256::finish() {
  const std::size_t held = bytes_ % kBlockBytes;
  const auto end = block_.begin() + static_cast<std::ptrdiff_t>(held);
  *end = 0x80;
  std::fill(end + 1, block_.end(), std::uint8_t{0});
  if (held + 1 > kBlockBytes - kLengthBytes) {
    compress(block_);
    block_.fill(0);
  }
  write_big_endian(8 * bytes_, std::span<std::uint8_t>(block_), kBlockBytes - kLengthBytes);
  compress(block_);
  Sha256Digest digest{};
  for (std::size_t k = 0; k < state_.size(); ++k)
    write_big_endian(state_[k], std::span<std::uint8_t>(digest), sizeof(std::uint32_t) * k);
  return digest;
}

HmacSha256::HmacSha256(std::span<const std::uint8_t> key) {
  constexpr std::uint8_t kInnerPad = 0x36, kOuterPad = 0x5C;
  std::array<std::uint8_t, Sha256::kBlockBytes> block{};
  if (key.size() > block.size()) {
    Sha256 hash;
    hash.add(key);
    const Sha256Digest digest = hash.finish();
    std::copy(digest.begin(), digest.end(), block.begin());
  } else {
    std::copy(key.begin(), key.end(), block.begin());
  }
  for (std::uint8_t& byte : block) byte ^= kInnerPad;
  inner_.add(block);
  for (std::uint8_t& byte : block) byte ^= kInnerPad ^ kOuterPad;
  outer_.add(block);
}

Sha256Digest HmacSha256::code_of(std::span<const std::uint8_t> first, std::span<const std::uint8_t> second) const {
  Sha256 inner = inner_;
  inner.add(first);
  inner.add(second);
  Sha256 outer = outer_;
  outer.add(inner.finish());
  return outer.finish();
}

bool are_same(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
  if (a.size() != b.size()) return false;
  std::uint8_t difference = 0;
  for (std::size_t k = 0; k < a.size(); ++k) difference = static_cast<std::uint8_t>(difference | (a[k] ^ b[k]));
  return difference == 0;
}

}  // namespace vbar::fsw::packets
