#include "host_sim/engine/cadence.h"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace vbar::engine {
namespace {

constexpr fsw::GpsTime at_second(std::int64_t s) {
  return fsw::GpsTime{1'000'000'000} + fsw::duration_of_seconds(s);
}
constexpr fsw::Duration every(std::int64_t s) {
  return fsw::duration_of_seconds(s);
}

TEST(Cadence, BeginsOnePeriodAfterItsFirstPart) {
  const Cadence cadence(at_second(0), every(60));
  EXPECT_EQ(cadence.next_after(at_second(-500)), at_second(60));
  EXPECT_EQ(cadence.next_after(at_second(59)), at_second(60));
  EXPECT_EQ(cadence.next_after(at_second(60)), at_second(120));
  EXPECT_EQ(cadence.next_at(at_second(60)), at_second(60));
}

TEST(Cadence, ThePeriodChangesAtTheTimeOfTheNextPart) {
  const Cadence cadence({{at_second(0), every(60)}, {at_second(150), every(20)}, {at_second(200), every(5)}});
  std::vector<fsw::GpsTime> epochs;
  for (fsw::GpsTime time = at_second(0); time < at_second(205); time = epochs.back())
    epochs.push_back(cadence.next_after(time));
  const std::vector<fsw::GpsTime> expected{at_second(60), at_second(120), at_second(170), at_second(190),
                                           at_second(205)};
  EXPECT_EQ(epochs, expected) << "an epoch beyond the next part would not be of its part";
  EXPECT_EQ(cadence.shortest_period(), every(5));
}

TEST(Cadence, TheBeginningOfAPartIsTheLastEpochBeforeIt) {
  const Cadence cadence({{at_second(0), every(60)}, {at_second(120), every(5)}});
  EXPECT_EQ(cadence.next_after(at_second(60)), at_second(120));
  EXPECT_EQ(cadence.next_after(at_second(120)), at_second(125));
}

TEST(Cadence, NumbersAreThoseOfCounting) {
  const Cadence cadence({{at_second(0), every(60)}, {at_second(150), every(20)}, {at_second(200), every(7)}});
  std::int64_t number = 0;
  for (fsw::GpsTime time = cadence.next_after(at_second(0)); time < at_second(400); time = cadence.next_after(time))
    EXPECT_EQ(cadence.number_of(time), number++) << time.ns;
  EXPECT_EQ(cadence.number_of(at_second(0)), 0);
}

TEST(Cadence, RefusesWhatHasNoOrder) {
  EXPECT_THROW(Cadence(std::vector<Cadence::Part>{}), std::invalid_argument);
  EXPECT_THROW(Cadence(at_second(0), every(0)), std::invalid_argument);
  EXPECT_THROW(Cadence({{at_second(0), every(1)}, {at_second(0), every(2)}}), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::engine
