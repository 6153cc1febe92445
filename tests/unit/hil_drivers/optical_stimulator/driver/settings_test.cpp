// [testbed.optical_stimulator] of a mission.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "hil_drivers/optical_stimulator/hardware/devices.h"
#include "hil_drivers/optical_stimulator/stimulator_run.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::optical_stimulator {

namespace {

using testing::HasSubstr;

OpticalStimulatorSettings read(const std::string& text) {
  const toml::table table = toml::parse(text);
  const auto settings = read_optical_stimulator(mission::TableReader(table, "m.toml"));
  return dynamic_cast<const OpticalStimulatorSettings&>(*settings);
}

std::string refusal(const std::string& text) {
  try {
    static_cast<void>(read(text));
  } catch (const mission::MissionError& error) {
    return error.what();
  }
  return "";
}

TEST(OpticalStimulatorSettings, ABenchNamesItsAddresses) {
  const auto settings = read("bench = \"vbar_os_bench x\"\ncalibration = \"{data}/c_{seed}.toml\"\nsettle_ms = 0");
  EXPECT_EQ(settings.camera_address, "");
  EXPECT_EQ(settings.settle.count(), 0);
  EXPECT_EQ(settings.retries, 3);
  const std::filesystem::path data = testing::TempDir();
  const std::filesystem::path calibration = data / ("c_" + std::to_string(::getpid()) + ".toml");
  std::ofstream(calibration) << "x = 1\n";
  EXPECT_EQ(calibration_file(settings, data, static_cast<std::uint64_t>(::getpid())), calibration);
  std::filesystem::remove(calibration);
}

TEST(OpticalStimulatorSettings, DefaultsAreThoseThatTheMissionStates) {
  const auto settings = read("camera = \"192.168.1.2\"\ndisplay = \":0\"\ncalibration = \"c.toml\"");
  EXPECT_EQ(settings.settle, std::chrono::milliseconds(35));
  EXPECT_EQ(settings.timeout, std::chrono::milliseconds(3000));
  EXPECT_EQ(settings.packet_size, 1400);
  EXPECT_FALSE(settings.packet_delay_us.has_value());
  EXPECT_FALSE(settings.any_exposure);
  EXPECT_EQ(settings.white_electrons, 12000.0);
}

TEST(OpticalStimulatorSettings, WithoutABenchAddressesAreRequired) {
  EXPECT_THAT(refusal("calibration = \"c.toml\"\ndisplay = \":0\""), HasSubstr("camera"));
  EXPECT_THAT(refusal("calibration = \"c.toml\"\ncamera = \"1.2.3.4\""), HasSubstr("display"));
  EXPECT_THAT(refusal("bench = \"b\""), HasSubstr("calibration"));
}

TEST(OpticalStimulatorSettings, OthersAreRefused) {
  const std::string good = "bench = \"b\"\ncalibration = \"c\"\n";
  EXPECT_EQ(refusal(good), "");
  for (const char* const line : {"settle_ms = -1", "settle_ms = nan", "retries = 99", "packet_size = 100",
                                 "strip_electrons = inf", "unknown = 1", "any_exposure = 1"})
    EXPECT_NE(refusal(good + line), "") << line;
}

}  // namespace

// addresses.json of an optical bench.

namespace {

std::filesystem::path file_with(const std::string& text) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "optical_addresses.json";
  std::ofstream(file) << text;
  return file;
}

TEST(OpticalAddresses, AreRead) {
  const TestbedAddresses addresses = read_addresses(
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
