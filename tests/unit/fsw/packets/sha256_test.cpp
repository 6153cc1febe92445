// SHA-256 and HMAC against published vectors and against OpenSSL.

#include "fsw/packets/sha256.h"

#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

namespace vbar::fsw::packets {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::string hex(std::span<const std::uint8_t> bytes) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 0xFU];
  }
  return text;
}

Bytes bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

std::string sha256(const Bytes& bytes) {
  Sha256 hash;
  hash.add(bytes);
  return hex(hash.finish());
}

std::string hmac(const Bytes& key, const Bytes& data) {
  return hex(HmacSha256(key).code_of(data));
}

std::string openssl_sha256(const Bytes& bytes) {
  Bytes digest(32);
  EXPECT_EQ(EVP_Digest(bytes.data(), bytes.size(), digest.data(), nullptr, EVP_sha256(), nullptr), 1);
  return hex(digest);
}

std::string openssl_hmac(const Bytes& key, const Bytes& data) {
  Bytes digest(32);
  unsigned size = 0;
  EXPECT_NE(
      HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()), data.data(), data.size(), digest.data(), &size),
      nullptr);
  EXPECT_EQ(size, 32U);
  return hex(digest);
}

Bytes random_bytes(std::mt19937& random, std::size_t size) {
  Bytes bytes(size);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

// NIST, examples with intermediate values for FIPS 180-4; the last is of a million letters.
TEST(Sha256, IsThatOfTheStandardsExamples) {
  EXPECT_EQ(sha256({}), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256(bytes_of("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256(bytes_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256(Bytes(1'000'000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

// Every position of the end within a block, twice over, and pieces that end anywhere.
TEST(Sha256, IsThatOfOpenSslForAllLengthsAndPieces) {
  std::mt19937 random(1);
  for (std::size_t size = 0; size <= 300; ++size) {
    const Bytes bytes = random_bytes(random, size);
    const std::string expected = openssl_sha256(bytes);
    ASSERT_EQ(sha256(bytes), expected) << size;
    Sha256 hash;
    for (std::span<const std::uint8_t> rest = bytes; !rest.empty();) {
      const std::size_t count = std::min<std::size_t>(1 + random() % 100, rest.size());
      hash.add(rest.first(count));
      rest = rest.subspan(count);
    }
    ASSERT_EQ(hex(hash.finish()), expected) << size << " in pieces";
  }
}

// RFC 4231, section 4; case 5 is that of a code truncated to 128 bits.
TEST(HmacSha256, IsThatOfRfc4231) {
  EXPECT_EQ(hmac(Bytes(20, 0x0B), bytes_of("Hi There")),
            "b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7");
  EXPECT_EQ(hmac(bytes_of("Jefe"), bytes_of("what do ya want for nothing?")),
            "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
  EXPECT_EQ(hmac(Bytes(20, 0xAA), Bytes(50, 0xDD)), "773ea91e36800e46854db8ebd09181a72959098b3ef8c122d9635514ced565fe");
  Bytes counting(25);
  for (std::size_t k = 0; k < counting.size(); ++k) counting[k] = static_cast<std::uint8_t>(k + 1);
  EXPECT_EQ(hmac(counting, Bytes(50, 0xCD)), "82558a389a443c0ea4cc819899f2083a85f0faa3e578f8077a2e3ff46729665b");
  EXPECT_EQ(hmac(Bytes(20, 0x0C), bytes_of("Test With Truncation")).substr(0, 32), "a3b6167473100ee06e0c796c2955552b");
  EXPECT_EQ(hmac(Bytes(131, 0xAA), bytes_of("Test Using Larger Than Block-Size Key - Hash Key First")),
            "60e431591ee0b67f0d8a26aacbf5b77f8e0bc6213728c5140546040f0ee37f54");
  EXPECT_EQ(hmac(Bytes(131, 0xAA), bytes_of("This is a test using a larger than block-size key and a larger than "
                                            "block-size data. The key needs to be hashed before being used by the "
                                            "HMAC algorithm.")),
            "9b09ffa71b942fcb27635fbcd5b0e944bfdc63644f0713938a7f51535c3a35e2");
}

TEST(HmacSha256, IsThatOfOpenSslForAllLengthsInOnePieceAndInTwo) {
  std::mt19937 random(2);
  for (std::size_t size = 0; size <= 300; ++size) {
    const Bytes key = random_bytes(random, 1 + random() % 100), data = random_bytes(random, size);
    const std::string expected = openssl_hmac(key, data);
    const HmacSha256 ours(key);
    ASSERT_EQ(hex(ours.code_of(data)), expected) << size;
    const std::size_t cut = size == 0 ? 0 : random() % size;
    ASSERT_EQ(hex(ours.code_of(std::span(data).first(cut), std::span(data).subspan(cut))), expected) << size;
  }
}

TEST(AreSame, FindsEachBitAndOtherSizes) {
  std::mt19937 random(3);
  const Bytes bytes = random_bytes(random, 16);
  EXPECT_TRUE(are_same(bytes, bytes));
  EXPECT_TRUE(are_same({}, {}));
  EXPECT_FALSE(are_same(bytes, std::span(bytes).first(15)));
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    Bytes other = bytes;
    other[bit / 8] = static_cast<std::uint8_t>(other[bit / 8] ^ (1U << bit % 8));
    EXPECT_FALSE(are_same(bytes, other)) << bit;
  }
}

}  // namespace
}  // namespace vbar::fsw::packets
