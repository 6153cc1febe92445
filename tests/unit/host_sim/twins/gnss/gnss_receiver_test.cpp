#include "host_sim/twins/gnss/gnss_receiver.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "host_sim/twins/gnss/gnss_settings.h"
#include "tests/support/accuracy.h"
#include "tests/support/gnss_scene.h"

namespace vbar::twins::gnss {

namespace {

using fsw::Vector3;
using Key = std::pair<SatelliteId, Signal>;

GnssReceiverSettings quiet() {
  GnssReceiverSettings settings;
  settings.tracking.thermal_noise = false;
  settings.tracking.cycle_slips_per_hour = 0.0;
  settings.start.mode = StartMode::kHot;
  settings.start.reacquisition_min_s = settings.start.reacquisition_max_s = 0.0;
  return settings;
}

GnssReceiver receiver(const GnssReceiverSettings& settings, std::uint64_t seed = 1,
                      const std::string& name = "servicer") {
  return {settings, test::constellation(seed), test::data_directory(), seed, name};
}

std::map<Key, oem::RangeRecord> by_signal(const GnssReceiver& receiver) {
  std::map<Key, oem::RangeRecord> records;
  for (const oem::RangeRecord& record : receiver.observations())
    records.emplace(Key{record.satellite, record.signal}, record);
  return records;
}

std::map<Key, ObservationTruth> truth_by_signal(const GnssReceiver& receiver) {
  std::map<Key, ObservationTruth> truths;
  for (const ObservationTruth& truth : receiver.truth().observations)
    truths.emplace(Key{truth.satellite, truth.signal}, truth);
  return truths;
}

std::map<Key, double> residual_cycles(const GnssReceiver& a, const GnssReceiver& b) {
  std::map<Key, double> differences;
  const auto records_b = by_signal(b);
  const auto truths_a = truth_by_signal(a);
  const auto truths_b = truth_by_signal(b);
  for (const auto& [key, record] : by_signal(a)) {
    const auto other = records_b.find(key);
    if (other == records_b.end()) continue;
    // Ranges are the only truth taken off: clocks, satellites and signal biases must cancel by themselves.
    const double range_m = truths_a.at(key).range_m - truths_b.at(key).range_m;
    differences[key] =
        record.carrier_phase_cycles - other->second.carrier_phase_cycles - range_m / wavelength_m(key.second);
  }
  return differences;
}

// Without noise the double difference of carriers minus that of true ranges is an integer for each pair of satellites
// of a signal. What is left of it over 8 m: ionosphere (gradient 1e-6: 1e-5 m), satellite clocks over the difference of
// transmission times (0.8 ms times 1e-10: 1e-13 s), rounding of 1e8 cycles in doubles (3e-8): under 1e-3 cycles; and
// the satellites' motion over the receivers' clock difference is in the ranges.
TEST(GnssReceiver, DoubleDifferencesHoldIntegers) {
  const auto satellites = test::constellation(3);
  GnssReceiver a(quiet(), satellites, test::data_directory(), 3, "servicer");
  GnssReceiver b(quiet(), satellites, test::data_directory(), 3, "target");
  accuracy::Largest largest;
  long pairs = 0;
  for (int k = 0; k < 60; ++k) {
    a.bytes_at(test::in_orbit(60.0 * k));
    b.bytes_at(test::in_orbit(60.0 * k, Vector3(1.2, -7.9, 0.5)));
    EXPECT_GT(std::abs(a.truth().clock_offset_s - b.truth().clock_offset_s), 1e-5);
    std::map<Signal, double> reference;
    for (const auto& [key, cycles] : residual_cycles(a, b)) {
      const auto [first, is_first] = reference.emplace(key.second, cycles);
      if (is_first) continue;
      const double difference = cycles - first->second;
      largest.add(std::abs(difference - std::round(difference)));
      ++pairs;
    }
  }
  EXPECT_GT(pairs, 1000);
  accuracy::expect_below("GNSS emulator: double-differenced carriers are integers, noise off",
                         "the nearest integers, 60 epochs, all signals", largest, 1e-3, "cycles");
}

// Without noise the geometry-free combination of an arc changes by its ionosphere alone, and Melbourne-Wubbena not at
// all. Rounding of 4e7 m in doubles: 1e-8 m, times 4.5 wavelength factors.
TEST(GnssReceiver, CombinationsAreConstantOverArcs) {
  GnssReceiver subject = receiver(quiet());
  constexpr double kF1 = fsw::gnss::kL1_Hz;
  constexpr double kF2 = fsw::gnss::kL2_Hz;
  std::map<SatelliteId, std::pair<double, double>> first;
  int compared = 0;
  for (int k = 0; k < 100; ++k) {
    subject.bytes_at(test::in_orbit(10.0 * k));
    const auto records = by_signal(subject);
    const auto truths = truth_by_signal(subject);
    for (const auto& [key, l1] : records) {
      const auto other = records.find({key.first, Signal::kGpsL2});
      if (key.second != Signal::kGpsL1 || other == records.end()) continue;
      const oem::RangeRecord& l2 = other->second;
      const double phase1_m = l1.carrier_phase_cycles * wavelength_m(Signal::kGpsL1);
      const double phase2_m = l2.carrier_phase_cycles * wavelength_m(Signal::kGpsL2);
      const double ionosphere_m = truths.at(other->first).ionosphere_m - truths.at(key).ionosphere_m;
      const double geometry_free_m = phase1_m - phase2_m - ionosphere_m;
      const double wide_lane_m = (kF1 * phase1_m - kF2 * phase2_m) / (kF1 - kF2) -
                                 (kF1 * l1.pseudorange_m + kF2 * l2.pseudorange_m) / (kF1 + kF2);
      const auto [begin, is_first] = first.emplace(key.first, std::pair{geometry_free_m, wide_lane_m});
      if (is_first || l1.lock_time_s < 10.0) {
        begin->second = {geometry_free_m, wide_lane_m};
        continue;
      }
      EXPECT_NEAR(geometry_free_m, begin->second.first, 2e-7) << name_of(key.first);
      EXPECT_NEAR(wide_lane_m, begin->second.second, 2e-6) << name_of(key.first);
      ++compared;
    }
  }
  EXPECT_GT(compared, 800);
}

// Satellites of GPS in view over a day.
struct InView {
  accuracy::Smallest least;
  accuracy::Largest most;
  double mean = 0.0;
};
InView gps_in_view(const GnssReceiverSettings& settings) {
  constexpr int kMinutes = 1440;
  GnssReceiver subject = receiver(settings);
  InView view;
  for (int k = 0; k < kMinutes; ++k) {
    subject.bytes_at(test::in_orbit(60.0 * k));
    const long gps = std::ranges::count(subject.observations(), Signal::kGpsL1, &oem::RangeRecord::signal);
    view.least.add(gps);
    view.most.add(gps);
    view.mean += static_cast<double>(gps) / kMinutes;
  }
  return view;
}

// What 31 satellites on a sphere of 26,560 km leave above an elevation, seen from 7087.3 km: the cap of half angle
// acos(7087.3 cos(el) / 26560) - el. Above -20 deg, the horizon mask, 0.548 of the sphere: 17.0; above -5 deg, where
// the receiver mask of 190 deg about the zenith ends, 0.410: 12.7. The real orbits do not fill the sphere evenly: 0.5.
TEST(GnssReceiver, SeesTheSatellitesOfItsMasks) {
  GnssReceiverSettings horizon_only = quiet();
  horizon_only.visibility.receiver_mask_deg = 360.0;
  const InView to_horizon = gps_in_view(horizon_only);
  EXPECT_NEAR(to_horizon.mean, 17.0, 0.5);
  EXPECT_GE(to_horizon.least, 13);  // the range that an independent count of the same file's satellites gave
  EXPECT_LE(to_horizon.most, 22);
  const InView masked = gps_in_view(quiet());
  EXPECT_NEAR(masked.mean, 12.7, 0.5);
  EXPECT_GE(masked.least, 8);
}

// The Doppler is minus the carrier's rate: central differences over 2 s of a signal whose jerk in orbit is below 2e-2
// m/s^3 err by jerk/6, plus what the clock's random walk adds in a second (1e-10 s/s: 0.03 m/s).
TEST(GnssReceiver, DopplerIsTheCarriersRate) {
  GnssReceiverSettings settings = quiet();
  settings.clock.h0_s = settings.clock.h_minus2_per_s = 0.0;
  settings.body_frame.pco_noise_mm = 0.0;
  settings.ionosphere = false;
  GnssReceiver subject = receiver(settings);
  std::vector<std::map<Key, oem::RangeRecord>> epochs;
  for (int k = 0; k < 3; ++k) {
    subject.bytes_at(test::in_orbit(1000.0 + k));
    epochs.push_back(by_signal(subject));
  }
  int compared = 0;
  for (const auto& [key, record] : epochs[1]) {
    if (!epochs[0].contains(key) || !epochs[2].contains(key)) continue;
    const double rate_hz = (epochs[2].at(key).carrier_phase_cycles - epochs[0].at(key).carrier_phase_cycles) / 2.0;
    EXPECT_NEAR(-rate_hz * wavelength_m(key.second), record.doppler_hz * wavelength_m(key.second), 5e-3)
        << name_of(key.first);
    ++compared;
  }
  EXPECT_GT(compared, 20);
}

// The receiver's own solution after a minute: GPS code with uncorrected satellites and, at 709 km, a twentieth of the
// ionosphere. 10 m and 0.2 m/s are 5 sigma of such fixes.
TEST(GnssReceiver, FindsItselfAndItsClock) {
  GnssReceiver subject = receiver({});
  for (int k = 0; k < 30; ++k) {
    const std::vector<std::uint8_t> bytes = subject.bytes_at(test::in_orbit(10.0 * k));
    // BESTXYZ (28 + 112 + 4 bytes) and TIME (28 + 44 + 4) come last.
    ASSERT_GE(bytes.size(), 220U);
    const std::size_t xyz = bytes.size() - 76 - 144;
    const std::size_t time = bytes.size() - 76;
    const auto f64 = [&bytes](std::size_t at) {
      std::uint64_t bits = 0;
      for (int b = 7; b >= 0; --b) bits = bits << 8U | bytes[at + static_cast<std::size_t>(b)];
      return std::bit_cast<double>(bits);
    };
    ASSERT_EQ(bytes[xyz + 4] + 256 * bytes[xyz + 5], 241);
    ASSERT_EQ(bytes[time + 4] + 256 * bytes[time + 5], 101);
    const bool solved = bytes[xyz + 28] == 0;
    EXPECT_EQ(solved, k >= 4) << k;  // ephemerides take half a minute from being found, within 8 s
    EXPECT_EQ(bytes[xyz + 13], solved ? 160 : k == 0 ? 60 : 100) << k;  // time status: fine, approximate, coarse
    if (!solved) continue;
    const Vector3 position(f64(xyz + 36), f64(xyz + 44), f64(xyz + 52));
    EXPECT_LT((position - subject.truth().antenna_ecef).norm(), 10.0);
    EXPECT_NEAR(f64(time + 32), subject.truth().clock_offset_s, 10.0 / fsw::gnss::kSpeedOfLight);
    EXPECT_EQ(f64(time + 48), -15.0);
    EXPECT_EQ(bytes[time + 56] + 256 * bytes[time + 57], 2011);
  }
}

// Where the antenna is: 0.3 m above the centre of mass of a zenith-pointing body, at the instant at which the
// receiver's clock shows the epoch; 3 + 5 mm and 5 sigma of 1 mm noise off.
TEST(GnssReceiver, AntennaIsWhereTheBodyCarriesIt) {
  GnssReceiver subject = receiver({});
  for (int k = 0; k < 10; ++k) {
    const double t = 600.0 * k;
    const BodyTruth body = test::in_orbit(t);
    subject.bytes_at(body);
    // The orbit itself, a fraction of a millisecond away from the epoch.
    const double early_s = -subject.truth().clock_offset_s;
    BodyTruth then = test::in_orbit(t + 1.0);
    const double rate =
        std::acos(std::clamp(then.position_eci.normalized().dot(body.position_eci.normalized()), -1.0, 1.0));
    const Vector3 normal = body.position_eci.cross(body.velocity_eci).normalized();
    const Vector3 com = Eigen::AngleAxisd(rate * early_s, normal) * body.position_eci;
    const Vector3 antenna_eci = com + 0.3 * com.normalized();
    const double turn = fsw::gnss::kEarthRateGps * (t + early_s);
    const Vector3 expected = Eigen::AngleAxisd(-turn, Vector3::UnitZ()) * antenna_eci;
    EXPECT_LT((subject.truth().antenna_ecef - expected).norm(), 13e-3);
    EXPECT_GT((subject.truth().antenna_ecef - expected).norm(), 0.5e-3);
  }
}

// Same seed, same bytes; BeiDou left out changes no bit of what GPS measures.
TEST(GnssReceiver, IsAFunctionOfTheSeed) {
  GnssReceiver a = receiver({}, 5);
  GnssReceiver b = receiver({}, 5);
  GnssReceiver c = receiver({}, 6);
  const auto gps_only = test::constellation(5, {.galileo = SatelliteSet::kNone, .beidou = SatelliteSet::kNone});
  GnssReceiver d({}, gps_only, test::data_directory(), 5, "servicer");
  for (int k = 0; k < 20; ++k) {
    const auto bytes = a.bytes_at(test::in_orbit(10.0 * k));
    EXPECT_EQ(bytes, b.bytes_at(test::in_orbit(10.0 * k)));
    // Switched on, all know nothing alike.
    EXPECT_EQ(bytes == c.bytes_at(test::in_orbit(10.0 * k)), k == 0);
    d.bytes_at(test::in_orbit(10.0 * k));
    const auto all = by_signal(a);
    for (const auto& [key, record] : by_signal(d)) {
      EXPECT_EQ(record.pseudorange_m, all.at(key).pseudorange_m);
      EXPECT_EQ(record.carrier_phase_cycles, all.at(key).carrier_phase_cycles);
    }
  }
}

// A cold receiver knows no time until its first satellite, then counts up; a hot one knows all at once.
TEST(GnssReceiver, ColdStartTakesItsTime) {
  GnssReceiverSettings settings;
  settings.start.mode = StartMode::kCold;
  GnssReceiver cold = receiver(settings);
  settings.start.mode = StartMode::kHot;
  GnssReceiver hot = receiver(settings);
  for (int k = 0; k <= 120; ++k) {
    const auto cold_bytes = cold.bytes_at(test::in_orbit(k));
    const auto hot_bytes = hot.bytes_at(test::in_orbit(k));
    if (k < 20) {
      EXPECT_TRUE(cold.observations().empty());
      EXPECT_EQ(cold_bytes[13], 20);                        // time unknown
      EXPECT_EQ(cold_bytes[14] + 256 * cold_bytes[15], 0);  // and not told
    }
    if (k == 9) {
      EXPECT_EQ(hot_bytes[13], 160);
    }
    if (k == 120) {
      EXPECT_EQ(cold_bytes[13], 160);
    }
    EXPECT_GE(hot.observations().size(), cold.observations().size());
  }
}

// Clocks of both sides are ms apart and are set by whole milliseconds: code and carrier jump together.
TEST(GnssReceiver, ClockJumpsMoveCodeAndCarrierAlike) {
  GnssReceiverSettings settings = quiet();
  settings.clock.initial_drift_sigma_ns_per_s = 5000.0;
  GnssReceiver subject = receiver(settings, 2);
  std::map<Key, oem::RangeRecord> before;
  int jumps = 0;
  for (int k = 0; k < 400; ++k) {
    subject.bytes_at(test::in_orbit(k));
    const auto now = by_signal(subject);
    if (subject.truth().clock_jumps > jumps) {
      jumps = subject.truth().clock_jumps;
      for (const auto& [key, record] : now) {
        const auto last = before.find(key);
        if (last == before.end()) continue;
        const double code_m = record.pseudorange_m - last->second.pseudorange_m;
        const double carrier_m =
            (record.carrier_phase_cycles - last->second.carrier_phase_cycles) * wavelength_m(key.second);
        EXPECT_GT(std::abs(code_m), 250e3);
        EXPECT_NEAR(code_m, carrier_m, 0.1);  // twice the change of the ionosphere in a second
      }
    }
    before = now;
  }
  EXPECT_GE(jumps, 1);
}

TEST(GnssReceiver, RefusesWithOneClearError) {
  const auto message = [](const BodyTruth& truth) -> std::string {
    GnssReceiver subject = receiver({});
    try {
      subject.bytes_at(truth);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  BodyTruth truth = test::in_orbit(0.0);
  truth.position_eci.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message(truth), "GNSS receiver: the truth holds a number that is not finite");
  truth = test::in_orbit(0.0);
  truth.position_eci *= 10.0;
  EXPECT_EQ(message(truth), "GNSS receiver: 70873 km from the Earth's centre; accepted is 6300 to 15000");
  truth = test::in_orbit(0.0);
  truth.time.ns += 1;
  EXPECT_NE(message(truth).find("is not a multiple of 1 ms"), std::string::npos);
  truth = test::in_orbit(0.0);
  truth.q_body_eci.coeffs() *= 2.0;
  EXPECT_EQ(message(truth), "GNSS receiver: the attitude quaternion is not of unit length");
  GnssReceiver subject = receiver({});
  subject.bytes_at(test::in_orbit(10.0));
  EXPECT_THROW(subject.bytes_at(test::in_orbit(10.0)), std::invalid_argument);
  EXPECT_THROW(GnssReceiver({}, nullptr, test::data_directory(), 1, "x"), std::invalid_argument);
}

}  // namespace

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
