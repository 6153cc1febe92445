// The process of an emulated bench, its command line, and what it acknowledges of its faults.

#include "hil_drivers/common/emulator_process.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace vbar::testbeds {
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

class BenchCalibrationFile : public ::testing::Test {
 protected:
  BenchCalibrationFile() {
    std::filesystem::create_directories(data_ / "calibrations");
    std::ofstream(data_ / "calibrations/bench_1.toml") << "x = 1\n";
  }
  ~BenchCalibrationFile() override { std::filesystem::remove_all(data_); }

  [[nodiscard]] std::filesystem::path file(const std::string& path, std::uint64_t seed) const {
    return find_calibration_file(
        path, data_, seed, {"testbed.bench", "calibrate --seed {N} --out {out} --bench \"b {seed}\"", "a minute"});
  }

  std::filesystem::path data_ =
      std::filesystem::path(::testing::TempDir()) / ("bench_calibration_" + std::to_string(::getpid()));
};

TEST_F(BenchCalibrationFile, IsHereOrInTheDataFolder) {
  EXPECT_EQ(file("calibrations/bench_{seed}.toml", 1), data_ / "calibrations/bench_1.toml");
  EXPECT_EQ(file("{data}/calibrations/bench_{seed}.toml", 1), data_ / "calibrations/bench_1.toml");
  const auto own = data_ / "own_7.toml";
  std::ofstream(own) << "x = 2\n";
  EXPECT_EQ(file((data_ / "own_{seed}.toml").string(), 7), own);
}

TEST_F(BenchCalibrationFile, IsRefusedWithTheCommandThatMakesIt) {
  try {
    static_cast<void>(file("calibrations/bench_{seed}.toml", 2));
    ADD_FAILURE() << "a file that is not there was found";
  } catch (const std::exception& error) {
    EXPECT_EQ(error.what(),
              "calibrations/bench_2.toml: testbed.bench.calibration: found no such file here, nor in " +
                  data_.string() +
                  "; accepted: a calibration of this bench, made in a minute by: calibrate --seed 2 --out "
                  "calibrations/bench_2.toml --bench \"b {seed}\"");
  }
}

TEST(BenchArguments, HaveTheirPlaceholdersReplaced) {
  EXPECT_THAT(emulator_arguments("/bin/bench {data}/a.toml --directory {directory}  --seed {seed}", "/tmp/with space",
                                 7, "/data"),
              ElementsAre("/bin/bench", "/data/a.toml", "--directory", "/tmp/with space", "--seed", "7"));
  EXPECT_THROW(static_cast<void>(emulator_arguments("  ", "/tmp", 1, "/data")), std::runtime_error);
}

TEST(EmulatorProcess, NamesTheProgramThatDoesNotStart) {
  try {
    EmulatorProcess bench("no_such_bench_program {directory}", 1, "/tmp");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no_such_bench_program"));
  }
}

TEST(EmulatorProcess, ReportsTheEndOfTheProgramAndItsLastLine) {
  try {
    EmulatorProcess bench("/bin/cat /no/such/file", 1, "/tmp");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("/bin/cat has ended: exit status 1"), HasSubstr("No such file")));
  }
}

}  // namespace
}  // namespace vbar::testbeds
