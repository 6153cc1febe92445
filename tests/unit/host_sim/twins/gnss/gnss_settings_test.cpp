#include "host_sim/twins/gnss/gnss_settings.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace vbar::twins::gnss {
namespace {

std::string refusal(const GnssReceiverSettings& settings) {
  try {
    check(settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

template <class Change>
std::string refusal_after(const Change& change) {
  GnssReceiverSettings settings;
  change(settings);
  return refusal(settings);
}

using Settings = GnssReceiverSettings;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Appendix A of the paper, both tables.
TEST(GnssSettings, DefaultsAreThePapers) {
  const Settings settings;
  EXPECT_EQ(refusal(settings), "accepted");
  EXPECT_EQ(settings.visibility.transmit_aperture_deg, 170.0);
  EXPECT_EQ(settings.visibility.receiver_mask_deg, 190.0);
  EXPECT_EQ(settings.visibility.horizon_mask_deg, -20.0);
  EXPECT_EQ(settings.link_budget.lna_gain_db, 33.0);
  EXPECT_EQ(settings.body_frame.com_radius_mm, 3.0);
  EXPECT_EQ(settings.body_frame.pco_bias_mm, 5.0);
  EXPECT_EQ(settings.body_frame.pco_noise_mm, 1.0);
  EXPECT_EQ(settings.body_frame.antenna_direction_arcsec, 30.0);
  EXPECT_EQ(settings.body_frame.attitude_knowledge_arcsec, 20.0);
  EXPECT_EQ(settings.start.mode, StartMode::kWarm);
}

TEST(GnssSettings, RefusesWithOneClearError) {
  EXPECT_EQ(refusal_after([](Settings& s) { s.visibility.receiver_mask_deg = 400.0; }),
            "receiver_mask_deg = 400: accepted is 1 to 360");
  EXPECT_EQ(refusal_after([](Settings& s) { s.visibility.horizon_mask_deg = kNan; }),
            "horizon_mask_deg = nan: accepted is -90 to 89");
  EXPECT_EQ(refusal_after([](Settings& s) { s.link_budget.lna_gain_db = -1.0; }),
            "lna_gain_db = -1: accepted is 0 to 80");
  EXPECT_EQ(refusal_after([](Settings& s) { s.tracking.integration_s = 0.0; }),
            "integration_s = 0: accepted is 0.001 to 1");
  EXPECT_EQ(refusal_after([](Settings& s) { s.tracking.loss_threshold_dbhz = 35.0; }),
            "loss_threshold_dbhz = 35 is above acquisition_threshold_dbhz = 33");
  EXPECT_EQ(refusal_after([](Settings& s) { s.tracking.undetected_slip_fraction = 2.0; }),
            "undetected_slip_fraction = 2: accepted is 0 to 1");
  EXPECT_EQ(refusal_after([](Settings& s) { s.tracking.carrier_wander_sigma_mm = -1.0; }),
            "carrier_wander_sigma_mm = -1: accepted is 0 to 100");
  EXPECT_EQ(refusal_after([](Settings& s) { s.tracking.carrier_wander_time_s = 0.0; }),
            "carrier_wander_time_s = 0: accepted is 0.001 to 1000000");
  EXPECT_EQ(refusal_after([](Settings& s) { s.start.cold_search_min_s = 100.0; }),
            "cold_search_min_s = 100 is above cold_search_max_s = 60");
  EXPECT_EQ(refusal_after([](Settings& s) { s.clock.jump_threshold_ms = 0.1; }),
            "jump_threshold_ms = 0.1: accepted is 0.5 to 100");
  EXPECT_EQ(refusal_after([](Settings& s) { s.body_frame.boresight_in_body.setZero(); }),
            "boresight_in_body has length 0: accepted is a unit vector");
  EXPECT_EQ(refusal_after([](Settings& s) { s.body_frame.pco_bias_mm = std::numeric_limits<double>::infinity(); }),
            "pco_bias_mm = inf: accepted is 0 to 10000");
  EXPECT_EQ(refusal_after([](Settings& s) { s.output.period_s = 0.01; }), "period_s = 0.01: accepted is 0.1 to 60");
  EXPECT_EQ(refusal_after([](Settings& s) { s.output.period_s = 0.1234567; }),
            "period_s = 0.1234567: accepted is an integer number of milliseconds");
}

}  // namespace
}  // namespace vbar::twins::gnss
