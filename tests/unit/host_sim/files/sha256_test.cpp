#include "host_sim/files/sha256.h"

#include <fstream>

#include <gtest/gtest.h>

namespace vbar::files {
namespace {

// FIPS 180-4, examples of one block and of none.
constexpr const char* kOfAbc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
constexpr const char* kOfNothing = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";

TEST(Sha256, AgreesWithTheStandardsExamples) {
  EXPECT_EQ(sha256_of("abc"), kOfAbc);
  EXPECT_EQ(sha256_of(""), kOfNothing);
  Sha256 parts;
  parts.add(std::string_view("a"));
  static_cast<void>(parts.hexadecimal());
  parts.add(std::string_view("bc"));
  EXPECT_EQ(parts.hexadecimal(), kOfAbc);
}

TEST(Sha256, OfAFile) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "vbar_sha256_test";
  std::ofstream(file) << "abc";
  EXPECT_EQ(sha256_of_file(file), kOfAbc);
  std::filesystem::remove(file);
  EXPECT_FALSE(sha256_of_file(file));
  EXPECT_FALSE(sha256_of_file(testing::TempDir()));
}

}  // namespace
}  // namespace vbar::files
