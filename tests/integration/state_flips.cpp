// vbar_state_flips SNAPSHOT...: bits of the estimate of a flown mission change between two steps.
//
// SNAPSHOT is a file of `vbar replay RUN --save SNAPSHOT --at-h H`. The flight software continues from it; then one bit
// at a random location of its filter (mean, covariance, reference attitude, own orbit, states of sources) changes
// before a step: 100 times, each time from the same state. The step must report the change and, but for that report,
// give the same answer as without it.

#include <cstdio>
#include <fstream>
#include <iterator>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "tests/unit/fsw/gnc/bit_flips.h"

namespace vbar::fsw::gnc::test {
namespace {

std::vector<std::string> snapshot_files;

constexpr Duration kPeriod = duration_of_seconds(5);

std::span<unsigned char> filter_in(Article& article) {
  return bytes_of(state_of(article).measurements_.filter());
}

/// The bytes behind the line of text at the beginning.
std::vector<std::uint8_t> snapshot_in(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  std::getline(in, line);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Continued {
  GpsTime now;
  std::vector<std::byte> memory;
};

/// A step after the snapshot, so that the report of the restart is over.
void continue_from(const std::string& file, Continued& continued) {
  Article article;
  ASSERT_EQ(article.restore_snapshot(snapshot_in(file)), 0) << file << ": of other flight software, or damaged";
  const GpsTime now = state_of(article).now_ + kPeriod;
  const Answer answer = article.step(now, kPeriod);
  ASSERT_EQ(answer.status, 0) << file;
  ASSERT_EQ(answer.navigation.valid, 1) << file << ": nothing is estimated at this time";
  continued = {now, article.save()};
}

TEST(StateFlips, AreReportedAndCorrectedInTheNextStep) {
  ASSERT_FALSE(snapshot_files.empty()) << "name a snapshot";
  for (const std::string& file : snapshot_files) {
    Continued before;
    ASSERT_NO_FATAL_FAILURE(continue_from(file, before));
    ASSERT_NO_FATAL_FAILURE(expect_flips_corrected(before.memory, filter_in, before.now + kPeriod, kPeriod, {}))
        << file;
    std::printf("%s: %d flips among %zu bytes, each reported and corrected in the next step\n", file.c_str(), kFlips,
                sizeof(filter::RelativeNavigationFilter));
  }
}

}  // namespace
}  // namespace vbar::fsw::gnc::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  vbar::fsw::gnc::test::snapshot_files.assign(argv + 1, argv + argc);
  return RUN_ALL_TESTS();
}
