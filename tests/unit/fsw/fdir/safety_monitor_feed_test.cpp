// What the guard is given of the own receiver: whether the spacecraft is in the shadow of the Earth.

#include <cmath>

#include <gtest/gtest.h>

#include "fsw/fdir/safety_monitor_inputs.h"
#include "fsw/orbit/sun.h"
#include "tests/unit/fsw/gnss/synthetic_receivers.h"

namespace vbar::fsw::fdir {

namespace {

using gnss::test::CooperatingPair;
using gnss::test::kEarth;

constexpr double kEarthRadius_m = 6378137.0;

struct OwnReceiver : CooperatingPair {
  OwnReceiver() : CooperatingPair(1) {
    for (const gnss::Ephemeris& ephemeris : satellites) EXPECT_EQ(store.put(ephemeris), Status::kOk);
  }
  gnss::EphemerisStore store;
};

// The Sun (right ascension 117 deg, declination 21 deg on that day) is 21.7 deg above the plane of this orbit. The half
// arc h in the shadow has cos h = sqrt(1 - (6378 km / 7087 km)^2) / cos(21.7 deg): 62 deg, 34.1 of 99 minutes.
TEST(SafetyMonitorInputs, ThePositionsOfTheOwnReceiverShowTheEclipse) {
  OwnReceiver own;
  int dark_min = 0;
  for (int minute = 0; minute < 99; ++minute) {
    const GpsTime tag = own.tag + duration_of_seconds(60 * minute);
    const auto lit = is_sunlit(own.servicer.observe(tag, own.satellites, kEarth), own.store, kEarth);
    ASSERT_TRUE(lit.ok()) << minute;
    const Vector3 position = own.servicer.state_at(tag).position_eci;
    const double from_antisun = std::acos(-position.normalized().dot(orbit::sun_position_gcrf(tag).normalized()));
    const double shadow_half_angle = std::asin(kEarthRadius_m / position.norm());
    const bool is_at_its_edge = std::abs(from_antisun - shadow_half_angle) < 1e-3;
    EXPECT_TRUE(is_at_its_edge || lit.value() == (from_antisun > shadow_half_angle)) << minute;
    dark_min += lit.value() ? 0 : 1;
  }
  EXPECT_NEAR(dark_min, 34.1, 1.0);
}

TEST(SafetyMonitorInputs, WithoutAPositionNothingIsKnownOfTheLight) {
  OwnReceiver own;
  gnss::ObservationEpoch epoch = own.servicer.observe(own.tag, own.satellites, kEarth);
  epoch.count = 4;  // two satellites
  EXPECT_FALSE(is_sunlit(epoch, own.store, kEarth).ok());
  EXPECT_FALSE(is_sunlit(own.servicer.observe(own.tag, own.satellites, kEarth), {}, kEarth).ok());
}

}  // namespace
}  // namespace vbar::fsw::fdir
