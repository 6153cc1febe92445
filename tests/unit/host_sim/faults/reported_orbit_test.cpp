// The a-priori orbit that a restarted flight computer is sent: that of its last telemetry, not that of the start.

#include "host_sim/faults/reported_orbit.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "fsw/orbit/roe.h"
#include "host_sim/twins/packet_encoder.h"

namespace vbar::faults {
namespace {

constexpr fsw::orbit::QnsElements kServicer{.a = 7e6, .ex = 1e-3, .ey = 0.0, .i = 1.7, .raan = 0.3, .u = 0.0};

fsw::GpsTime time_at(double s) {
  return fsw::GpsTime{} + fsw::nearest_duration(1000.0 + s);
}

telemetry_navigation navigation() {
  const auto state = fsw::orbit::cartesian_from_qns(kServicer).value();
  telemetry_navigation reported{};
  reported.valid = 1;
  for (int k = 0; k < 3; ++k) {
    reported.servicer_position_eci[k] = state.position_eci(k);
    reported.servicer_velocity_eci[k] = state.velocity_eci(k);
  }
  for (int k = 0; k < 6; ++k) reported.a_roe_mean_m[k] = 10.0 * (k + 1);
  return reported;
}

class ReportedOrbitTest : public testing::Test {
 protected:
  void report(double s, const telemetry_navigation& navigation) {
    const std::vector<pil::Packet> packets{*encoder_.encode(time_at(s), navigation)};
    reported_.take(packets);
  }
  /// The second of two telecommands, of which the first is none of the orbit's.
  std::pair<fsw::GpsTime, target_apriori> sent(double now_s) {
    target_apriori of_the_start{};
    of_the_start.mean_a_roe_m[0] = -1.0;
    std::vector<pil::Packet> telecommands{*encoder_.encode(time_at(-1000.0), earth_configuration{}),
                                          *encoder_.encode(time_at(-1000.0), of_the_start)};
    const auto applied = reported_.applied_to(telecommands, time_at(now_s));
    EXPECT_EQ(applied.size(), 2U);
    EXPECT_EQ(applied[0], telecommands[0]);
    const auto packet = fsw::packets::parse_packet(applied[1]).value();
    return {packet.header.time, fsw::packets::decode<target_apriori>(packet).value()};
  }

  twins::PacketEncoder encoder_{1, 0};
  ReportedOrbit reported_;
};

TEST_F(ReportedOrbitTest, IsThatOfTheLastTelemetry) {
  report(0.0, telemetry_navigation{});
  telemetry_navigation first = navigation();
  first.a_roe_mean_m[0] = 5.0;
  report(10.0, first);
  report(20.0, navigation());
  const auto [time, apriori] = sent(80.0);
  EXPECT_EQ(time, time_at(20.0));
  EXPECT_EQ(apriori.kind, target_apriori::kKindRoe);
  for (int k = 0; k < 6; ++k) EXPECT_EQ(apriori.mean_a_roe_m[k], 10.0 * (k + 1)) << k;
}

TEST_F(ReportedOrbitTest, AnInvalidEstimateIsNotSent) {
  telemetry_navigation invalid = navigation();
  invalid.valid = 0;
  report(20.0, invalid);
  EXPECT_EQ(sent(80.0).second.mean_a_roe_m[0], -1.0);
}

TEST_F(ReportedOrbitTest, AnOldReportIsNotSent) {
  report(0.0, navigation());
  EXPECT_EQ(sent(540.0).second.mean_a_roe_m[0], 10.0);
  EXPECT_EQ(sent(541.0).second.mean_a_roe_m[0], -1.0);
}

TEST_F(ReportedOrbitTest, WhatIsNoOrbitIsNotSent) {
  telemetry_navigation still = navigation();
  for (double& v : still.servicer_velocity_eci) v = 0.0;
  report(20.0, still);
  EXPECT_EQ(sent(80.0).second.mean_a_roe_m[0], -1.0);
}

// At the node of the orbit, where sines and cosines of u are 0 and 1, by hand.
TEST_F(ReportedOrbitTest, SigmasBoundThoseOfTheElements) {
  telemetry_navigation reported = navigation();
  const double n = fsw::orbit::mean_motion(kServicer.a);
  const double sigma[6] = {0.1, 0.5, 0.2, 0.02 * n, 0.03 * n, 0.04 * n};
  for (int k = 0; k < 6; ++k) reported.sigma_rtn[k] = sigma[k];
  const auto apriori = apriori_of(reported);
  ASSERT_TRUE(apriori);
  const double expected[6] = {4.0 * 0.1 + 2.0 * 0.03, 0.5 + 2.0 * 0.02, 3.0 * 0.1 + 2.0 * 0.03, 0.02, 0.04, 0.2};
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(apriori->sigma_a_roe_m[k], expected[k], 1e-6) << k;
}

}  // namespace
}  // namespace vbar::faults
