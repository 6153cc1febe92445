#include "fsw/gnc/gnss_configuration.h"

#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/fsw/gnc/configurations.h"

namespace vbar::fsw::gnc {
namespace {

navigation_configuration good() {
  return test::navigation(navigation_configuration::kSourceGnss);
}

TEST(GnssConfiguration, ReachesTheFilter) {
  const auto settings = carrier_settings(good());
  ASSERT_TRUE(settings.ok());
  const sources::CarrierSettings& carrier = settings.value().carrier;
  EXPECT_EQ(carrier.filter.antenna_offset_sigma_m, 3.2e-3);
  EXPECT_EQ(carrier.filter.phase_centre_jitter_m, 1e-3);
  EXPECT_EQ(carrier.ambiguities.min_ratio, 3.0);
  const trunk::TrunkSettings& blocks = settings.value().blocks;
  EXPECT_DOUBLE_EQ(blocks.phase_wander.sigma, std::sqrt(2.0) * 0.5e-3);  // of a difference of two channels
  EXPECT_EQ(blocks.phase_wander.time_s, 60.0);
  EXPECT_EQ(blocks.relative_orbit.empirical.time_s, 1500.0);
  EXPECT_EQ(settings.value().pair_wait.ns, 12'000'000'000);
}

TEST(GnssConfiguration, WithoutWanderItsTimeMayBeZero) {
  navigation_configuration c = good();
  c.phase_wander_sigma_m = c.phase_wander_time_s = 0.0;
  EXPECT_TRUE(carrier_settings(c).ok());
}

TEST(GnssConfiguration, InvalidFieldsAreRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  using Spoil = std::function<void(navigation_configuration&)>;
  const std::vector<std::pair<const char*, Spoil>> spoils = {
      {"a source that does not exist", [](auto& c) { c.source = 4; }},
      {"a ratio below one", [](auto& c) { c.min_ratio = 0.5; }},
      {"no jitter", [](auto& c) { c.phase_centre_jitter_m = 0.0; }},
      {"a negative wander", [](auto& c) { c.phase_wander_sigma_m = -1e-3; }},
      {"a wander of metres", [](auto& c) { c.phase_wander_sigma_m = 2.0; }},
      {"a wander that is not a number", [](auto& c) { c.phase_wander_sigma_m = kNan; }},
      {"a wander without a time", [](auto& c) { c.phase_wander_time_s = 0.0; }},
      {"a negative time", [](auto& c) { c.phase_wander_time_s = -60.0; }},
      {"an infinite time", [](auto& c) { c.phase_wander_time_s = kInfinity; }},
      {"a time that is not a number", [](auto& c) { c.phase_wander_time_s = kNan; }},
      {"a time that is not a number, without wander",
       [](auto& c) {
         c.phase_wander_sigma_m = 0.0;
         c.phase_wander_time_s = kNan;
       }},
  };
  for (const auto& [what, spoil] : spoils) {
    navigation_configuration c = good();
    spoil(c);
    EXPECT_EQ(carrier_settings(c).status(), Status::kOutOfRange) << what;
  }
}

}  // namespace
}  // namespace vbar::fsw::gnc
