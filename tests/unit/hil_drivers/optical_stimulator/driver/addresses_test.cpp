// addresses.json of an optical bench.

#include "hil_drivers/optical_stimulator/addresses.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::optical_stimulator {
namespace {

std::filesystem::path file_with(const std::string& text) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "optical_addresses.json";
  std::ofstream(file) << text;
  return file;
}

TEST(OpticalAddresses, AreRead) {
  const BenchAddresses addresses = read_addresses(
      file_with(R"({"display":":7","camera":"127.0.13.1","rails":{"pty":"/tmp/rails","tcp":"127.0.0.1:4000"}})"));
  EXPECT_EQ(addresses.display, ":7");
  EXPECT_EQ(addresses.camera, "127.0.13.1");
  EXPECT_EQ(addresses.rails, "/tmp/rails");
}

TEST(OpticalAddresses, OfAnotherFormAreRefusedByName) {
  for (const char* const text :
       {"", "{", "[]", R"({"display":":7"})", R"({"display":7,"camera":"a","rails":{"pty":"b"}})",
        R"({"display":":7","camera":"a","rails":"b"})"}) {
    try {
      static_cast<void>(read_addresses(file_with(text)));
      ADD_FAILURE() << text;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr("optical_addresses.json")) << text;
    }
  }
}

}  // namespace
}  // namespace vbar::optical_stimulator
