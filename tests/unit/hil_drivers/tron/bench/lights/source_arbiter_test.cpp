// Rules of E1.31-2018 for several sources.

#include "hil_drivers/tron/bench/lights/source_arbiter.h"

#include <gtest/gtest.h>

namespace vbar::tron::bench {
namespace {

sacn::DataPacket packet(std::uint8_t source, std::uint8_t sequence, std::uint8_t level, std::uint8_t priority = 100) {
  sacn::DataPacket packet;
  packet.cid[0] = source;
  packet.sequence = sequence;
  packet.priority = priority;
  packet.slots = {level};
  return packet;
}

int level(const SourceArbiter& arbiter) {
  return arbiter.is_controlled() ? arbiter.slots()[0] : -1;
}

TEST(SourceArbiter, HighestPriorityControlsAndIsFollowedByTheNext) {
  SourceArbiter arbiter(1);
  EXPECT_EQ(level(arbiter), -1);
  arbiter.accept(packet(1, 0, 10), 0.0);
  EXPECT_EQ(level(arbiter), 10);
  arbiter.accept(packet(2, 0, 20, 101), 0.1);
  EXPECT_EQ(level(arbiter), 20);
  arbiter.accept(packet(1, 1, 11), 0.2);
  EXPECT_EQ(level(arbiter), 20);
  auto end = packet(2, 1, 0, 101);
  end.is_terminated = true;
  for (int k = 0; k < 3; ++k, ++end.sequence) arbiter.accept(end, 0.3);
  EXPECT_EQ(level(arbiter), 11);
  EXPECT_EQ(arbiter.counts().terminations, 1U);
}

TEST(SourceArbiter, OfEqualPrioritiesTheFirstControls) {
  SourceArbiter arbiter(1);
  arbiter.accept(packet(9, 0, 10), 0.0);
  arbiter.accept(packet(2, 0, 20), 0.0);
  EXPECT_EQ(level(arbiter), 10);
}

// E1.31 6.7.2: discarded if the difference of the sequence numbers is in (-20, 0].
TEST(SourceArbiter, DiscardsPacketsOutOfSequence) {
  SourceArbiter arbiter(1);
  arbiter.accept(packet(1, 5, 50), 0.0);
  for (const int behind : {0, 1, 6, 19}) {
    arbiter.accept(packet(1, static_cast<std::uint8_t>(5 - behind), 1), 0.0);
    EXPECT_EQ(level(arbiter), 50) << behind;
  }
  EXPECT_EQ(arbiter.counts().out_of_sequence, 4U);
  arbiter.accept(packet(1, static_cast<std::uint8_t>(5 - 20), 51), 0.0);  // the source was started again
  EXPECT_EQ(level(arbiter), 51);
  arbiter.accept(packet(1, 255, 52), 0.0);
  arbiter.accept(packet(1, 0, 53), 0.0);
  EXPECT_EQ(level(arbiter), 53);
}

// E1.31 6.7.1: 2.5 s.
TEST(SourceArbiter, ForgetsASourceThatIsSilent) {
  SourceArbiter arbiter(1);
  arbiter.accept(packet(1, 0, 10), 1.0);
  arbiter.advance(3.5);
  EXPECT_EQ(level(arbiter), 10);
  arbiter.advance(3.504);
  EXPECT_EQ(level(arbiter), -1);
  EXPECT_EQ(arbiter.counts().losses, 1U);
  arbiter.accept(packet(1, 0, 12), 4.0);  // its sequence begins again
  EXPECT_EQ(level(arbiter), 12);
}

TEST(SourceArbiter, CountsWhatIsNotForTheLights) {
  SourceArbiter arbiter(1);
  auto other = packet(1, 0, 10);
  other.universe = 2;
  arbiter.accept(other, 0.0);
  other.universe = 1;
  other.is_preview = true;
  arbiter.accept(other, 0.0);
  other.is_preview = false;
  other.start_code = 0xDD;  // priority of each slot, of a manufacturer
  arbiter.accept(other, 0.0);
  EXPECT_FALSE(arbiter.is_controlled());
  EXPECT_EQ(arbiter.counts().of_other_universes, 1U);
  EXPECT_EQ(arbiter.counts().previews, 1U);
  EXPECT_EQ(arbiter.counts().of_other_start_codes, 1U);
}

TEST(SourceArbiter, HasRoomForALimitedNumberOfSources) {
  SourceArbiter arbiter(1);
  for (int source = 0; source < 200; ++source) arbiter.accept(packet(static_cast<std::uint8_t>(source), 0, 1), 0.0);
  EXPECT_EQ(arbiter.counts().accepted, SourceArbiter::kMaxSources);
  EXPECT_EQ(arbiter.counts().refused_sources, 200U - SourceArbiter::kMaxSources);
}

}  // namespace
}  // namespace vbar::tron::bench
