// The laser range finder: its errors against the configured sigmas, the edges of what it measures, its keys, and its
// measurements beside the truth.

#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "fsw/packets/messages.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/report/run_tables.h"
#include "host_sim/report/sections/html_report.h"
#include "host_sim/report/summarise.h"
#include "host_sim/sensors/range_finder/range_finder_kind.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::sensors {
namespace {

using mission::test::changed;
using mission::test::message_of;
using testing::HasSubstr;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

RangeFinderSettings settings() {
  RangeFinderSettings settings;
  settings.range_min_m = 2.0;
  settings.range_max_m = 500.0;
  settings.bias_sigma_m = 0.3;
  settings.noise_sigma_m = 0.05;
  settings.half_angle_rad = 10.0 * kDegree;
  settings.boresight_body = fsw::Vector3::UnitX();
  settings.period = fsw::duration_of_seconds(1);
  return settings;
}

/// The target at `range_m` and this angle from the servicer's body x axis; the body is turned by 90 deg about z.
twins::TruthSnapshot truth_at(std::int64_t second, double range_m, double angle_rad) {
  twins::SpacecraftTruth servicer{.name = "servicer", .orbit = {}};
  servicer.orbit.position_eci = {7e6, 1e5, -2e5};
  servicer.attitude = truth::AttitudeState{
      Eigen::Quaterniond(Eigen::AngleAxisd(-90.0 * kDegree, fsw::Vector3::UnitZ())), fsw::Vector3::Zero()};
  twins::SpacecraftTruth target{.name = "target", .orbit = {}};
  // Body x is ECI y, body y is ECI -x.
  target.orbit.position_eci =
      servicer.orbit.position_eci + range_m * fsw::Vector3(-std::sin(angle_rad), std::cos(angle_rad), 0.0);
  return {fsw::GpsTime{} + fsw::duration_of_seconds(second), {servicer, target}};
}

RangeFinder finder(std::uint64_t seed, const RangeFinderSettings& with = settings()) {
  return {with, {"servicer", "target", 1, 3, {}}, engine::RandomStream(seed, "servicer/lidar")};
}

/// What it measures less `range_m`; NaN for none.
double error_of(RangeFinder& finder, std::int64_t second, double range_m, double angle_rad = 0.0) {
  const twins::Measurement measurement = finder.measure(truth_at(second, range_m, angle_rad));
  EXPECT_EQ(measurement.status, twins::MeasurementStatus::kReady) << measurement.reason;
  if (measurement.packets.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto packet = fsw::packets::parse_packet(measurement.packets.front());
  EXPECT_EQ(packet.value().header.unit, 3);
  return fsw::packets::decode<range_measurement>(packet.value()).value().range_m - range_m;
}

struct Spread {
  double mean = 0.0, std = 0.0;
};
Spread spread_of(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double v : values) sum += v;
  const double mean = sum / static_cast<double>(values.size());
  for (const double v : values) squares += (v - mean) * (v - mean);
  return {mean, std::sqrt(squares / static_cast<double>(values.size()))};
}

// Four standard errors of a mean (sigma / sqrt n) and of a standard deviation (sigma / sqrt 2n).
TEST(RangeFinder, NoiseAboutOneBiasHasItsSigma) {
  RangeFinder lidar = finder(7);
  std::vector<double> errors;
  for (int k = 0; k < 4000; ++k) errors.push_back(error_of(lidar, k, 100.0));
  const Spread spread = spread_of(errors);
  EXPECT_NEAR(spread.std, 0.05, 4.0 * 0.05 / std::sqrt(2.0 * 4000.0));
  // The bias alone, from a twin of the same run without noise.
  RangeFinderSettings quiet = settings();
  quiet.noise_sigma_m = 0.0;
  RangeFinder same_bias = finder(7, quiet);
  EXPECT_NEAR(spread.mean, error_of(same_bias, 0, 100.0), 4.0 * 0.05 / std::sqrt(4000.0));
}

TEST(RangeFinder, BiasOverRunsHasItsSigma) {
  RangeFinderSettings quiet = settings();
  quiet.noise_sigma_m = 0.0;
  std::vector<double> biases;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    RangeFinder lidar = finder(seed, quiet);
    biases.push_back(error_of(lidar, 0, 100.0));
    EXPECT_NEAR(error_of(lidar, 500, 20.0), biases.back(), 1e-9);  // the same all through a run
  }
  const Spread spread = spread_of(biases);
  EXPECT_NEAR(spread.mean, 0.0, 4.0 * 0.3 / std::sqrt(1000.0));
  EXPECT_NEAR(spread.std, 0.3, 4.0 * 0.3 / std::sqrt(2000.0));
}

