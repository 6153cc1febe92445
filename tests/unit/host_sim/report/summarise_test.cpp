// Figures of a run from its tables alone, against sums over what synthetic_run says it put in.

#include "host_sim/report/summarise.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "host_sim/report/provenance.h"
#include "host_sim/report/sections/html_report.h"
#include "host_sim/report/summary_json.h"
#include "tests/unit/host_sim/report/synthetic_run.h"

namespace vbar::report::test {

namespace {

TEST(Summarise, FiguresComeFromTheTables) {
  RunRecord record = synthetic_run();
  const Summary stored = record.summary;
  record.summary = {};
  static_cast<RunFacts&>(record.summary) = stored;
  evaluate(record);
  const Summary& s = record.summary;
  double dv = 0.0;
  for (int id = 1; id <= 40; ++id)
    if (id != 17) dv += std::hypot(1.0 / (id * id), 0.3 / id);
  EXPECT_NEAR(s.dv_mps, dv, 1e-12);
  EXPECT_EQ(s.maneuvers, 39);
  EXPECT_EQ(s.flight_step.count, 2476U);
  EXPECT_EQ(s.flight_step.stack_bytes_max, 21000U);
  EXPECT_EQ(s.first_fix_s.value(), 300.0);
  ASSERT_TRUE(s.health.has_value());
  EXPECT_EQ(s.health->step, 2475);
  EXPECT_EQ(s.health->inbox_dropped, 12);
  EXPECT_EQ(s.sensor_figures.at("images").at("images"), 2476);
  EXPECT_EQ(s.sensor_figures.at("pose").at("images"), 136);
  EXPECT_EQ(s.seed, stored.seed) << "a fact, not a figure";
  EXPECT_EQ(s.telemetry_sha256, stored.telemetry_sha256);
  EXPECT_EQ(record.waypoints[5].leg_maneuvers, 3) << "17 was not executed";
  EXPECT_NEAR(record.waypoints.back().cumulative_dv_mps, dv, 1e-12);
}

// Flight software without waypoints commands its burns for waypoint -1: they belong to the legs they were flown in, and
// the rows add up to the total.
TEST(Summarise, BurnsForNoWaypointBelongToTheLegOfTheirTime) {
  RunRecord record = synthetic_run();
  for (ManeuverRow& maneuver : record.maneuvers) maneuver.waypoint_index = -1;
  record.maneuvers.front().execution_time_s = record.waypoints[1].time_s;
  record.maneuvers.back().execution_time_s = record.waypoints.back().time_s + 60.0;
  for (std::size_t k = 1; k + 1 < record.maneuvers.size(); ++k)
    record.maneuvers[k].execution_time_s = record.waypoints[2].time_s + 1.0;
  evaluate(record);
  EXPECT_EQ(record.waypoints[0].leg_maneuvers, 0);
  EXPECT_EQ(record.waypoints[1].leg_maneuvers, 1) << "at the waypoint's own time";
  EXPECT_EQ(record.waypoints[2].leg_maneuvers, 0);
  EXPECT_EQ(record.waypoints[3].leg_maneuvers, 37) << "17 was not executed";
  const double after = magnitude(record.maneuvers.back().executed_dv_rtn_mps);
  EXPECT_NEAR(record.waypoints.back().cumulative_dv_mps + after, record.summary.dv_mps, 1e-12);
}

TEST(Summarise, IsAFunctionOfTheTables) {
  RunRecord record = synthetic_run();
  evaluate(record);
  const std::string once = summary_json(record.summary, record.waypoints);
  evaluate(record);
  EXPECT_EQ(summary_json(record.summary, record.waypoints), once);
}

// The fault of the flight software, or a waypoint passed, and no valid estimate: either alone is not the verdict.
TEST(Summarise, NeverNavigatedIsAVerdict) {
  RunRecord record = synthetic_run();
  evaluate(record);
  EXPECT_FALSE(record.summary.never_navigated);
  for (EstimateRow& row : record.estimates) row.navigation_valid = 0;
  evaluate(record);
  EXPECT_TRUE(record.summary.never_navigated) << "waypoints were passed";
  record.waypoints.resize(1);
  evaluate(record);
  EXPECT_FALSE(record.summary.never_navigated) << "a run too short to tell";
  auto& health = std::get<std::vector<TelemetryRow<telemetry_health>>>(record.telemetry).back().message;
  health.faults |= telemetry_health::kFaultNeverNavigated;
  evaluate(record);
  EXPECT_TRUE(record.summary.never_navigated);
  EXPECT_NE(summary_json(record.summary, record.waypoints).find("\"never_navigated\": true"), std::string::npos);
  EXPECT_NE(html_report(record).find("never navigated"), std::string::npos);
  record.estimates.back().navigation_valid = 1;
  evaluate(record);
  EXPECT_FALSE(record.summary.never_navigated) << "late, but it navigated";
}

TEST(Summarise, ANaNInATableIsSeen) {
  RunRecord record = synthetic_run();
  record.estimates[1000].relative_position_rtn[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(summarise(record).navigation_error_m->mean));
}

TEST(Summarise, AKilledRunIsAsLongAsItsTables) {
  RunRecord record = synthetic_run();
  record.summary.complete = false;
  record.summary.simulated_s = 0.0;
  EXPECT_EQ(summarise(record).simulated_s, 148500.0);
}

TEST(Summarise, HealthIsOneLineOfWhatIsNotNominal) {
  telemetry_health health{};
  health.packets_accepted = 100;
  health.step = 7;
  EXPECT_EQ(health_line(health), "");
  health.inbox_dropped = 11123;
  health.faults = telemetry_health::kFaultInboxFull;
  health.faults |= telemetry_health::kFaultNavigationTimeout;
  EXPECT_EQ(health_line(health), "inbox dropped 11123, faults navigation_timeout+inbox_full");
}

TEST(Magnitude, IsNaNIfOneComponentIs) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const Triple& v :
       {Triple{kNan, 0.0, 0.0}, Triple{0.0, kNan, 0.0}, Triple{0.0, 0.0, kNan}, Triple{1.0, kNan, 0.0}})
    EXPECT_TRUE(std::isnan(magnitude(v)));
  EXPECT_EQ(magnitude({2.0, -3.0, 6.0}), 7.0);
}

}  // namespace

