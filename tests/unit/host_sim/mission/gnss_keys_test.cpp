// The keys of GNSS: what a bad value ends with, and that a good one arrives in SI units.

#include <numbers>

#include <gtest/gtest.h>

#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {
namespace {

/// The small mission with a GNSS pair instead of ideal navigation.
std::string gnss_mission() {
  const std::string text = changed(std::string(kSmallMission), "sensors.navigation = {}",
                                   "attitude = { profile = \"zenith\" }\nsensors.gnss = { partner = \"target\" }");
  return changed(text, "relative = {",
                 "attitude = { profile = \"nadir\" }\nsensors.gnss = { period_s = 5 }\nrelative = {");
}

/// One change of that mission, and the message it ends with: "m.toml:<line of `at`>: <message>".
struct BadChange {
  std::string_view label;
  std::string_view what;
  std::string_view by;
  std::string_view at;
  std::string_view message;
};

void PrintTo(const BadChange& change, std::ostream* out) {
  *out << change.label;
}

class BadGnssMission : public testing::TestWithParam<BadChange> {};

TEST_P(BadGnssMission, EndsWithOneMessage) {
  const BadChange& change = GetParam();
  const std::string text = changed(gnss_mission(), change.what, change.by);
  EXPECT_EQ(message_of(text), "m.toml:" + line_of_text(text, change.at) + ": " + std::string(change.message));
}

constexpr std::string_view kPartner = "partner = \"target\"";
constexpr std::string_view kSensor = "spacecraft.servicer.sensors.gnss";

INSTANTIATE_TEST_SUITE_P(
    Pair, BadGnssMission,
    testing::Values(
        BadChange{"PartnerUnknown", kPartner, "partner = \"moon\"", "moon",
                  "spacecraft.servicer.sensors.gnss.partner: found the text \"moon\"; accepted: another spacecraft: "
                  "servicer or target"},
        BadChange{
            "PartnerItself", kPartner, "partner = \"servicer\"", "partner",
            "spacecraft.servicer.sensors.gnss.partner: found the text \"servicer\"; accepted: another spacecraft: "
            "servicer or target"},
        BadChange{
            "NoPartner", "{ partner = \"target\" }", "{}", "sensors.gnss = {}",
            "spacecraft.servicer.sensors.gnss.partner: found nothing; accepted: a spacecraft that has sensors.gnss "
            "too"},
        BadChange{"PartnerWithoutGnss", "sensors.gnss = { period_s = 5 }\n", "", "partner",
                  "spacecraft.servicer.sensors.gnss.partner: found the spacecraft \"target\" without GNSS; accepted: a "
                  "spacecraft that has sensors.gnss too"},
        BadChange{"ServicerWithoutAttitude", "attitude = { profile = \"zenith\" }\n", "", "partner",
                  "spacecraft.servicer.sensors.gnss: found no attitude of servicer; accepted: both spacecraft with an "
                  "attitude: antennas point somewhere"},
        BadChange{"PartnerWithoutAttitude", "attitude = { profile = \"nadir\" }\n", "", "partner",
                  "spacecraft.servicer.sensors.gnss: found no attitude of target; accepted: both spacecraft with an "
                  "attitude: antennas point somewhere"},
        BadChange{"TwoWaysToNavigate", "sensors.gnss = { partner", "sensors.navigation = {}\nsensors.gnss = { partner",
                  "partner",
                  "spacecraft.servicer.sensors.gnss: found a second way to navigate; accepted: a sensor of kind "
                  "navigation or gnss, not both"},
        BadChange{"BurnBeforeTheStart", "[mission]", "[[burn]]\ntime_h = 0.5\n[mission]\nstart_h = 1.0", "time_h",
                  "burn.0.time_h: found the number 0.5; accepted: a time of the run"},
        BadChange{"BurnAfterTheEnd", "[mission]", "[[burn]]\ntime_h = 2.5\n[mission]", "time_h",
                  "burn.0.time_h: found the number 2.5; accepted: a time of the run"},
        BadChange{"BurnsOutOfOrder", "[mission]",
                  "[[burn]]\ntime_h = 1.5\ndv_rtn_mmps = [0, 1, 0]\n[[burn]]\ntime_h = 1.0 # again\n[mission]",
                  "# again", "burn.1.time_h: found the number 1; accepted: a time after the burn before"},
        BadChange{"BurnsAtTheSameTime", "[mission]",
                  "[[burn]]\ntime_h = 1.5\ndv_rtn_mmps = [0, 1, 0]\n[[burn]]\ntime_h = 1.5 # again\n[mission]",
                  "# again", "burn.1.time_h: found the number 1.5; accepted: a time after the burn before"},
        BadChange{"BurnWithoutSize", "[mission]", "[[burn]]\ntime_h = 1.5\n[mission]", "[[burn]]",
                  "burn.0.dv_rtn_mmps: found nothing; accepted: an array of 3 numbers from -1000000 to 1000000"},
        BadChange{"BurnOfNoNumber", "[mission]", "[[burn]]\ntime_h = 1.5\ndv_rtn_mmps = [0, nan, 0]\n[mission]", "nan",
                  "burn.0.dv_rtn_mmps[1]: found nan; accepted: a number from -1000000 to 1000000"},
        BadChange{"WanderWithoutATime", "[mission]",
                  "[navigation.carrier_phase]\nphase_wander_sigma_mm = 0.5\n[mission]", "[navigation.carrier_phase]",
                  "navigation.carrier_phase.phase_wander_time_s: found nothing; accepted: a number above 0 where "
                  "phase_wander_sigma_mm is above 0"},
        BadChange{"WanderOfNoTime", "[mission]",
                  "[navigation.carrier_phase]\nphase_wander_sigma_mm = 0.5\nphase_wander_time_s = 0\n[mission]",
                  "phase_wander_time_s",
                  "navigation.carrier_phase.phase_wander_time_s: found the integer 0; accepted: a number above 0 where "
                  "phase_wander_sigma_mm is above 0"},
        BadChange{"LossAbove1", "[mission]", "[links.crosslink]\nloss_probability = 1.5\n[mission]", "loss",
                  "links.crosslink.loss_probability: found the number 1.5; accepted: a number from 0 to 1"},
        BadChange{"SilenceBeforeTheStart", "[mission]", "[links.crosslink]\nsilence_begin_s = -1\n[mission]", "silence",
                  "links.crosslink.silence_begin_s: found the integer -1; accepted: a number from 0 to 10000000"},
        BadChange{
            "NominalGps", "[mission]", "[constellation]\ngps = \"nominal\"\n[mission]", "[constellation]",
            "constellation: found gps = nominal: GPS has no nominal set; accepted are none and broadcast; accepted: "
            "settings that fit together"},
        BadChange{"UnknownSatellites", "[mission]", "[constellation]\nbeidou = \"all\"\n[mission]", "beidou",
                  "constellation.beidou: found the text \"all\"; accepted: none, broadcast or nominal"},
        BadChange{
            "ThresholdsCrossed", kPartner, "partner = \"target\", tracking = { acquisition_threshold_dbhz = 20 }",
            "partner",
            "spacecraft.servicer.sensors.gnss: found loss_threshold_dbhz = 28 is above acquisition_threshold_dbhz "
            "= 20; accepted: settings that fit together"}),
    [](const testing::TestParamInfo<BadChange>& test) { return std::string(test.param.label); });

/// A value that a key refuses, given as an override, and what is accepted.
struct BadValue {
  std::string key;
  std::string value;
  std::string found;
  std::string accepted;
};

std::ostream& operator<<(std::ostream& out, const BadValue& bad) {
  return out << bad.key << '=' << bad.value;
}

/// Outside of the range of every number that GNSS has: one below and one above.
std::vector<BadValue> bad_values() {
  struct Number {
    const char* key;
    const char* accepted;
  };
  constexpr Number kNumbers[] = {
      {"period_s", "from 0.1 to 60"},
      {"ephemeris_period_s", "from 1 to 100000"},
      {"corrections_period_s", "from 1 to 100000"},
      {"visibility.transmit_aperture_deg", "above 0, up to 360"},
      {"visibility.receiver_mask_deg", "above 0, up to 360"},
      {"visibility.horizon_mask_deg", "from -90 to 90"},
      {"visibility.occultation_altitude_km", "from 0 to 1000"},
      {"link_budget.boresight_gain_dbi", "from -20 to 40"},
      {"link_budget.antenna_temperature_k", "above 0, up to 10000"},
      {"link_budget.lna_gain_db", "from 0 to 80"},
      {"link_budget.lna_noise_figure_db", "from 0 to 30"},
      {"link_budget.receiver_noise_figure_db", "from 0 to 30"},
      {"link_budget.losses_db", "from 0 to 40"},
      {"tracking.code_loop_bandwidth_hz", "above 0, up to 100"},
      {"tracking.carrier_loop_bandwidth_hz", "above 0, up to 200"},
      {"tracking.integration_s", "above 0, up to 1"},
      {"tracking.acquisition_threshold_dbhz", "from 0 to 60"},
      {"tracking.loss_threshold_dbhz", "from 0 to 60"},
      {"tracking.cycle_slips_per_hour", "from 0 to 10000"},
      {"tracking.undetected_slip_fraction", "from 0 to 1"},
      {"tracking.code_bias_sigma_m", "from 0 to 100"},
      {"tracking.carrier_wander_sigma_mm", "from 0 to 100"},
      {"tracking.carrier_wander_time_s", "above 0, up to 1000000"},
      {"tracking.w_code_rate_khz", "from 0 to 10230"},
      {"tracking.code_wander_l1_zenith_m", "from 0 to 100"},
      {"tracking.code_wander_l1_horizon_m", "from 0 to 100"},
      {"tracking.code_wander_l2_zenith_m", "from 0 to 100"},
      {"tracking.code_wander_l2_horizon_m", "from 0 to 100"},
      {"tracking.code_wander_time_s", "above 0, up to 1000000"},
      {"start.cold_search_min_s", "from 0 to 3600"},
      {"start.cold_search_max_s", "from 0 to 3600"},
      {"start.reacquisition_min_s", "from 0 to 3600"},
      {"start.reacquisition_max_s", "from 0 to 3600"},
      {"start.ephemeris_decoding_s", "from 0 to 3600"},
      {"clock.initial_offset_ms", "from 0 to 1000"},
      {"clock.initial_drift_sigma_ns_per_s", "from 0 to 100000"},
      {"clock.h0_s", "from 0 to 1e-15"},
      {"clock.h_minus2_per_s", "from 0 to 1e-15"},
      {"clock.jump_threshold_ms", "from 0.5 to 1000000"},
      {"body_frame.com_radius_mm", "from 0 to 1000"},
      {"body_frame.pco_bias_mm", "from 0 to 1000"},
      {"body_frame.pco_noise_mm", "from 0 to 1000"},
      {"body_frame.antenna_direction_arcsec", "from 0 to 100000"},
      {"body_frame.attitude_knowledge_arcsec", "from 0 to 100000"},
  };
  constexpr Number kElsewhere[] = {
      {"navigation.carrier_phase.success_rate_min", "from 0.5 to 1"},
      {"navigation.carrier_phase.ratio_min", "from 1 to 1000"},
      {"navigation.carrier_phase.pair_timeout_s", "from 0.1 to 600"},
      {"navigation.carrier_phase.antenna_offset_sigma_mm", "above 0, up to 1000"},
      {"navigation.carrier_phase.phase_centre_jitter_mm", "above 0, up to 100"},
      {"navigation.carrier_phase.phase_wander_sigma_mm", "from 0 to 100"},
      {"navigation.carrier_phase.phase_wander_time_s", "from 0 to 1000000"},
      {"navigation.carrier_phase.code_bias_sigma_m", "above 0, up to 100"},
      {"navigation.carrier_phase.initial_velocity_sigma_mps", "above 0, up to 100"},
      {"navigation.acceleration_sigma_nmps2", "above 0, up to 1000000"},
      {"navigation.acceleration_correlation_time_s", "above 0, up to 1000000"},
      {"navigation.maneuver_sigma_mmps", "above 0, up to 1000"},
      {"navigation.maneuver_sigma_percent", "from 0 to 100"},
      {"constellation.orbit_error_radial_m", "from 0 to 10000"},
      {"constellation.orbit_error_transverse_m", "from 0 to 10000"},
      {"constellation.orbit_error_normal_m", "from 0 to 10000"},
      {"constellation.clock_error_ns", "from 0 to 10000"},
      {"spacecraft.servicer.mass_sigma_kg", "from 0 to 1000"},
      {"links.crosslink.silence_duration_s", "from 0 to 10000000"},
  };
  std::vector<BadValue> all;
  const auto add = [&](const std::string& key, const char* accepted) {
    for (const char* value : {"-1000.5", "100000000.5"})
      all.push_back({key, value, std::string(value) == "-1000.5" ? "the number -1000.5" : "the number 100000000.5",
                     std::string("a number ") + accepted});
    all.push_back({key, "nan", "nan", std::string("a number ") + accepted});
  };
  for (const Number& number : kNumbers) add(std::string(kSensor) + "." + number.key, number.accepted);
  for (const Number& number : kElsewhere) add(number.key, number.accepted);
  return all;
}

TEST(BadGnssValue, EndsWithOneMessageThatNamesItsRange) {
  for (const BadValue& bad : bad_values()) {
    const std::string assignment = bad.key + "=" + bad.value;
    const std::string message = message_of(gnss_mission(), {assignment});
    EXPECT_NE(message.find(bad.key + ": found " + bad.found + "; accepted: " + bad.accepted), std::string::npos)
        << bad << " ended with: " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << bad;
  }
}

TEST(BadGnssValue, WordsThatAreNone) {
  const std::string sensor(kSensor);
  const BadValue words[] = {
      {sensor + ".source", "testbed", "the text \"testbed\"", "digital, recorded or rinex"},
      {sensor + ".gps_ephemeris", "rawephemb", "the text \"rawephemb\" (did you mean rawephem?)",
       "rawephem or gpsephem"},
      {sensor + ".tracking.l1_code", "codeless", "the text \"codeless\"", "ca or p"},
      {sensor + ".start.mode", "lukewarm", "the text \"lukewarm\"", "cold, warm or hot"},
      {sensor + ".ionosphere", "1", "the integer 1", "true or false"},
      {sensor + ".tracking.thermal_noise", "2", "the integer 2", "true or false"},
      {"navigation.carrier_phase.resolve_ambiguities", "3", "the integer 3", "true or false"},
  };
  for (const BadValue& bad : words) {
    const std::string message = message_of(gnss_mission(), {bad.key + "=" + bad.value});
    EXPECT_NE(message.find(bad.key + ": found " + bad.found + "; accepted: " + bad.accepted), std::string::npos)
        << bad << " ended with: " << message;
  }
}

TEST(GnssKeys, GoodOnesArriveInSiUnits) {
  const std::string text =
      changed(gnss_mission(), "[mission]",
              "[[burn]]\ntime_h = 0.5\ndv_rtn_mmps = [1, -2, 3]\n[navigation]\n"
              "acceleration_sigma_nmps2 = 20\nmaneuver_sigma_mmps = 0.5\nmaneuver_sigma_percent = 3\n"
              "[navigation.carrier_phase]\nantenna_offset_sigma_mm = 4\npair_timeout_s = 7\n"
              "phase_wander_sigma_mm = 0.5\nphase_wander_time_s = 60\n"
              "[links.crosslink]\nsilence_begin_s = 100\nsilence_duration_s = 600\n[mission]");
  const Mission mission = parse_mission(text, "m.toml");
  EXPECT_EQ(sensor_of<GnssSensor>(mission).observed, "target");
  EXPECT_EQ(sensor_of<GnssSensor>(mission, "target").receiver.output.period_s, 5.0);
  ASSERT_EQ(mission.burns.size(), 1U);
  EXPECT_EQ((mission.burns[0].time - mission.epoch).ns, std::int64_t{1800} * 1000000000);
  EXPECT_DOUBLE_EQ(mission.burns[0].dv_rtn.x(), 0.001);
  EXPECT_DOUBLE_EQ(mission.burns[0].dv_rtn.y(), -0.002);
  EXPECT_DOUBLE_EQ(mission.burns[0].dv_rtn.z(), 0.003);
  const auto& shared = shared_settings<GnssShared>(mission);
  EXPECT_DOUBLE_EQ(shared.carrier.antenna_offset_sigma_m, 0.004);
  EXPECT_DOUBLE_EQ(mission.navigation.configuration.acceleration_sigma, 2e-8);
  EXPECT_DOUBLE_EQ(mission.navigation.thruster.sigma_mps, 5e-4);
  EXPECT_DOUBLE_EQ(mission.navigation.thruster.sigma_relative, 0.03);
  EXPECT_DOUBLE_EQ(shared.carrier.phase_wander_sigma_m, 5e-4);
  EXPECT_DOUBLE_EQ(shared.carrier.phase_wander_time_s, 60.0);
  EXPECT_EQ(shared.carrier.pair_wait_ns, std::int64_t{7} * 1000000000);
  EXPECT_EQ(shared.crosslink.silence_begin_s, 100.0);
  EXPECT_EQ(shared.crosslink.silence_duration_s, 600.0);
}

TEST(GnssKeys, OfTheCodeArrive) {
  using twins::gnss::TrackingSettings;
  const std::string text = changed(
      gnss_mission(), kPartner,
      "partner = \"target\", link_budget = { antenna_pattern = \"./pattern.csv\" }, tracking = { l1_code = \"p\", "
      "w_code_rate_khz = 500, code_wander_l1_zenith_m = 0.1, code_wander_l1_horizon_m = 0.2, code_wander_l2_zenith_m = "
      "0.3, code_wander_l2_horizon_m = 0.4, "
      "code_wander_time_s = 120 }");
  const auto receiver = sensor_of<GnssSensor>(parse_mission(text, "m.toml")).receiver;
  EXPECT_EQ(receiver.tracking.l1_code, twins::gnss::L1Code::kP);
  EXPECT_EQ(receiver.tracking.w_code_rate_khz, 500.0);
  EXPECT_EQ(receiver.tracking.code_wander_l1, (twins::gnss::CodeWander{0.1, 0.2}));
  EXPECT_EQ(receiver.tracking.code_wander_l2, (twins::gnss::CodeWander{0.3, 0.4}));
  EXPECT_EQ(receiver.tracking.code_wander_time_s, 120.0);
  EXPECT_EQ(receiver.link_budget.antenna_pattern.filename(), "pattern.csv");
  // Those that a mission omits are the ones without these errors.
  const auto plain = sensor_of<GnssSensor>(parse_mission(gnss_mission(), "m.toml")).receiver;
  EXPECT_EQ(plain.tracking, TrackingSettings{});
  EXPECT_EQ(plain.link_budget, twins::gnss::LinkBudgetSettings{});
}

}  // namespace
}  // namespace vbar::mission::test
