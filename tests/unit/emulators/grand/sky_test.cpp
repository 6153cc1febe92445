// The radio field against the digital twin's exact signal paths.

#include "emulators/grand/radio_field/sky.h"

#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/signal_path.h"
#include "tests/support/gnss_scene.h"
#include "tests/support/grand_orbit.h"

namespace vbar::grand::bench {
namespace {

using fsw::Duration;
using fsw::Vector3;
using fsw::gnss::kSpeedOfLight;
using test::kGnssStart;
using twins::gnss::Signal;
using vbar::test::sample_in_orbit;

/// Keeps the largest value, and a NaN for good.
void keep_worst(double& worst, double value) {
  if (!(value <= worst)) worst = value;
}

constexpr BoxErrorSettings kIdealBox{0.0, 0.0, 0.0, 60.0};

/// A vehicle in the analytic orbit, flown block by block.
class Flight {
 public:
  explicit Flight(SkySettings settings, std::string_view vehicle = "servicer", Vector3 offset = Vector3::Zero())
      : constellation(test::constellation(1)),
        orbits(std::make_shared<SatelliteOrbits>(constellation, kGnssStart)),
        sky(settings, orbits, twins::gnss::AntennaPattern::load(test::data_directory()), 1, vehicle),
        offset_(std::move(offset)) {
    motion.receive(sample_in_orbit(0.0, offset_));
  }
  const RfBlock& fly(bool is_radiated = true) {
    ++number;
    motion.receive(sample_in_orbit(0.1 * (number + 1), offset_));
    motion.advance(Duration{(number + 1) * RfBlock::kLength.ns});
    sky.fill(motion, number, is_radiated, block);
    return block;
  }
  /// The digital twin's own path at `s` within the block.
  [[nodiscard]] std::optional<twins::gnss::SignalPath> exact_path(std::size_t index, double s) const {
    const double t = 0.1 * number + s;
    const TrajectorySample sample = sample_in_orbit(t, offset_);
    antenna = {kGnssStart, t, sample.position_ecef_m, sample.velocity_ecef_mps,
               motion.boresight_ecef(fsw::nearest_duration(t))};
    return visible_path(*constellation, index, antenna, {});
  }

  std::shared_ptr<const twins::gnss::Constellation> constellation;
  std::shared_ptr<SatelliteOrbits> orbits;
  VehicleMotion motion{Duration{165'000'000}};
  Sky sky;
  RfBlock block;
  int number = -1;
  mutable twins::gnss::AntennaState antenna;