namespace {

using fsw::packets::Apid;

class OutputHashTest : public ScratchFolder {
 protected:
  [[nodiscard]] std::string sha256sum(const Bytes& bytes) const {
    const auto file = scratch_ / "bytes";
    write(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    return output_of("sha256sum " + file.string()).text.substr(0, 64);
  }
};

void append(Bytes& all, const Bytes& more) {
  all.insert(all.end(), more.begin(), more.end());
}

// FIPS 180-4: SHA-256 of no bytes at all.
TEST_F(OutputHashTest, OfNothing) {
  const OutputHash hash;
  EXPECT_EQ(hash.commands_sha256(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(hash.telemetry_sha256(), hash.commands_sha256());
}

TEST_F(OutputHashTest, IsThatOfTheBytesInOrder) {
  OutputHash hash;
  Bytes commands, telemetry;
  std::size_t step_reports = 0;
  for (const Bytes& packet : some_packets()) {
    hash.add(packet);
    const int apid = (packet[0] & 0x07) << 8 | packet[1];
    if (apid == 0x401) append(commands, packet);
    if (apid >= 0x500 && apid < 0x600) append(telemetry, packet);
    if (apid == 0x601) ++step_reports;
  }
  ASSERT_EQ(step_reports, 5U) << "they count nowhere, so there must be some";
  EXPECT_EQ(hash.commands_sha256(), sha256sum(commands));
  EXPECT_EQ(hash.telemetry_sha256(), sha256sum(telemetry));
}

TEST_F(OutputHashTest, CanBeAskedInBetween) {
  OutputHash asked, quiet;
  for (const Bytes& packet : some_packets()) {
    asked.add(packet);
    quiet.add(packet);
    static_cast<void>(asked.telemetry_sha256());
  }
  EXPECT_EQ(asked.telemetry_sha256(), quiet.telemetry_sha256());
}

TEST_F(OutputHashTest, OrderAndDamageMatter) {
  const Bytes first = packet_of(Apid::kManeuverCommand, 0);
  const Bytes second = packet_of(Apid::kManeuverCommand, 1);
  OutputHash forwards, backwards, damaged;
  forwards.add(first);
  forwards.add(second);
  backwards.add(second);
  backwards.add(first);
  EXPECT_NE(forwards.commands_sha256(), backwards.commands_sha256());
  Bytes flipped = second;
  flipped.back() ^= 1U;  // the CRC is wrong now: no receiver takes it, but it was sent
  damaged.add(first);
  damaged.add(flipped);
  EXPECT_NE(forwards.commands_sha256(), damaged.commands_sha256());
  EXPECT_EQ(forwards.telemetry_sha256(), OutputHash().telemetry_sha256());
}

TEST_F(OutputHashTest, ScrapsThatHoldNoApidChangeNothing) {
  OutputHash hash;
  hash.add({});
  hash.add(Bytes{0x04});
  EXPECT_EQ(hash.commands_sha256(), OutputHash().commands_sha256());
}

}  // namespace

}  // namespace vbar::report::test
