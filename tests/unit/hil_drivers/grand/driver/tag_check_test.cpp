// A receiver's time against the run's: rollover of the week number (IS-GPS-200, 20.3.3.3.1.1: ten bits), scenarios
// started at another time.

#include "hil_drivers/grand/tag_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::grand {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::int64_t kWeek_s = 604'800;
constexpr fsw::GpsTime kTagEpoch{fsw::duration_of_seconds(1658 * kWeek_s + 345'679).ns};
constexpr fsw::Duration kLatency{300'000'000};
constexpr fsw::Duration kMaxLatency{950'000'000};

std::string refusal(fsw::GpsTime tag, bool accepts_week_shift = false, fsw::Duration latency = kLatency,
                    fsw::Duration max_latency = kMaxLatency) {
  TagCheck check("receiver of servicer on /dev/ttyUSB0", accepts_week_shift, max_latency);
  try {
    check.check(tag, kTagEpoch + latency);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(TagCheck, AcceptsTheTimeOfTheRun) {
  EXPECT_EQ(refusal(kTagEpoch), "");
  EXPECT_EQ(refusal(kTagEpoch, false, fsw::Duration{0}), "");
  EXPECT_EQ(refusal(kTagEpoch, false, fsw::Duration{900'000'000}), "");
}

TEST(TagCheck, ASlowReceiverMayHaveALargerLatency) {
  constexpr fsw::Duration kSlow{1'950'000'000};
  EXPECT_THAT(refusal(kTagEpoch, false, fsw::Duration{1'000'000'000}), HasSubstr("sensors.gnss.max_latency_s"));
  EXPECT_EQ(refusal(kTagEpoch, false, fsw::Duration{1'000'000'000}, kSlow), "");
  EXPECT_EQ(refusal(kTagEpoch, false, kSlow, kSlow), "");
  EXPECT_THAT(refusal(kTagEpoch, false, fsw::Duration{1'951'000'000}, kSlow), HasSubstr("-0.05 to 1.95 s"));
  EXPECT_THAT(refusal(kTagEpoch + fsw::duration_of_seconds(1), false, kLatency, kSlow), HasSubstr("start time"));
}

TEST(TagCheck, RefusesARolloverUnlessItMayBeShifted) {
  for (const int cycles : {-1, 1, 2}) {
    const fsw::GpsTime tag = kTagEpoch + fsw::duration_of_seconds(cycles * 1024 * kWeek_s);
    EXPECT_THAT(refusal(tag), AllOf(HasSubstr("receiver of servicer on /dev/ttyUSB0"), HasSubstr("week_shift"),
                                    HasSubstr(std::to_string(-1024 * cycles) + " weeks")));
    TagCheck check("receiver", true, kMaxLatency);
    check.check(tag, kTagEpoch + kLatency);
    EXPECT_EQ(check.weeks(), -1024 * cycles);
  }
}

TEST(TagCheck, RefusesAScenarioOffByASecond) {
  for (const std::int64_t s : {-1, 1, 15, -604800}) {
    EXPECT_THAT(refusal(kTagEpoch + fsw::duration_of_seconds(s)), HasSubstr("start time of the scenario")) << s;
    EXPECT_THAT(refusal(kTagEpoch + fsw::duration_of_seconds(s + 1024 * kWeek_s), true), HasSubstr("start time")) << s;
  }
}

TEST(TagCheck, LaterAcceptsASlowLineButNoOtherWeek) {
  TagCheck check("receiver", true, kMaxLatency);
  check.check(kTagEpoch, kTagEpoch + kLatency);
  check.check(kTagEpoch, kTagEpoch + fsw::duration_of_seconds(3));
  EXPECT_EQ(check.weeks(), 0);
  EXPECT_THROW(check.check(kTagEpoch + fsw::duration_of_seconds(1024 * kWeek_s), kTagEpoch + kLatency),
               std::runtime_error);
}

}  // namespace
}  // namespace vbar::grand
