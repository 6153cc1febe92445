// addresses.json of a bench, and its command line.

#include "hil_drivers/grand/addresses.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/grand/bench_process.h"

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

TEST(Addresses, FaultsAreCountedByKind) {
  const auto counts = count_faults(file_with(
      "{\"kind\":\"rf_outage\",\"time_s\":1.0}\n{\"kind\":\"rf_outage\"}\n{\"kind\":\"bench_exit\"}\nbroken\n"));
  EXPECT_EQ(counts, (std::map<std::string, int>{{"rf_outage", 2}, {"bench_exit", 1}, {"unknown", 1}}));
  EXPECT_TRUE(count_faults("/no/such/file").empty());
}

TEST(BenchArguments, HaveTheirPlaceholdersReplaced) {
  EXPECT_THAT(
      bench_arguments("/bin/bench {data}/a.toml --directory {directory}  --seed {seed}", "/tmp/with space", 7, "/data"),
      ElementsAre("/bin/bench", "/data/a.toml", "--directory", "/tmp/with space", "--seed", "7"));
  EXPECT_THROW(static_cast<void>(bench_arguments("  ", "/tmp", 1, "/data")), std::runtime_error);
}

TEST(BenchProcess, NamesTheProgramThatDoesNotStart) {
  try {
    BenchProcess bench("no_such_bench_program {directory}", 1, "/tmp");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no_such_bench_program"));
  }
}

TEST(BenchProcess, ReportsTheEndOfTheProgramAndItsLastLine) {
  try {
    BenchProcess bench("/bin/cat /no/such/file", 1, "/tmp");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("/bin/cat has ended: exit status 1"), HasSubstr("No such file")));
  }
}

}  // namespace
}  // namespace vbar::grand
