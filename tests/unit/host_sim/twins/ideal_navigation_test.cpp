#include "host_sim/twins/ideal_navigation.h"

#include <limits>

#include <gtest/gtest.h>

namespace vbar::twins {
namespace {

using fsw::GpsTime;

constexpr GpsTime kFirstEpoch{1'000'000'000'000'000'000};

IdealNavigation::Settings settings() {
  return {"servicer", 1, 3, "target", kFirstEpoch, fsw::duration_of_seconds(60)};
}

TruthSnapshot truth_at(GpsTime time) {
  TruthSnapshot truth;
  truth.time = time;
  truth.spacecraft.push_back({"target", {{7.0e6, 1.0, 2.0}, {3.0, 7.5e3, 4.0}}, {}});
  truth.spacecraft.push_back({"servicer", {{7.1e6, -1.0, -2.0}, {-3.0, 7.4e3, -4.0}}, {}});
  return truth;
}

TEST(IdealNavigation, SendsTheTrueStatesOfTheNamedSpacecraft) {
  IdealNavigation sensor(settings());
  const Measurement measurement = sensor.measure(truth_at(kFirstEpoch));
  ASSERT_EQ(measurement.status, MeasurementStatus::kReady);
  EXPECT_EQ(measurement.available, kFirstEpoch);
  EXPECT_FALSE(measurement.bypasses_link);
  ASSERT_EQ(measurement.packets.size(), 1U);

  const auto view = fsw::packets::parse_packet(measurement.packets[0]);
  ASSERT_TRUE(view.ok());
  EXPECT_EQ(view.value().header.apid, fsw::packets::Apid::kIdealNavigation);
  EXPECT_EQ(view.value().header.time, kFirstEpoch);
  EXPECT_EQ(view.value().header.spacecraft, 1);
  EXPECT_EQ(view.value().header.unit, 3);
  const auto message = fsw::packets::decode<vbar::ideal_navigation>(view.value());
  ASSERT_TRUE(message.ok());
  EXPECT_EQ(message.value().servicer_position_eci[0], 7.1e6);
  EXPECT_EQ(message.value().servicer_velocity_eci[2], -4.0);
  EXPECT_EQ(message.value().target_position_eci[1], 1.0);
  EXPECT_EQ(message.value().target_velocity_eci[1], 7.5e3);
}

TEST(IdealNavigation, NumbersItsPacketsModulo14Bits) {
  IdealNavigation sensor(settings());
  for (int k = 0; k <= 0x4000; ++k) {
    const Measurement measurement = sensor.measure(truth_at(kFirstEpoch + fsw::duration_of_seconds(60 * k)));
    const auto view = fsw::packets::parse_packet(measurement.packets.at(0));
    ASSERT_TRUE(view.ok());
    ASSERT_EQ(view.value().header.sequence_count, k & 0x3FFF);
  }
}

TEST(IdealNavigation, MeasuresEveryPeriodFromItsStart) {
  const IdealNavigation sensor(settings());
  const auto at = [](std::int64_t ns) { return kFirstEpoch + fsw::Duration{ns}; };
  constexpr std::int64_t kPeriod = 60'000'000'000;
  EXPECT_EQ(sensor.next_epoch(at(-5)), at(0));
  EXPECT_EQ(sensor.next_epoch(at(0)), at(0)) << "at or after";
  EXPECT_EQ(sensor.next_epoch(at(1)), at(kPeriod));
  EXPECT_EQ(sensor.next_epoch(at(kPeriod)), at(kPeriod));
  EXPECT_EQ(sensor.next_epoch(at(7 * kPeriod - 1)), at(7 * kPeriod));
}

TEST(IdealNavigation, FailsWithAReason) {
  IdealNavigation sensor(settings());
  TruthSnapshot alone = truth_at(kFirstEpoch);
  alone.spacecraft.erase(alone.spacecraft.begin());
  Measurement measurement = sensor.measure(alone);
  EXPECT_EQ(measurement.status, MeasurementStatus::kFailed);
  EXPECT_EQ(measurement.reason, "ideal navigation: no spacecraft \"target\"");
  EXPECT_TRUE(measurement.packets.empty());

  TruthSnapshot broken = truth_at(kFirstEpoch);
  broken.spacecraft[0].orbit.position_eci(1) = std::numeric_limits<double>::quiet_NaN();
  measurement = sensor.measure(broken);
  EXPECT_EQ(measurement.status, MeasurementStatus::kFailed);
  EXPECT_TRUE(measurement.packets.empty()) << "no NaN reaches a packet";

  // The failures have left no gap in the sequence.
  const Measurement good = sensor.measure(truth_at(kFirstEpoch));
  EXPECT_EQ(fsw::packets::parse_packet(good.packets.at(0)).value().header.sequence_count, 0);
}

}  // namespace
}  // namespace vbar::twins