TEST(RangeFinder, NoiseBelongsToTheEpoch) {
  RangeFinder all = finder(7), some = finder(7);
  for (int k = 0; k < 5; ++k) static_cast<void>(error_of(all, k, 100.0));
  EXPECT_EQ(error_of(all, 5, 100.0), error_of(some, 5, 100.0));
}

TEST(RangeFinder, MeasuresInsideItsFieldOfView) {
  RangeFinder lidar = finder(1);
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_TRUE(std::isfinite(error_of(lidar, 0, 100.0, sign * 9.99 * kDegree)));
    EXPECT_TRUE(std::isnan(error_of(lidar, 1, 100.0, sign * 10.01 * kDegree)));
  }
  EXPECT_TRUE(std::isnan(error_of(lidar, 2, 100.0, 180.0 * kDegree)));
}

TEST(RangeFinder, MeasuresInsideItsLimits) {
  RangeFinder lidar = finder(1);
  EXPECT_TRUE(std::isnan(error_of(lidar, 0, 1.999)));
  EXPECT_TRUE(std::isfinite(error_of(lidar, 1, 2.001)));
  EXPECT_TRUE(std::isfinite(error_of(lidar, 2, 499.999)));
  EXPECT_TRUE(std::isnan(error_of(lidar, 3, 500.001)));
}

TEST(RangeFinder, FailsWithoutTruthItNeeds) {
  RangeFinder lidar = finder(1);
  twins::TruthSnapshot truth = truth_at(0, 100.0, 0.0);
  truth.spacecraft[0].attitude.reset();
  EXPECT_EQ(lidar.measure(truth).status, twins::MeasurementStatus::kFailed);
  truth = truth_at(0, std::numeric_limits<double>::quiet_NaN(), 0.0);
  EXPECT_THAT(lidar.measure(truth).reason, HasSubstr("range finder"));
  truth.spacecraft.pop_back();
  EXPECT_EQ(lidar.measure(truth).status, twins::MeasurementStatus::kFailed);
}

// -----------------------------------------------------------------------------------------------------------------
// keys

std::string with_lidar(const std::string& keys, const std::string& attitude = "attitude = { profile = \"zenith\" }\n") {
  return changed(std::string(mission::test::kSmallMission), "sensors.navigation = {}",
                 attitude + "sensors.navigation = {}\nsensors.lidar = { kind = \"range_finder\"" + keys + " }");
}

TEST(RangeFinderKeys, AreRead) {
  const mission::Mission mission =
      parse_mission(with_lidar(", range_max_m = 50, bias_sigma_m = 0.5, field_of_view_deg = 30, period_s = 2, "
                               "boresight_body = [0, -0.5, 0]"),
                    "m.toml");
  const auto& sensor = settings_of<RangeFinderSensor>(mission.spacecraft[0].sensors[1]);
  EXPECT_EQ(sensor.target, "target");
  EXPECT_EQ(sensor.range_finder.range_max_m, 50.0);
  EXPECT_EQ(sensor.range_finder.bias_sigma_m, 0.5);
  EXPECT_NEAR(sensor.range_finder.half_angle_rad, 15.0 * kDegree, 1e-15);
  EXPECT_EQ(sensor.range_finder.boresight_body, -fsw::Vector3::UnitY());
  EXPECT_EQ(sensor.range_finder.period, fsw::duration_of_seconds(2));
  EXPECT_EQ(mission.spacecraft[0].observes(), "target");
}

TEST(RangeFinderKeys, AreRefusedWithOneMessage) {
  const auto refused = [](const std::string& keys) { return message_of(with_lidar(keys)); };
  EXPECT_THAT(refused(", colour = 3"), HasSubstr("sensors.lidar.colour"));
  EXPECT_THAT(refused(", noise_sigma_m = -0.1"), HasSubstr("sensors.lidar.noise_sigma_m: found the number -0.1"));
  EXPECT_THAT(refused(", bias_sigma_m = nan"), HasSubstr("sensors.lidar.bias_sigma_m: found nan"));
  EXPECT_THAT(refused(", field_of_view_deg = 181"),
              HasSubstr("sensors.lidar.field_of_view_deg: found the integer 181"));
  EXPECT_THAT(refused(", range_min_m = 10, range_max_m = 5"), HasSubstr("sensors.lidar.range_max_m"));
  EXPECT_THAT(refused(", boresight_body = [0, 0, 0]"), HasSubstr("sensors.lidar.boresight_body"));
  EXPECT_THAT(refused(", target = \"servicer\""), HasSubstr("sensors.lidar.target"));
  EXPECT_THAT(message_of(with_lidar("", "")), HasSubstr("no attitude of servicer"));
}

