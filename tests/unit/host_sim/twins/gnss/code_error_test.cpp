// What a receiver's code has beyond the noise of a known code in white noise: the loss by tracking P(Y) without its
// encryption, an error correlated in time, and the pattern of an antenna of a file.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/twins/gnss/gnss_receiver.h"
#include "tests/support/gnss_scene.h"

namespace vbar::twins::gnss {
namespace {

using Channel = std::pair<SatelliteId, Signal>;

/// 1 + 5e5/(2e5) = 3.5 at 50 dB-Hz: 5.441 dB.
TEST(Semicodeless, LossByHand) {
  EXPECT_NEAR(semicodeless_cn0_dbhz(47.0, 50.0, 500.0), 47.0 - 5.441, 1e-3);
  EXPECT_EQ(semicodeless_cn0_dbhz(47.0, 50.0, 0.0), 47.0);
  // Weak signals: two dB for each dB of both.
  EXPECT_NEAR(semicodeless_cn0_dbhz(21.0, 21.0, 500.0) - semicodeless_cn0_dbhz(20.0, 20.0, 500.0), 2.0, 1e-3);
}

/// Chips of W, +1 or -1, in noise: the in-phase sum of one frequency over each chip times both sums of the other. The
/// mean of the product, squared, over the variance of its quadrature is 2 T C/N0. 400,000 chips: some 1 % of the
/// variance and of the mean.
TEST(Semicodeless, IsThatOfAProductOfSimulatedChips) {
  constexpr double kRate_hz = 500e3, kOther = 1.5e5, kOwn = 0.8e5;  // C/N0, Hz
  std::mt19937_64 engine(3);
  std::normal_distribution<double> noise;
  const auto amplitude = [](double cn0) { return std::sqrt(2.0 * cn0 / kRate_hz); };
  constexpr int kChips = 400'000;
  double sum = 0.0, squares = 0.0;
  for (int k = 0; k < kChips; ++k) {
    const double w = (engine() & 1U) != 0 ? 1.0 : -1.0;
    const double estimate = w * amplitude(kOther) + noise(engine);
    sum += estimate * (w * amplitude(kOwn) + noise(engine));
    const double quadrature = estimate * noise(engine);
    squares += quadrature * quadrature;
  }
  const double mean = sum / kChips, effective = 0.5 * kRate_hz * mean * mean / (squares / kChips);
  const auto dbhz = [](double cn0) { return 10.0 * std::log10(cn0); };
  EXPECT_NEAR(dbhz(effective), semicodeless_cn0_dbhz(dbhz(kOwn), dbhz(kOther), 1e-3 * kRate_hz), 0.1);
}

/// L2 is specified 3 dB below C/A, as P(Y) of L1 is: both are tracked with the same C/N0 and, with the same chips, have
/// the same noise. C/A remains what L1 is acquired and reported by.
TEST(Semicodeless, ReceiverTracksBothPCodesAlike) {
  GnssReceiverSettings settings;
  settings.tracking.l1_code = L1Code::kP;
  settings.tracking.w_code_rate_khz = 500.0;
  settings.tracking.acquisition_threshold_dbhz = settings.tracking.loss_threshold_dbhz = 15.0;
  GnssReceiver plain({}, test::constellation(11), test::data_directory(), 11, "servicer");
  GnssReceiver receiver(settings, test::constellation(11), test::data_directory(), 11, "servicer");
  std::map<Channel, oem::RangeRecord> last;
  double squares = 0.0;
  int count = 0, pairs = 0;
  for (int k = 0; k < 400; ++k) {
    plain.bytes_at(test::in_orbit(10.0 * k));
    receiver.bytes_at(test::in_orbit(10.0 * k));
    std::map<Channel, oem::RangeRecord> now;
    for (std::size_t n = 0; n < receiver.observations().size(); ++n) {
      const oem::RangeRecord& record = receiver.observations()[n];
      now[{record.satellite, record.signal}] = record;
      if (record.satellite.system != System::kGps) continue;
      const double error_m = record.pseudorange_m - receiver.truth().observations[n].code_m;
      squares += std::pow(error_m / record.pseudorange_sigma_m, 2);
      ++count;
    }
    for (const oem::RangeRecord& record : plain.observations()) {
      if (record.signal != Signal::kGpsL1) continue;
      EXPECT_EQ((now.at({record.satellite, record.signal})).cn0_dbhz, record.cn0_dbhz);
    }
    for (const auto& [channel, record] : now) {
      const auto l2 = now.find({channel.first, Signal::kGpsL2});
      if (channel.second != Signal::kGpsL1 || l2 == now.end()) continue;
      const double p_dbhz = record.cn0_dbhz - 3.0;
      EXPECT_NEAR(l2->second.cn0_dbhz, semicodeless_cn0_dbhz(p_dbhz, p_dbhz, 500.0), 1e-9);
      EXPECT_NEAR(record.pseudorange_sigma_m, l2->second.pseudorange_sigma_m, 1e-9);
      ++pairs;
    }
  }
  EXPECT_GT(pairs, 2000);
  EXPECT_NEAR(squares / count, 1.0, 4.0 * std::sqrt(2.0 / count));
}

TEST(CodeWander, SigmaOfAnElevation) {
  const CodeWander wander{0.03, 0.04};
  EXPECT_DOUBLE_EQ(wander.sigma_m(1.0), 0.03);
  EXPECT_DOUBLE_EQ(wander.sigma_m(0.0), 0.04);
  EXPECT_DOUBLE_EQ(wander.sigma_m(std::sqrt(0.5)), std::sqrt(0.5 * (0.03 * 0.03 + 0.04 * 0.04)));
  EXPECT_TRUE(CodeWander{}.is_none());
}

/// The wander is the only difference to the same receiver without it. 100 s at every 50 s: each value has a correlation
/// of exp(-1/2) with the next one, so that n values weigh as n (1 - exp(-1)) / (1 + exp(-1)) = 0.46 n independent
/// squares.
TEST(CodeWander, IsThatOfASeparateStreamOfEachCode) {
  GnssReceiverSettings wandering;
  wandering.tracking.code_wander_l1 = {0.2, 0.5};
  wandering.tracking.code_wander_l2 = {0.3, 0.1};
  wandering.tracking.code_wander_time_s = 100.0;
  GnssReceiver plain({}, test::constellation(11), test::data_directory(), 11, "servicer");
  GnssReceiver receiver(wandering, test::constellation(11), test::data_directory(), 11, "servicer");
  std::map<Channel, double> before;
  double squares = 0.0, products = 0.0, across_signals = 0.0;
  int count = 0, pairs = 0, signal_pairs = 0;
  for (int k = 0; k < 400; ++k) {
    receiver.bytes_at(test::in_orbit(50.0 * k));
    plain.bytes_at(test::in_orbit(50.0 * k));
    ASSERT_EQ(receiver.observations().size(), plain.observations().size());
    std::map<Channel, double> now;
    for (std::size_t n = 0; n < receiver.observations().size(); ++n) {
      const oem::RangeRecord& record = receiver.observations()[n];
      const ObservationTruth& truth = receiver.truth().observations[n];
      EXPECT_EQ(record.carrier_phase_cycles, plain.observations()[n].carrier_phase_cycles);
      const double wander_m = record.pseudorange_m - plain.observations()[n].pseudorange_m;
      EXPECT_NEAR(wander_m, truth.code_wander_m, 1e-7);
      const CodeWander& sigma = code_wander_of(wandering.tracking, record.signal);
      const double unit = wander_m / sigma.sigma_m(std::sin(truth.elevation));
      now[{record.satellite, record.signal}] = unit;
      squares += unit * unit;
      ++count;
      if (const auto last = before.find({record.satellite, record.signal}); last != before.end()) {
        products += unit * last->second;
        ++pairs;
      }
      const auto first = now.find({record.satellite, Signal::kGpsL1});
      if (record.signal == Signal::kGpsL2 && first != now.end()) {
        across_signals += unit * first->second;
        ++signal_pairs;
      }
    }
    before = now;
  }
  ASSERT_GT(count, 5000);
  ASSERT_GT(signal_pairs, 1500);
  EXPECT_NEAR(squares / count, 1.0, 4.0 * std::sqrt(2.0 / (0.46 * count)));
  EXPECT_NEAR(products / pairs, std::exp(-0.5), 4.0 * std::sqrt(1.4 / (0.46 * pairs)));
  EXPECT_NEAR(across_signals / signal_pairs, 0.0, 4.0 * std::sqrt(1.0 / (0.46 * signal_pairs)));
}

/// A file of the test with this text behind its first line.
std::filesystem::path pattern_file(const std::string& rows) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "vbar_antenna_pattern.csv";
  std::ofstream(file) << "boresight_angle_deg,attenuation_dB\n" << rows;
  return file;
}

TEST(AntennaPatternFile, IsThatOfTheReceiver) {
  GnssReceiverSettings settings;
  settings.link_budget.antenna_pattern = pattern_file("0,3\n180,3\n");
  GnssReceiver receiver(settings, test::constellation(11), test::data_directory(), 11, "servicer");
  for (int k = 0; k < 3; ++k) receiver.bytes_at(test::in_orbit(10.0 * k));
  ASSERT_FALSE(receiver.observations().empty());
  for (std::size_t n = 0; n < receiver.observations().size(); ++n) {
    const oem::RangeRecord& record = receiver.observations()[n];
    EXPECT_NEAR(
        record.cn0_dbhz,
        carrier_to_noise_dbhz(settings.link_budget, record.signal, receiver.truth().observations[n].range_m, 3.0),
        1e-9);
  }
  std::filesystem::remove(settings.link_budget.antenna_pattern);
}

TEST(AntennaPatternFile, NamesTheLineThatIsWrong) {
  const auto error = [](const std::string& rows) -> std::string {
    const std::filesystem::path file = pattern_file(rows);
    try {
      static_cast<void>(AntennaPattern::read(file));
    } catch (const std::exception& what) {
      return what.what();
    }
    return "";
  };
  EXPECT_THAT(error("0,0\n10,x\n180,1\n"), testing::HasSubstr("vbar_antenna_pattern.csv:3: "));
  EXPECT_THAT(error("5,0\n180,1\n"), testing::HasSubstr("vbar_antenna_pattern.csv:2: "));
  EXPECT_THAT(error("0,0\n90,1\n"), testing::HasSubstr("the angles must reach 180 deg"));
}

TEST(CodeSettings, AreRefusedInOneSentence) {
  const auto error = [](const TrackingSettings& tracking) -> std::string {
    GnssReceiverSettings settings;
    settings.tracking = tracking;
    try {
      check(settings);
    } catch (const std::invalid_argument& what) {
      return what.what();
    }
    return "";
  };
  TrackingSettings rate, zenith, time;
  rate.w_code_rate_khz = -1.0;
  zenith.code_wander_l2.zenith_m = std::nan("");
  time.code_wander_time_s = 0.0;
  EXPECT_EQ(error(rate), "w_code_rate_khz = -1: accepted is 0 to 10230");
  EXPECT_EQ(error(zenith), "code_wander_l2_zenith_m = nan: accepted is 0 to 100");
  EXPECT_EQ(error(time), "code_wander_time_s = 0: accepted is 0.001 to 1000000");
}

}  // namespace
}  // namespace vbar::twins::gnss
