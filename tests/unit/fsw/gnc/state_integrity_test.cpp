// A bit of the estimate changes between two steps: it is reported in the next one, and nothing else comes of it.

#include "fsw/gnc/state_integrity.h"

#include <random>

#include "fsw/gnc/gnc.h"
#include "tests/unit/fsw/gnc/small_world.h"

namespace vbar::fsw::gnc::test {
namespace {

std::span<unsigned char> bytes_of(const void* object, std::size_t size) {
  return {const_cast<unsigned char*>(static_cast<const unsigned char*>(object)), size};
}

/// The estimate within the memory of an article, whose state is its first base.
std::span<unsigned char> estimate_in(Article& article) {
  const auto* const state = static_cast<const GncState*>(static_cast<const void*>(article.memory()));
  const trunk::Estimate& estimate = state->navigation_.trunk().trunk().estimate();
  return bytes_of(&estimate, sizeof estimate);
}

void flip(unsigned char& byte, int bit) {
  byte = static_cast<unsigned char>(byte ^ (1U << static_cast<unsigned>(bit)));
}

TEST(StateIntegrity, AFlippedBitOfTheEstimateIsReportedAndCorrectedInTheNextStep) {
  Flight flight = under_way();
  const std::vector<std::byte> before = flight.article.save();
  const Bytes measurement = packet_of(flight.now, flight.world.measurement());
  Article undisturbed;
  undisturbed.restore(before);
  EXPECT_EQ(undisturbed.deliver(measurement), 0);
  const Answer reference = undisturbed.step(flight.now, kStep);
  EXPECT_EQ(reference.health.faults & telemetry_health::kFaultState, 0);

  std::mt19937 random(20260101);
  Article article;
  const std::span<unsigned char> estimate = estimate_in(article);
  std::uniform_int_distribution<std::size_t> place(0, estimate.size() - 1);
  std::uniform_int_distribution<int> bit(0, 7);
  for (int k = 0; k < 100; ++k) {
    article.restore(before);
    const std::size_t at_byte = place(random);
    flip(estimate[at_byte], bit(random));
    EXPECT_EQ(article.deliver(measurement), 0);
    const Answer answer = article.step(flight.now, kStep);
    ASSERT_NE(answer.health.faults_present & telemetry_health::kFaultState, 0) << "byte " << at_byte;
    ASSERT_EQ(answer.events.size(), 1U);
    EXPECT_EQ(answer.events[0].argument, static_cast<double>(Integrity::kRestored));
    ASSERT_EQ(without_health(answer.packets), without_health(reference.packets)) << "byte " << at_byte;
  }
}

TEST(StateIntegrity, DamageToEstimateAndCopyIsAColdStart) {
  Flight flight = under_way();
  Article article;
  article.restore(flight.article.save());
  const auto* const state = static_cast<const GncState*>(static_cast<const void*>(article.memory()));
  const std::span<unsigned char> estimate = estimate_in(article);
  flip(estimate[1000], 3);
  // The copy lies somewhere behind: the first place with the same bytes as the first two means.
  const trunk::Trunk& trunk = state->navigation_.trunk().trunk();
  const std::span<unsigned char> behind = bytes_of(&trunk + 1, sizeof(TrunkNavigation) - sizeof(trunk::Trunk));
  const auto copy = std::search(behind.begin(), behind.end(), estimate.begin(), estimate.begin() + 16);
  ASSERT_NE(copy, behind.end());
  flip(*copy, 0);
  const Answer answer = article.step(flight.now, kStep);
  EXPECT_EQ(answer.status, 0);
  EXPECT_NE(answer.health.faults_present & telemetry_health::kFaultState, 0);
  EXPECT_EQ(answer.navigation.valid, 0);
  EXPECT_TRUE(answer.commands.empty());
  EXPECT_EQ(answer.control.mode, 1) << "the telecommands are still in force";
  // It navigates again from the next measurement on.
  const GpsTime next = flight.now + kStep;
  flight.world.advance_to(next);
  EXPECT_EQ(article.deliver(next, flight.world.measurement()), 0);
  EXPECT_EQ(article.step(next, kStep).navigation.valid, 1);
}

TEST(StateIntegrity, OfATrunkAndItsCopy) {
  const auto trunk = std::make_unique<trunk::Trunk>();
  const auto integrity = std::make_unique<StateIntegrity>();
  EXPECT_EQ(integrity->verify(*trunk), Integrity::kIntact) << "nothing is sealed yet";
  integrity->seal(*trunk);
  EXPECT_EQ(integrity->verify(*trunk), Integrity::kIntact);
  const std::span<unsigned char> own = bytes_of(trunk.get(), sizeof *trunk);
  flip(own.back(), 7);
  EXPECT_EQ(integrity->verify(*trunk), Integrity::kRestored);
  EXPECT_EQ(integrity->verify(*trunk), Integrity::kIntact);
  const std::span<unsigned char> copy = bytes_of(integrity.get(), sizeof *trunk);
  flip(copy[4711], 0);
  EXPECT_EQ(integrity->verify(*trunk), Integrity::kCopyDamaged);
  flip(own[4712], 0);
  EXPECT_EQ(integrity->verify(*trunk), Integrity::kLost);
}

}  // namespace
}  // namespace vbar::fsw::gnc::test