// ------------------------------------------------------------------------------------------------------------ the
// record

class RangeEvaluation : public testing::Test {
 protected:
  RangeEvaluation() {
    record_.extensions = extensions();
    evaluations_ = make_evaluations(mission_, mission_.spacecraft[0], record_);
  }
  /// Measured at `second`; nothing is delivered of NaN.
  void measure(std::int64_t second, double true_m, double measured_m, double angle_rad = 0.0) {
    twins::TruthSnapshot truth = truth_at(0, true_m, angle_rad);
    truth.time = mission_.epoch + fsw::duration_of_seconds(second);
    ASSERT_EQ(evaluations_.size(), 1U);
    EXPECT_EQ(evaluations_[0].source, "servicer/lidar");
    evaluations_[0].evaluation->on_measured(truth);
    std::vector<twins::Packet> packets;
    twins::PacketEncoder encoder(1, 0), other_unit(1, 1);
    range_measurement message{};
    message.range_m = measured_m;
    const auto packet = encoder.encode(truth.time, message);
    message.range_m = 1e3;
    const auto stranger = other_unit.encode(truth.time, message);
    packets.push_back(*stranger);
    if (packet) packets.push_back(*packet);
    evaluations_[0].evaluation->on_inputs(truth.time + fsw::duration_of_seconds(1), packets);
  }
  void fly() {
    measure(0, 10.0, 10.25);
    measure(1, 20.0, std::numeric_limits<double>::quiet_NaN());
    measure(2, 30.0, 29.75);
    measure(3, 40.0, std::numeric_limits<double>::quiet_NaN(), 90.0 * kDegree);
    evaluations_[0].evaluation->finish();
  }

  mission::Mission mission_ =
      parse_mission(with_lidar(", boresight_body = [1, 0, 0], bias_sigma_m = 0.3, noise_sigma_m = 0.4"), "m.toml");
  report::RunRecord record_;
  std::vector<NamedEvaluation> evaluations_;
};

TEST_F(RangeEvaluation, PutsMeasurementsBesideTheTruth) {
  fly();
  EXPECT_THAT(report::table_text(record_, "range_finder.csv"),
              HasSubstr("time_s,sensor,measured_m,true_m,error_m,off_boresight_deg,in_field_of_view,sigma_m\n"
                        "0,lidar,10.25,"));
  const auto& rows = record_.tables.rows<RangeRow>();
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_NEAR(rows[0].error_m.value(), 0.25, 1e-8);  // of positions of 7000 km
  EXPECT_FALSE(rows[1].measured_m.has_value());
  EXPECT_NEAR(rows[1].true_m.value(), 20.0, 1e-8);
  EXPECT_TRUE(rows[1].in_field_of_view);
  EXPECT_NEAR(rows[2].error_m.value(), -0.25, 1e-8);
  EXPECT_FALSE(rows[3].in_field_of_view);
  EXPECT_NEAR(rows[3].off_boresight_deg.value(), 90.0, 1e-6);
  EXPECT_NEAR(rows[3].sigma_m, 0.5, 1e-15);
}

TEST_F(RangeEvaluation, GivesFiguresAndASection) {
  fly();
  const report::Summary summary = report::summarise(record_);
  const auto& figures = summary.sensor_figures.at("lidar");
  EXPECT_EQ(figures.at("epochs"), 4.0);
  EXPECT_EQ(figures.at("measurements"), 2.0);
  EXPECT_EQ(figures.at("in_field_of_view"), 3.0);
  EXPECT_NEAR(figures.at("range_error_mean_m"), 0.0, 1e-8);
  EXPECT_NEAR(figures.at("range_error_std_m"), 0.25, 1e-8);
  const std::string html = report::html_report(record_);
  EXPECT_THAT(html, HasSubstr("Laser range finder"));
  EXPECT_THAT(html, HasSubstr("lidar, range error"));
  EXPECT_THAT(html, HasSubstr("2 at 4 epochs"));
  record_.tables = {};
  EXPECT_THAT(report::html_report(record_), testing::Not(HasSubstr("Laser range finder")));
}

}  // namespace
}  // namespace vbar::sensors
