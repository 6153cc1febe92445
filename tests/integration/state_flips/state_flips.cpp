// vbar_state_flips SNAPSHOT...: bits of the estimate of a flown mission change between two steps.
//
// SNAPSHOT is a file of `vbar replay RUN --save SNAPSHOT --at-h H`. The flight software continues from it; then one bit
// at a random location of its trunk (mean, covariance, reference attitude, own orbit, states of sources) changes before
// a step: 100 times, each time from the same state. The step must report the change and, but for that report, give
// the same answer as without it.

#include <cstdio>
#include <fstream>
#include <iterator>
#include <random>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "fsw/gnc/gnc.h"
#include "fsw/gnc/state_integrity.h"
#include "tests/unit/fsw/gnc/article.h"
#include "tests/unit/fsw/gnc/small_world.h"

namespace vbar::fsw::gnc::test {
namespace {

std::vector<std::string> snapshot_files;

constexpr Duration kPeriod = duration_of_seconds(5);
constexpr int kFlips = 100;

const GncState& state_of(Article& article) {
  return *static_cast<const GncState*>(static_cast<const void*>(article.memory()));
}

std::span<unsigned char> trunk_in(Article& article) {
  const trunk::Trunk& trunk = state_of(article).navigation_.trunk().trunk();
  return {const_cast<unsigned char*>(static_cast<const unsigned char*>(static_cast<const void*>(&trunk))),
          sizeof trunk};
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
    Article article;
    article.restore(before.memory);
    const Answer reference = article.step(before.now + kPeriod, kPeriod);
    ASSERT_EQ(reference.health.faults_present & telemetry_health::kFaultState, 0);
    std::mt19937 random(20260101);
    std::uniform_int_distribution<std::size_t> place(0, trunk_in(article).size() - 1);
    std::uniform_int_distribution<int> bit(0, 7);
    for (int k = 0; k < kFlips; ++k) {
      article.restore(before.memory);
      const std::size_t at_byte = place(random);
      unsigned char& byte = trunk_in(article)[at_byte];
      byte = static_cast<unsigned char>(byte ^ (1U << static_cast<unsigned>(bit(random))));
      const Answer answer = article.step(before.now + kPeriod, kPeriod);
      ASSERT_NE(answer.health.faults_present & telemetry_health::kFaultState, 0) << file << ", byte " << at_byte;
      ASSERT_EQ(answer.events.size(), reference.events.size() + 1) << file << ", byte " << at_byte;
      ASSERT_EQ(without_health(answer.packets), without_health(reference.packets)) << file << ", byte " << at_byte;
    }
    std::printf("%s: %d flips among %zu bytes, each reported and corrected in the next step\n", file.c_str(), kFlips,
                trunk_in(article).size());
  }
}

}  // namespace
}  // namespace vbar::fsw::gnc::test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  vbar::fsw::gnc::test::snapshot_files.assign(argv + 1, argv + argc);
  return RUN_ALL_TESTS();
}
