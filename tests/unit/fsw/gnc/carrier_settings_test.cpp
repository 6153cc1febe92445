#include "fsw/sources/carrier_pair/carrier_settings.h"

#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/fsw/gnc/configurations.h"

namespace vbar::fsw::sources {
namespace {

using gnc::test::carrier;
using gnc::test::receiver;

TEST(CarrierSettings, AreThoseOfTheMessages) {
  const auto settings = carrier_settings(carrier(), receiver());
  ASSERT_TRUE(settings.ok());
  EXPECT_EQ(settings.value().filter.antenna_offset_sigma_m, 3.2e-3);
  EXPECT_EQ(settings.value().filter.phase_centre_jitter_m, 1e-3);
  EXPECT_EQ(settings.value().ambiguities.min_ratio, 3.0);
  EXPECT_EQ(settings.value().servicer_antenna_body_m.y(), -0.3);
  EXPECT_EQ(settings.value().target_antenna_body_m.z(), 0.1);
  const estimation::GaussMarkov wander = phase_wander_of(carrier());
  EXPECT_DOUBLE_EQ(wander.sigma, std::sqrt(2.0) * 0.5e-3);  // of a difference of two channels
  EXPECT_EQ(wander.time_s, 60.0);
}

TEST(CarrierSettings, WithoutWanderItsTimeMayBeZero) {
  carrier_configuration c = carrier();
  c.phase_wander_sigma_m = c.phase_wander_time_s = 0.0;
  EXPECT_TRUE(carrier_settings(c, receiver()).ok());
  EXPECT_EQ(phase_wander_of(c).sigma, 0.0);
  EXPECT_GT(phase_wander_of(c).time_s, 0.0);
}

TEST(CarrierSettings, InvalidFieldsAreRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  using Spoil = std::function<void(carrier_configuration&)>;
  const std::vector<std::pair<const char*, Spoil>> spoils = {
      {"a ratio below one", [](auto& c) { c.min_ratio = 0.5; }},
      {"no wait", [](auto& c) { c.pair_wait_ns = 0; }},
      {"no jitter", [](auto& c) { c.phase_centre_jitter_m = 0.0; }},
      {"an antenna 200 m out", [](auto& c) { c.target_antenna_body_m[0] = 200.0; }},
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
    carrier_configuration c = carrier();
    spoil(c);
    EXPECT_EQ(carrier_settings(c, receiver()).status(), Status::kOutOfRange) << what;
  }
  receiver_configuration far = receiver();
  far.antenna_body_m[2] = 200.0;
  EXPECT_EQ(carrier_settings(carrier(), far).status(), Status::kOutOfRange);
}

}  // namespace
}  // namespace vbar::fsw::sources
