// The process of an emulated bench, its command line, and what it acknowledges of its faults.

#include "hil_drivers/bench_process/bench_process.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::bench_process {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path faults_file_with(const std::string& text) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "bench_process_faults.jsonl";
  std::ofstream(file) << text;
  return file;
}

TEST(BenchFaults, AreCountedByKind) {
  const auto counts = count_faults(faults_file_with(
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
}  // namespace vbar::bench_process
