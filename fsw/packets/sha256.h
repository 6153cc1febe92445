#pragma once
// SHA-256 (FIPS 180-4) and the message authentication code HMAC with it (FIPS 198-1).
//
// Time and memory accesses depend on the number of bytes only, not on their values.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace vbar::fsw::packets {

inline constexpr std::size_t kSha256Bytes = 32;
using Sha256Digest = std::array<std::uint8_t, kSha256Bytes>;

/// Hashes bytes that come in pieces of any size.
class Sha256 {
 public:
  static constexpr std::size_t kBlockBytes = 64;

  void add(std::span<const std::uint8_t> bytes);

  /// Returns the hash of all bytes so far, of which there may be 2^61; none may follow.
  Sha256Digest finish();

 private:
  void compress(std::span<const std::uint8_t, kBlockBytes> block);

  std::array<std::uint32_t, 8> state_{0x6A09E667U, 0xBB67AE85U, 0x3C6EF372U, 0xA54FF53AU,
                                      0x510E527FU, 0x9B05688CU, 0x1F83D9ABU, 0x5BE0CD19U};
  std::array<std::uint8_t, kBlockBytes> block_{};  ///< bytes that do not fill a block yet
  std::uint64_t bytes_ = 0;                        ///< all so far
};

/// Computes the codes of one key. It holds the two hashes that begin with the key in place of the key.
class HmacSha256 {
 public:
  explicit HmacSha256(std::span<const std::uint8_t> key);

  /// Returns the code of the bytes of `first`, followed by those of `second`.
  [[nodiscard]] Sha256Digest code_of(std::span<const std::uint8_t> first,
                                     std::span<const std::uint8_t> second = {}) const;

 private:
  Sha256 inner_, outer_;
};

/// Returns whether the bytes are the same, in a time that does not depend on where they differ. Those of another number
/// are not.
[[nodiscard]] bool are_same(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b);

}  // namespace vbar::fsw::packets
