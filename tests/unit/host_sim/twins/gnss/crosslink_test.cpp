#include "host_sim/twins/gnss/crosslink.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include <gtest/gtest.h>

namespace vbar::twins::gnss {
namespace {

constexpr fsw::GpsTime kStart{994'986'015'000'000'000};

CrosslinkSettings lossy() {
  CrosslinkSettings settings;
  settings.link.loss_probability = 0.2;
  settings.link.latency.minimum_s = 0.0;
  settings.link.latency.maximum_s = 5.0;
  return settings;
}

// 20 % loss and 0 to 5 s of delay over 5000 messages: shares within 4 sigma (0.023 and 0.09 s), none before it was
// sent, and some overtaken by later ones.
TEST(Crosslink, DelaysAndLoses) {
  Crosslink link(lossy(), 1, "target");
  constexpr int kMessages = 5000;
  int arrived = 0;
  int overtaken = 0;
  double delay_s = 0.0;
  fsw::GpsTime latest{};
  for (int k = 0; k < kMessages; ++k) {
    const fsw::GpsTime now = kStart + fsw::duration_of_seconds(k);
    const std::optional<fsw::GpsTime> arrival = link.send(now);
    if (!arrival) continue;
    EXPECT_GE(*arrival, now);
    EXPECT_LE(*arrival, now + fsw::duration_of_seconds(5));
    delay_s += seconds(*arrival - now);
    ++arrived;
    if (*arrival < latest) {
      ++overtaken;
    } else {
      latest = *arrival;
    }
  }
  EXPECT_NEAR(static_cast<double>(link.counters().lost) / kMessages, 0.2, 0.023);
  EXPECT_NEAR(delay_s / arrived, 2.5, 0.09);
  EXPECT_GT(overtaken, 0);
  EXPECT_EQ(static_cast<std::uint64_t>(arrived), link.counters().sent - link.counters().lost);
}

TEST(Crosslink, IsSilentWhenTold) {
  CrosslinkSettings settings;
  settings.silence_begin_s = 100.0;
  settings.silence_duration_s = 600.0;
  Crosslink link(settings, 1, "target");
  for (int t = 0; t < 1000; t += 10) {
    const bool arrives = link.send(kStart + fsw::duration_of_seconds(t)).has_value();
    EXPECT_EQ(arrives, t < 100 || t >= 700) << t;
  }
}

TEST(Crosslink, RefusesWithOneClearError) {
  const auto message = [](const CrosslinkSettings& settings) -> std::string {
    try {
      check(settings);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  CrosslinkSettings settings;
  settings.link.loss_probability = 1.5;
  EXPECT_EQ(message(settings), "loss_probability = 1.5: accepted is 0 to 1");
  settings = {};
  settings.silence_duration_s = -1.0;
  EXPECT_EQ(message(settings), "silence_duration_s = -1: accepted is 0 to 1e9");
  settings = {};
  settings.link.latency.maximum_s = 0.01;
  EXPECT_NE(message(settings).find("is not a valid distribution"), std::string::npos);
}

}  // namespace
}  // namespace vbar::twins::gnss
