// addresses.json of a bench.

#include "hil_drivers/grand/addresses.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::grand {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path file_with(const std::string& text) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "addresses.json";
  std::ofstream(file) << text;
  return file;
}

TEST(Addresses, AreRead) {
  const auto addresses = read_addresses(file_with(
      R"({"control_ports":[4820,4821],"pps":"/tmp/pps.sock","receivers":{"servicer":{"com1":"/tmp/a","com2":"/tmp/b"}}})"));
  EXPECT_THAT(addresses.control_ports, ElementsAre(4820, 4821));
  EXPECT_EQ(addresses.pps, "/tmp/pps.sock");
  EXPECT_EQ(addresses.receivers.at("servicer"), "/tmp/a");
}

TEST(Addresses, OfAnotherFormAreRefusedByName) {
  for (const char* const text :
       {"", "{", "[]", R"({"control_ports":[0],"receivers":{}})", R"({"control_ports":[1]})",
        R"({"control_ports":[99999],"receivers":{}})", R"({"control_ports":"x","receivers":{}})",
        R"({"control_ports":[1],"receivers":{"a":{"com2":"x"}}})"}) {
    try {
      static_cast<void>(read_addresses(file_with(text)));
      ADD_FAILURE() << text;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr("addresses.json")) << text;
    }
  }
}

}  // namespace
}  // namespace vbar::grand
