// The flight software's state is the bytes of one object, also with filters, receiver streams and epochs in waiting: a
// flight that saves and restores it time and again says what an undisturbed one says.

#include <cmath>
#include <cstring>
#include <new>
#include <utility>

#include <gtest/gtest.h>

#include "fsw/messaging/vbar_gnc.h"
#include "fsw/packets/packet.h"
#include "host_sim/report/run_series.h"
#include "host_sim/sensors/gnss/gnss_rows.h"
#include "tests/integration/rendezvous/run_mission.h"

namespace vbar::test {

namespace {

constexpr std::uint8_t kServicerNumber = 1;

/// Memory for the state, filled with a pattern that would be seen if anything in it were read before it is written.
class StateMemory {
 public:
  StateMemory() : bytes_(::operator new(vbar_gnc_state_size(), alignment())) {
    std::memset(bytes_, 0xA5, vbar_gnc_state_size());
  }
  ~StateMemory() { ::operator delete(bytes_, alignment()); }
  StateMemory(const StateMemory&) = delete;
  StateMemory& operator=(const StateMemory&) = delete;
  [[nodiscard]] void* get() const { return bytes_; }

 private:
  static std::align_val_t alignment() { return std::align_val_t(vbar_gnc_state_alignment()); }
  void* bytes_;
};

/// Moves its flight software to other memory between any two steps, and between packets and step.
class MovingComputer final : public pil::FlightComputer {
 public:
  MovingComputer() : state_(std::make_unique<StateMemory>()) {
    EXPECT_EQ(vbar_gnc_init(state_->get(), kServicerNumber, &MovingComputer::sink, &answer_), 0);
  }

  pil::StepResult step(std::uint32_t, std::span<const pil::Packet> packets) override {
    for (const pil::Packet& packet : packets) vbar_gnc_receive(state_->get(), packet.data(), packet.size());
    move();
    const auto last = fsw::packets::parse_packet(packets.back());
    EXPECT_TRUE(last.ok());
    EXPECT_EQ(vbar_gnc_step(state_->get(), last.value().header.time.ns), 0);
    move();
    pil::StepResult result;
    result.packets = std::exchange(answer_, {});
    return result;
  }
  [[nodiscard]] pil::LinkStatistics statistics() const override { return {}; }
  [[nodiscard]] std::string description() const override { return "moving"; }
  void close() override {}

 private:
  void move() {
    auto other = std::make_unique<StateMemory>();
    std::memcpy(other->get(), state_->get(), vbar_gnc_state_size());
    state_ = std::move(other);
    vbar_gnc_set_sink(state_->get(), &MovingComputer::sink, &answer_);
  }
  static void sink(void* answer, const std::uint8_t* packet, std::size_t size) {
    static_cast<std::vector<pil::Packet>*>(answer)->emplace_back(packet, packet + size);
  }