 private:
  Vector3 offset_;
};

std::size_t index_of(const twins::gnss::Constellation& constellation, twins::gnss::SatelliteId id) {
  for (std::size_t k = 0; k < constellation.size(); ++k)
    if (constellation.id(k) == id) return k;
  throw std::logic_error("no such satellite");
}

TEST(SatelliteOrbits, AgreeWithTheTrueStates) {
  const auto constellation = test::constellation(3);
  SatelliteOrbits orbits(constellation, kGnssStart);
  for (std::size_t index = 0; index < constellation->size(); ++index) {
    for (double t = -3.7; t < 8000.0; t += 97.3) {
      const SatelliteMotion motion = orbits.at(index, t);
      const twins::gnss::SatelliteState exact = constellation->true_state(index, kGnssStart, t);
      EXPECT_LT((motion.position - exact.position_ecef).norm(), 1e-6);
      EXPECT_LT((motion.velocity - exact.velocity_ecef).norm(), 1e-3);  // the errors' own velocity is not in it
      EXPECT_NEAR(motion.clock_m, kSpeedOfLight * exact.clock_s, 1e-6);
      EXPECT_NEAR(motion.clock_rate_mps, kSpeedOfLight * exact.clock_drift, 1e-3);
    }
  }
}

TEST(SatelliteOrbits, DoNotDependOnWhatWasAskedBefore) {
  const auto constellation = test::constellation(3);
  SatelliteOrbits forwards(constellation, kGnssStart), jumping(constellation, kGnssStart);
  for (double t = 0.0; t < 400.0; t += 7.9) static_cast<void>(forwards.at(4, t));
  static_cast<void>(jumping.at(4, 5000.0));
  EXPECT_EQ(forwards.at(4, 399.0).position, jumping.at(4, 399.0).position);
  EXPECT_EQ(forwards.at(4, 100.0).acceleration, jumping.at(4, 100.0).acceleration);
}

TEST(Sky, RangesAreExactWithinAHundredthOfAMillimetre) {
  SkySettings settings;
  settings.box = kIdealBox;
  settings.ionosphere = false;
  Flight flight(settings);
  double worst_mm = 0.0, worst_rate_mm_s = 0.0;
  std::set<twins::gnss::SatelliteId> seen;
  for (int k = 0; k < 20000; ++k) {  // 2000 s: a third of an orbit
    const RfBlock& block = flight.fly();
    EXPECT_EQ(block.begin.ns, kGnssStart.ns + k * RfBlock::kLength.ns);
    if (k % 37 != 0) continue;
    for (const RfSignal& signal : block.signals) {
      const std::size_t index = index_of(*flight.constellation, signal.satellite);
      seen.insert(signal.satellite);
      for (const double s : {0.0, 0.033, 0.071, 0.1}) {
        const auto path = flight.exact_path(index, s);
        if (!path) continue;  // set within the last second
        const double exact_m = path->range_m + path->shapiro_m - kSpeedOfLight * path->satellite_clock_s;
        const double delay_m = kSpeedOfLight * code_delay_s(signal.signal, flight.constellation->group_delay_s(index));
        keep_worst(worst_mm, 1e3 * std::abs(signal.carrier_m.at(s) - exact_m));
        EXPECT_NEAR(signal.code_m.at(s) - signal.carrier_m.at(s), delay_m, 1e-6);
        const double rate = path->range_rate_mps - kSpeedOfLight * path->satellite_clock_drift;
        keep_worst(worst_rate_mm_s, 1e3 * std::abs(signal.carrier_m.rate_at(s) - rate));
      }
    }
  }
  EXPECT_LT(worst_mm, 0.01);
  // The twin's rate leaves out the velocity of the orbit errors (0.2 mm/s) and of the relativistic delay.
  EXPECT_LT(worst_rate_mm_s, 0.5);
  EXPECT_GE(seen.size(), 20U);
}

TEST(Sky, IonosphereDelaysTheCodeAndAdvancesTheCarrier) {
  SkySettings settings;
  settings.box = kIdealBox;
  Flight flight(settings);
  int compared = 0;
  double worst_mm = 0.0;
  for (int k = 0; k < 3000; ++k) {
    const RfBlock& block = flight.fly();
    if (k % 41 != 0) continue;
    for (const RfSignal& signal : block.signals) {
      const std::size_t index = index_of(*flight.constellation, signal.satellite);
      const auto path = flight.exact_path(index, 0.05);
      if (!path) continue;
      const auto now = kGnssStart + fsw::nearest_duration(flight.antenna.offset_s);
      const double delay_m =
          klobuchar_delay_in_orbit_m(flight.constellation->corrections().klobuchar, flight.antenna.position_ecef,
                                     path->line_of_sight, week_time(twins::gnss::System::kGps, now).seconds_of_week()) *
          ionosphere_scale(signal.signal);
      const double common_m = path->range_m + path->shapiro_m - kSpeedOfLight * path->satellite_clock_s;
      const double group_m = kSpeedOfLight * code_delay_s(signal.signal, flight.constellation->group_delay_s(index));
      keep_worst(worst_mm, 1e3 * std::abs(common_m - signal.carrier_m.at(0.05) - delay_m));
      keep_worst(worst_mm, 1e3 * std::abs(signal.code_m.at(0.05) - group_m - common_m - delay_m));
      ++compared;
    }
  }
  EXPECT_LT(worst_mm, 0.01);
  EXPECT_GT(compared, 1000);
}

TEST(Sky, PowerAndVisibilityAreThoseOfTheLinkBudget) {
  SkySettings settings;
  settings.box = kIdealBox;
  Flight flight(settings);
  const auto pattern = twins::gnss::AntennaPattern::load(test::data_directory());
  for (int k = 0; k < 600; ++k) {
    const RfBlock& block = flight.fly();
    if (k % 10 != 0) continue;  // powers and visibility are taken at whole seconds, for the whole second
    std::map<twins::gnss::SatelliteId, int> signals;
    twins::gnss::SatelliteId last{};
    for (const RfSignal& signal : block.signals) {
      ++signals[signal.satellite];
      EXPECT_GE(signal.satellite, last);
      last = signal.satellite;
    }
    for (std::size_t index = 0; index < flight.constellation->size(); ++index) {
      const auto id = flight.constellation->id(index);
      const auto path = flight.exact_path(index, 0.0);
      EXPECT_EQ(signals.count(id), path ? 1U : 0U) << name_of(id) << " at block " << k;
      if (path && signals.count(id)) {
        EXPECT_EQ(signals[id], id.system == twins::gnss::System::kGps ? 2 : 1);
      }
      for (const RfSignal& signal : block.signals) {
        if (!path || signal.satellite != id) continue;
        const double loss_db = pattern.attenuation_db(path->line_of_sight.dot(flight.antenna.boresight_ecef));
        EXPECT_NEAR(signal.cn0_dbhz, carrier_to_noise_dbhz({}, signal.signal, path->range_m, loss_db), 1e-3);
      }
    }
  }
}

// Through whole passes, and through the wander of the box: value and rate at a block's end are those at the beginning
// of the next one.
TEST(Sky, PhaseAndDopplerAreContinuousThroughAPass) {
  Flight flight(SkySettings{});
  std::map<std::pair<twins::gnss::SatelliteId, Signal>, RfSignal> before;
  double worst_step_mm = 0.0, worst_rate_step_mm_s = 0.0;
  int passes = 0;
  for (int k = 0; k < 40000; ++k) {
    std::map<std::pair<twins::gnss::SatelliteId, Signal>, RfSignal> now;
    for (const RfSignal& signal : flight.fly().signals) {
      const auto key = std::pair(signal.satellite, signal.signal);
      now[key] = signal;
      const auto old = before.find(key);
      if (old == before.end()) {
        ++passes;
        continue;
      }
      keep_worst(worst_step_mm, 1e3 * std::abs(old->second.carrier_m.at(0.1) - signal.carrier_m.at(0.0)));
      keep_worst(worst_step_mm, 1e3 * std::abs(old->second.code_m.at(0.1) - signal.code_m.at(0.0)));
      keep_worst(worst_rate_step_mm_s,
                 1e3 * std::abs(old->second.carrier_m.rate_at(0.1) - signal.carrier_m.rate_at(0.0)));
    }
    before = std::move(now);
  }
  EXPECT_LT(worst_step_mm, 1e-4);         // double precision at 3e7 m: 4e-6 mm
  EXPECT_LT(worst_rate_step_mm_s, 1e-2);  // the same over 0.1 s, and the interpolated orbits' pieces
  EXPECT_GT(passes, 60);
}

// Two antennas at known places: the phase -carrier_m/lambda has no offset of its own, so that its double differences
// are those of the ranges, with integer zero.
TEST(Sky, DoubleDifferencesOfPhaseAreThoseOfTheRanges) {
  SkySettings settings;
  settings.box = kIdealBox;
  settings.ionosphere = false;
  const Vector3 baseline(5.0, -3.0, 6.0);
  Flight servicer(settings, "servicer"), target(settings, "target", baseline);
  for (int k = 0; k < 300; ++k) {
    const RfBlock& a = servicer.fly();
    const RfBlock& b = target.fly();
    if (k % 50 != 0) continue;
    std::map<Signal, double> reference;
    for (const RfSignal& signal : a.signals) {
      const RfSignal* other = nullptr;
      for (const RfSignal& candidate : b.signals)
        if (candidate.satellite == signal.satellite && candidate.signal == signal.signal) other = &candidate;
      const std::size_t index = index_of(*servicer.constellation, signal.satellite);
      const auto path_a = servicer.exact_path(index, 0.02);
      const auto path_b = target.exact_path(index, 0.02);
      if (other == nullptr || !path_a || !path_b) continue;
      const double lambda = twins::gnss::wavelength_m(signal.signal);
      const double range_difference_m = path_b->range_m + path_b->shapiro_m -
                                        kSpeedOfLight * path_b->satellite_clock_s - path_a->range_m -
                                        path_a->shapiro_m + kSpeedOfLight * path_a->satellite_clock_s;
      const double phase = -other->carrier_m.at(0.02) / lambda + signal.carrier_m.at(0.02) / lambda;
      const double cycles = phase + range_difference_m / lambda;
      const auto [first, is_first] = reference.try_emplace(signal.signal, cycles);
      if (!is_first) {
        EXPECT_NEAR(cycles - first->second, 0.0, 1e-4);  // 0.02 mm
      }
    }
    EXPECT_GE(reference.size(), 3U);  // not all systems are visible
  }
}

TEST(Sky, JumpOfTheMotionIsMarkedAndLeavesTheRangesExact) {
  SkySettings settings;
  settings.box = kIdealBox;
  settings.ionosphere = false;
  Flight flight(settings);
  for (int k = 0; k < 14; ++k) EXPECT_FALSE(flight.fly().snapped);
  const Vector3 jump(100.0, 0.0, 0.0);
  for (int k = 0; k < 20; ++k) {
    ++flight.number;
    flight.motion.receive(sample_in_orbit(0.1 * (flight.number + 1), jump));
    flight.motion.advance(Duration{(flight.number + 1) * RfBlock::kLength.ns});
    flight.sky.fill(flight.motion, flight.number, true, flight.block);
    EXPECT_EQ(flight.block.snapped, k == 1);
    if (k == 0) continue;
    const RfSignal& signal = flight.block.signals[3];
    const double t = 0.1 * flight.number + 0.05;
    const TrajectorySample sample = sample_in_orbit(t, jump);
    const auto path = visible_path(*flight.constellation, index_of(*flight.constellation, signal.satellite),
                                   {kGnssStart, t, sample.position_ecef_m, sample.velocity_ecef_mps,
                                    flight.motion.boresight_ecef(fsw::nearest_duration(t))},
                                   {});
    ASSERT_TRUE(path);
    const double exact_m = path->range_m + path->shapiro_m - kSpeedOfLight * path->satellite_clock_s;
    EXPECT_NEAR(signal.carrier_m.at(0.05), exact_m, 1e-5);
  }
}

TEST(Sky, OutageLeavesTheRangesAndTheWanderAsTheyWouldBe) {
  Flight flight(SkySettings{}), interrupted(SkySettings{});
  for (int k = 0; k < 400; ++k) {
    const bool is_radiated = k < 33 || k >= 107;
    const RfBlock& whole = flight.fly();
    const RfBlock& part = interrupted.fly(is_radiated);
    if (!is_radiated) {
      EXPECT_TRUE(part.signals.empty());
      continue;
    }
    ASSERT_EQ(part.signals.size(), whole.signals.size());
    // After the gap another draw of the wander holds, decayed from the same value: 10 sigma.
    EXPECT_NEAR(part.signals[5].carrier_m.at(0.03), whole.signals[5].carrier_m.at(0.03), k < 33 ? 1e-7 : 5e-3);
    EXPECT_NEAR(part.signals[5].code_m.at(0.03), whole.signals[5].code_m.at(0.03), 1e-5);
  }
}

}  // namespace
}  // namespace vbar::grand::bench
