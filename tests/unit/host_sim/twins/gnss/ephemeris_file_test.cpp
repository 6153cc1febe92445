#include "host_sim/twins/gnss/ephemeris_file.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace vbar::twins::gnss {
namespace {

constexpr const char* kColumns =
    "satellite,week,toe_s,toc_s,sqrt_a,e,m0,delta_n,omega0,omega_dot,i0,i_dot,omega,cuc,cus,cic,cis,crc,crs,af0,af1,"
    "af2,group_delay_s\n";
constexpr const char* kNumbers =
    "1658,388800,388784,5153.66,0.0004,1,2,3,4,5,6,7,8,9,10,11,12,13,1e-4,1e-6,1e-12,5e-9\n";

// A file of one test process, removed at its end.
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& text)
      : path_(std::filesystem::temp_directory_path() / fmt::format("vbar_ephemerides_{}.csv", ::getpid())) {
    std::ofstream(path_) << text;
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile() { std::filesystem::remove(path_); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::string refusal(const std::string& text) {
  const ScratchFile file(text);
  try {
    read_ephemeris_file(file.path());
  } catch (const std::runtime_error& error) {
    const std::string message = error.what();
    const std::string name = file.path().string();
    return message.starts_with(name) ? message.substr(name.size()) : message;
  }
  return "accepted";
}

// The clock's reference time is moved to toe, 16 s after toc: af0 + 16 af1 + 256 af2.
TEST(EphemerisFile, ReadsNumbersIntoTheirPlaces) {
  const ScratchFile file(std::string("# a comment\nutc_a0_a1,1e-9,2e-15\n") + kColumns + "E07," + kNumbers);
  const EphemerisFile read = read_ephemeris_file(file.path());
  ASSERT_EQ(read.satellites.size(), 1U);
  const Ephemeris& set = read.satellites.front();
  EXPECT_EQ(set.satellite, (SatelliteId{System::kGalileo, 7}));
  EXPECT_EQ(set.toe.ns, (1658 * 604800LL + 388800) * 1'000'000'000LL);
  EXPECT_EQ(set.m0, 1.0);
  EXPECT_EQ(set.omega, 7.0);
  EXPECT_EQ(set.crs, 13.0);
  EXPECT_NEAR(set.af0, 1e-4 + 16e-6 + 256e-12, 1e-18);
  EXPECT_NEAR(set.af1, 1e-6 + 32e-12, 1e-18);
  EXPECT_EQ(set.group_delay_s, 5e-9);
  EXPECT_EQ(read.corrections.utc_a1, 2e-15);
}

// A group delay of 5e-9 s cut to 5 s is a number too.
TEST(EphemerisFile, ALastNumberThatIsCutShortIsRefused) {
  const std::string text = std::string(kColumns) + "E07," + kNumbers;
  EXPECT_EQ(refusal(text), "accepted");
  for (const std::size_t cut : {1U, 4U})
    EXPECT_EQ(refusal(text.substr(0, text.size() - cut)),
              ":2: found a last row without a line feed, expected one: its last number may be cut short");
}

TEST(EphemerisFile, RefusesWithLineAndReason) {
  const std::string head = kColumns;
  EXPECT_EQ(refusal(""), ": holds no satellite");
  EXPECT_EQ(refusal(head + "X05," + kNumbers),
            ":2: \"X05\" is not a satellite; accepted are G, E or C and a number from 01 to 63");
  EXPECT_EQ(refusal(head + "G05,1658,12\n"), ":2: 2 numbers instead of 22");
  EXPECT_EQ(refusal(head + "G05,nan," + kNumbers), ":2: \"nan\" is not a number");
  EXPECT_EQ(refusal(head + "G05,1," + kNumbers), ":2: more than 22 numbers");
  EXPECT_EQ(refusal("klobuchar_alpha,1,2\n" + head), ":1: klobuchar_alpha needs 4 numbers");
  std::string flat = kNumbers;
  flat.replace(flat.find("0.0004"), 6, "0.9");
  EXPECT_EQ(refusal(head + "G05," + flat), ":2: an eccentricity of 0.9 does not lie between 0 and 0.2");
  EXPECT_THROW(read_ephemeris_file("/nonexistent"), std::runtime_error);
}

}  // namespace
}  // namespace vbar::twins::gnss