  std::unique_ptr<StateMemory> state_;
  std::vector<pil::Packet> answer_;
};

TEST(SavedState, OfCarrierPhaseNavigationFliesOn) {
  // Half an hour: receivers' first bytes, the first integers held, a plan and burns.
  const std::vector<std::string> arc{"mission.duration_h=0.5", "guidance.planner_delay_s=600"};
  const FlownMission undisturbed = fly("experiment3.toml", arc);
  const FlownMission moved = fly("experiment3.toml", arc, [](auto) { return std::make_unique<MovingComputer>(); });
  EXPECT_TRUE(moved.complete);
  EXPECT_FALSE(undisturbed.commands.empty());
  EXPECT_EQ(moved.commands, undisturbed.commands);
  EXPECT_EQ(moved.telemetry, undisturbed.telemetry);
}

}  // namespace

// What a flight by GNSS leaves in its record: the flight software's own words, and statistics that begin at the first
// fix.

namespace {

constexpr int kFixedAmbiguities = telemetry_navigation::kSourceGnssFixed;

std::string body_frame(const char* spacecraft, const char* key, double value) {
  return std::string("spacecraft.") + spacecraft + ".sensors.gnss.body_frame." + key + "=" + std::to_string(value);
}

/// Bodies without errors, but for the offset of the servicer's phase centre.
std::vector<std::string> only_offset_mm(double offset_mm) {
  std::vector<std::string> overrides{"mission.duration_h=0.01"};
  for (const char* spacecraft : {"servicer", "target"})
    for (const char* key : {"com_radius_mm", "pco_bias_mm", "antenna_direction_arcsec", "attitude_knowledge_arcsec"})
      overrides.push_back(body_frame(spacecraft, key, 0.0));
  overrides.push_back(body_frame("servicer", "pco_bias_mm", offset_mm));
  return overrides;
}

TEST(GnssRecord, HasARowAStepAndStatisticsFromTheFirstFixOn) {
  const FlownMission flown = fly("experiment3.toml", {"mission.duration_h=0.1"});
  const report::RunRecord& record = flown.record;
  ASSERT_EQ(record.estimates.size(), 37U) << "six minutes at 10 s, both ends";
  ASSERT_EQ(record.tables.rows<sensors::GnssRow>().size(), record.estimates.size());
  ASSERT_EQ(record.truth.size(), record.estimates.size());
  EXPECT_EQ(record.summary.simulated_s, 360.0) << "what the crosslink delivers after the end does not count";

  double sum = 0.0;
  int count = 0;
  for (std::size_t k = 0; k < record.tables.rows<sensors::GnssRow>().size(); ++k) {
    const sensors::GnssRow& row = record.tables.rows<sensors::GnssRow>()[k];
    EXPECT_EQ(row.step, static_cast<std::int64_t>(k));
    EXPECT_EQ(row.time_s, record.truth[k].time_s);
    EXPECT_LE(row.fixed, row.tracked);
    // The servicer's epochs are processed at their time; the target's half of a pair comes after the step of its time.
    EXPECT_LE(row.epoch_s.value(), row.time_s);
    if (k > 0) {
      EXPECT_LE(row.pairs, static_cast<std::int32_t>(k));
    }
    if (count == 0 && record.estimates[k].navigation_source != kFixedAmbiguities) continue;
    const report::Triple& a = record.estimates[k].relative_position_rtn;
    const report::Triple& b = record.truth[k].relative_position_rtn;
    sum += std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    if (count == 0) {
      EXPECT_EQ(record.summary.first_fix_s, row.time_s - record.tables.rows<sensors::GnssRow>().front().time_s);
    }
    ++count;
  }
  ASSERT_GT(count, 0) << "never fixed";
  // The same sum in the same order, but for the compiler's choice of instructions.
  EXPECT_NEAR(record.summary.navigation_error_m.value().mean, sum / count, 1e-15);
  EXPECT_GT(record.summary.navigation_nees.value(), 0.0);
}

// The twin draws independent noise at each epoch, by the formulas from which it also states its sigmas. 1490
// differences of the rarest signal: a correlation is known to 0.026 and a sigma to 2 %; sigmas that differ between
// satellites and the flight filter's lower bounds of stated ones leave some percent.
TEST(GnssRecord, NoiseOfTheTwinIsWhiteAndAsStated) {
  const FlownMission flown = fly("experiment3.toml");
  const auto& rows = flown.record.tables.rows<sensors::SignalNoiseRow>();
  ASSERT_EQ(rows.size(), 4U);
  for (const sensors::SignalNoiseRow& row : rows) {
    SCOPED_TRACE(row.signal);
    EXPECT_EQ(row.excluded, 0U);
    EXPECT_NEAR(row.phase_correlation_10s.value(), 0.0, 0.1);
    EXPECT_NEAR(row.code_correlation_10s.value(), 0.0, 0.1);
    EXPECT_NEAR(row.phase_sigma_mm.value() / row.phase_sigma_stated_mm.value(), 1.0, 0.15);
    EXPECT_NEAR(row.code_sigma_m.value() / row.code_sigma_stated_m.value(), 1.0, 0.1);
    EXPECT_FALSE(row.phase_wander_sigma_mm);
  }
  const auto& figures = flown.record.summary.sensor_figures.at("gnss");
  EXPECT_EQ(figures.at("gps_l1_code_correlation_10s"), rows[0].code_correlation_10s);
  EXPECT_LE(figures.at("time_to_20_mm_s"), 300.0);
}

// 1 mm over 60 s in each receiver's channels. Analytic: variances of the white part (stated) and of the wander add up,
// and the latter alone correlates. 10,000 differences of GPS have some 1500 correlation times in them: 3 % of the
// wander's share of L1, which is half of its variance, and a tenth of its time.
TEST(GnssRecord, FindsTheWanderThatTheTwinIsGiven) {
  const FlownMission flown =
      fly("experiment3.toml", {"spacecraft.servicer.sensors.gnss.tracking.carrier_wander_sigma_mm=1.0",
                               "spacecraft.target.sensors.gnss.tracking.carrier_wander_sigma_mm=1.0"});
  const auto& rows = flown.record.tables.rows<sensors::SignalNoiseRow>();
  ASSERT_EQ(rows.size(), 4U);
  for (const sensors::SignalNoiseRow& row : {rows[0], rows[1]}) {
    SCOPED_TRACE(row.signal);
    constexpr double kWanderDifference_mm = 2.0;  // of four channels
    const double white_mm = row.phase_sigma_stated_mm.value();
    EXPECT_NEAR(row.phase_sigma_mm.value(), std::hypot(white_mm, kWanderDifference_mm), 0.2);
    const double share = kWanderDifference_mm * kWanderDifference_mm / std::pow(row.phase_sigma_mm.value(), 2);
    EXPECT_NEAR(row.phase_correlation_10s.value(), share * std::exp(-10.0 / 60.0), 0.06);
    EXPECT_NEAR(row.code_correlation_10s.value(), 0.0, 0.1);
  }
  EXPECT_NEAR(rows[0].phase_wander_sigma_mm.value(), 1.0, 0.1);
  EXPECT_NEAR(rows[0].phase_wander_time_s.value(), 60.0, 15.0);
}

// A vector of known length in one body only is the floor; rounding of metres.
TEST(GnssRecord, StaticFloorIsThatOfTheRunsOwnAntennas) {
  EXPECT_NEAR(fly("experiment3.toml", only_offset_mm(5.0)).record.summary.static_floor_m.value(), 5e-3, 1e-15);
  EXPECT_NEAR(fly("experiment3.toml", only_offset_mm(0.0)).record.summary.static_floor_m.value(), 0.0, 1e-15);
}

TEST(GnssRecord, NavigationFliesAloneThroughPrescribedBurns) {
  const FlownMission flown = fly("gnss_navigation_only.toml");
  const report::RunRecord& record = flown.record;
  EXPECT_TRUE(flown.commands.empty()) << "guidance is idle";
  ASSERT_EQ(record.maneuvers.size(), 4U);
  for (const report::ManeuverRow& maneuver : record.maneuvers) {
    EXPECT_TRUE(maneuver.accepted);
    EXPECT_EQ(maneuver.executed_dv_rtn_mps, maneuver.commanded_dv_rtn_mps) << "the thruster is ideal";
  }
  EXPECT_DOUBLE_EQ(report::magnitude(record.maneuvers[3].executed_dv_rtn_mps), 3e-3);
  EXPECT_EQ(record.estimates.back().navigation_source, kFixedAmbiguities);
}

TEST(GnssRecord, IsEmptyWithoutGnss) {
  const FlownMission flown = fly("ideal_navigation.toml", {"mission.duration_h=0.1"});
  EXPECT_TRUE(flown.record.tables.rows<sensors::GnssRow>().empty());
  EXPECT_FALSE(flown.record.summary.first_fix_s.has_value());
  EXPECT_FALSE(flown.record.summary.static_floor_m.has_value());
  EXPECT_FALSE(flown.record.summary.navigation_nees.has_value());
}

}  // namespace

}  // namespace vbar::test
