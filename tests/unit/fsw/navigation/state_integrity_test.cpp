// A bit of the estimate changes between two steps: it is reported in the next one, and nothing else comes of it.

#include "fsw/navigation/state_integrity.h"

#include "tests/unit/fsw/gnc/bit_flips.h"
#include "tests/unit/fsw/gnc/small_world.h"

namespace vbar::fsw::navigation {

using namespace gnc::test;
namespace {

std::span<unsigned char> estimate_in(Article& article) {
  return bytes_of(state_of(article).measurements_.filter().estimate());
}

TEST(StateIntegrity, AFlippedBitOfTheEstimateIsReportedAndCorrectedInTheNextStep) {
  Flight flight = under_way();
  const Bytes measurement = packet_of(flight.now, flight.world.measurement());
  expect_flips_corrected(flight.article.save(), estimate_in, flight.now, kStep, {measurement});
}

TEST(StateIntegrity, DamageToEstimateAndCopyIsAColdStart) {
  Flight flight = under_way();
  Article article;
  article.restore(flight.article.save());
  const std::span<unsigned char> estimate = estimate_in(article);
  flip(estimate[1000], 3);
  // The copy lies somewhere behind: the first place with the same bytes as the first two means.
  const filter::RelativeNavigationFilter& filter = state_of(article).measurements_.filter();
  const std::span<unsigned char> behind =
      bytes_of(*(&filter + 1), sizeof(MeasurementScheduler) - sizeof(filter::RelativeNavigationFilter));
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

TEST(StateIntegrity, OfAFilterAndItsCopy) {
  const auto filter = std::make_unique<filter::RelativeNavigationFilter>();
  const auto integrity = std::make_unique<StateIntegrity>();
  EXPECT_EQ(integrity->verify(*filter), Integrity::kIntact) << "nothing is sealed yet";
  integrity->seal(*filter);
  EXPECT_EQ(integrity->verify(*filter), Integrity::kIntact);
  const std::span<unsigned char> own = bytes_of(*filter);
  flip(own.back(), 7);
  EXPECT_EQ(integrity->verify(*filter), Integrity::kRestored);
  EXPECT_EQ(integrity->verify(*filter), Integrity::kIntact);
  const std::span<unsigned char> copy = bytes_of(*integrity, sizeof *filter);
  flip(copy[4711], 0);
  EXPECT_EQ(integrity->verify(*filter), Integrity::kCopyDamaged);
  flip(own[4712], 0);
  EXPECT_EQ(integrity->verify(*filter), Integrity::kLost);
}

}  // namespace
}  // namespace vbar::fsw::navigation
