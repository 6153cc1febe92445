// Twenty minutes of experiment 3 over fifty seeds: every integer that is held is the emulator's own, and the filter
// is consistent.
//
// Seeds draw all errors of receivers, satellites and antennas, but not the forces: radiation pressure separates the
// pair by 22 nm/s^2 in a direction that hardly changes, and by nothing in the Earth's shadow. Therefore the fifty
// flights begin at fifty places around the orbit.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fsw/filter/propagation.h"
#include "fsw/orbit/sun.h"
#include "host_sim/twins/gnss/body_frame.h"
#include "tests/integration/experiment3/emulated_pair.h"
#include "tests/support/accuracy.h"

namespace vbar::test {

namespace {

constexpr int kSeeds = 50;
constexpr int kDuration_s = 1200;
// Half width of the band of the mean of kSeeds chi-squares of six degrees of freedom: 95 % of all four epochs.
const double kNeesBand = 2.49 * std::sqrt(2.0 * 6.0 / kSeeds);

/// One fiftieth of the orbit's 1.65 h after the other.
CoastingPair coast_of(int seed, int duration_s) {
  return CoastingPair(duration_s, {fmt::format("mission.start_h={}", 39.0 + 0.033 * seed)});
}

TEST(ManySeeds, EveryHeldIntegerIsTheTrueOneAndTheFilterIsConsistent) {
  long wrong = 0;
  int releases = 0;
  accuracy::Largest latest_fix_s;
  double nis = 0.0;
  double phases = 0.0;
  std::vector<double> nees(4, 0.0);  // at 300, 600, 900, 1200 s
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const CoastingPair coast = coast_of(seed, kDuration_s);
    EmulatedPair pair(coast, static_cast<std::uint64_t>(seed));
    accuracy::Smallest first_fix_s;
    while (!pair.done()) {
      pair.fly();
      if (!pair.valid()) continue;
      if (pair.is_fixed()) first_fix_s.add(pair.elapsed_s());
      wrong += pair.wrong_integers();
      nis += pair.carrier().last_update().phase_nis;
      phases += pair.carrier().last_update().phases_used;
      const int elapsed_s = static_cast<int>(pair.elapsed_s());
      if (elapsed_s > 0 && elapsed_s % 300 == 0) nees[static_cast<std::size_t>(elapsed_s / 300 - 1)] += pair.nees();
    }
    latest_fix_s.add(first_fix_s);
    releases += pair.carrier().report().releases;
  }
  fmt::print("first fix after {} s at the latest; {} releases; NIS {:.4f} of {:.0f} phases; NEES", latest_fix_s,
             releases, nis / phases, phases);
  for (const double sum : nees) fmt::print(" {:.2f}", sum / kSeeds);
  fmt::print("\n");

  accuracy::expect_count("carrier-phase navigation: wrong integers held, 50 seeds, 20 minutes each",
                         "integers of the receiver emulator", wrong, 0, "integers");
  accuracy::expect_below("carrier-phase navigation: first fix after a warm start, latest of 50 seeds",
                         "limit of the mission", latest_fix_s, 300.0, "s");
  for (const double sum : nees) EXPECT_NEAR(sum / kSeeds, 6.0, kNeesBand);
  // The 95 % band of 190,000 phases is 1 +- 0.0064; the filter takes no phase for better than 0.3 mm, so it tends to
  // the lower side.
  EXPECT_NEAR(nis / phases, 1.0, 1.96 * std::sqrt(2.0 / phases));
}

// What the empirical acceleration has to describe: the differential acceleration of the truth less gravity of degree 20
// and a constant radiation pressure in sunlight, which are states or models of the filter.
TEST(ManySeeds, TheForcesAreThoseConfiguredInTheFilter) {
  constexpr int kOrbit_s = 5940;
  const CoastingPair coast = coast_of(0, kOrbit_s);
  const auto& epochs = coast.epochs();
  EmulatedPair pair(coast, 1);
  pair.fly();
  const fsw::orbit::EarthOrientation earth = pair.filter().settings().earth;  // as telecommanded
  std::vector<fsw::Vector3> accelerations, from_sun;
  for (std::size_t k = 0; k + 1 < epochs.size(); ++k) {
    const fsw::Vector3 sun = fsw::orbit::sun_position_gcrf(epochs[k].time).normalized();
    const fsw::filter::Propagation gravity(epochs[k].time, earth, sun);
    const auto gained = [&](const char* name) -> fsw::Vector3 {
      return epochs[k + 1].find(name)->orbit.velocity_eci -
             gravity.coast(epochs[k].find(name)->orbit, 10.0).velocity_eci;
    };
    accelerations.emplace_back((gained("target") - gained("servicer")) / 10.0);
    const bool is_lit = fsw::filter::is_sunlit(epochs[k].find("target")->orbit.position_eci, sun);
    from_sun.emplace_back(is_lit ? fsw::Vector3(-sun) : fsw::Vector3(fsw::Vector3::Zero()));
  }
  double projected = 0.0, lit = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < from_sun.size(); ++k) {
    projected += accelerations[k].dot(from_sun[k]);
    lit += from_sun[k].squaredNorm();
  }
  const double pressure = projected / lit;
  for (std::size_t k = 0; k < from_sun.size(); ++k)
    squares += (accelerations[k] - pressure * from_sun[k]).squaredNorm();
  const double rms = std::sqrt(squares / (3.0 * static_cast<double>(from_sun.size())));
  fmt::print("radiation pressure {:.1f} nm/s^2, remaining acceleration {:.2f} nm/s^2 an axis\n", 1e9 * pressure,
             1e9 * rms);
  EXPECT_NEAR(std::abs(pressure), 2.2e-8, 0.3e-8);  // by areas, coefficients and masses of the mission: 22 nm/s^2
  EXPECT_LT(rms, 1e-9);                             // the mission's default, acceleration_sigma_nmps2 = 1
}

}  // namespace

// Twenty minutes of experiment 3 with receivers whose carrier phases wander, as those of an RF generator do, and a
// filter that is configured for it, rightly or by a factor of two wrongly: first fix, integers, consistency.

namespace {

const CoastingPair& coast() {
  static const CoastingPair pair(kDuration_s);
  return pair;
}

/// The wander of the receivers and that in the telecommand, both over 60 s.
struct Wander {
  double true_mm, configured_mm;

  [[nodiscard]] std::vector<std::string> overrides() const {
    std::vector<std::string> all;
    for (const char* spacecraft : {"servicer", "target"}) {
      const std::string tracking = fmt::format("spacecraft.{}.sensors.gnss.tracking", spacecraft);
      all.push_back(fmt::format("{}.carrier_wander_sigma_mm={}", tracking, true_mm));
      all.push_back(fmt::format("{}.carrier_wander_time_s=60", tracking));
    }
    all.push_back(fmt::format("navigation.carrier_phase.phase_wander_sigma_mm={}", configured_mm));
    all.push_back("navigation.carrier_phase.phase_wander_time_s=60");
    return all;
  }
};

struct Outcome {
  accuracy::Largest latest_fix_s;
  std::vector<double> nees;  ///< of each seed at the end
  int fixed_at_the_end = 0;
  long wrong = 0;  ///< integers, over all epochs
  int releases = 0;
  double nis = 0.0;
};

Outcome fly_with(const Wander& wander, std::uint64_t first_seed, int seeds) {
  Outcome outcome;
  double phases = 0.0;
  for (std::uint64_t seed = first_seed; seed < first_seed + static_cast<std::uint64_t>(seeds); ++seed) {
    EmulatedPair pair(coast(), seed, wander.overrides());
    accuracy::Smallest first_fix_s;
    while (!pair.done()) {
      pair.fly();
      if (!pair.valid()) continue;
      if (pair.is_fixed()) first_fix_s.add(pair.elapsed_s());
      outcome.wrong += pair.wrong_integers();
      outcome.nis += pair.carrier().last_update().phase_nis;
      phases += pair.carrier().last_update().phases_used;
    }
    outcome.latest_fix_s.add(first_fix_s);
    outcome.fixed_at_the_end += pair.is_fixed() ? 1 : 0;
    outcome.releases += pair.carrier().report().releases;
    outcome.nees.push_back(pair.nees());
  }
  outcome.nis /= phases;
  fmt::print(
      "wander {} mm, configured {} mm: first fix after {} s at the latest; {} wrong; {} releases; NIS {:.3f}; "
      "NEES {:.2f}\n",
      wander.true_mm, wander.configured_mm, outcome.latest_fix_s, outcome.wrong, outcome.releases, outcome.nis,
      accuracy::median(outcome.nees));
  return outcome;
}

// The mission's limit of the first fix is that of white noise. The median of ten chi-square variables of six degrees of
// freedom is below 9.0 at 99.8 %: 5.35 plus three standard deviations of 1 / (2 sqrt(10) 0.127), 0.127 being the
// density.
TEST(PhaseWander, ConfiguredItIsFixedAsSoonAsWhiteNoise) {
  for (const double wander_mm : {0.5, 1.0, 2.0}) {
    const Outcome outcome = fly_with({wander_mm, wander_mm}, 1, 10);
    accuracy::expect_count(
        fmt::format("carrier-phase navigation, phase wander {} mm over 60 s: wrong integers held, 10 "
                    "seeds, 20 minutes each",
                    wander_mm),
        "integers of the receiver emulator", outcome.wrong, 0, "integers");
    accuracy::expect_below(
        fmt::format("carrier-phase navigation, phase wander {} mm over 60 s: first fix, latest of 10 seeds", wander_mm),
        "limit of the mission", outcome.latest_fix_s, 300.0, "s");
    EXPECT_EQ(outcome.fixed_at_the_end, 10) << wander_mm;
    EXPECT_EQ(outcome.releases, 0) << wander_mm;
    EXPECT_LT(accuracy::median(outcome.nees), 9.0) << wander_mm;
    EXPECT_NEAR(outcome.nis, 1.0, 0.03) << wander_mm;  // 40,000 phases: 2 % at three sigma, and the floor of 0.3 mm
  }
}

TEST(PhaseWander, WronglyConfiguredItHoldsNoWrongInteger) {
  for (const Wander& wander : {Wander{1.0, 0.5}, Wander{0.5, 1.0}, Wander{0.0, 1.0}, Wander{2.0, 1.0}}) {
    const Outcome outcome = fly_with(wander, 11, 10);
    EXPECT_EQ(outcome.wrong, 0) << wander.true_mm << " mm, configured " << wander.configured_mm;
    EXPECT_EQ(outcome.fixed_at_the_end, 10) << wander.true_mm << " mm, configured " << wander.configured_mm;
  }
}

// A wander of millimetres does not explain a wrong cycle: the second-best integers, held on purpose, contradict the
// phases of the next two epochs, as they do without wander.
TEST(PhaseWander, DoesNotHideWrongIntegers) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    EmulatedPair pair(coast(), seed, Wander{2.0, 2.0}.overrides());
    pair.fly(11);
    ASSERT_TRUE(pair.hold_second_best()) << seed;
    ASSERT_GT(pair.wrong_integers(), 0) << seed;
    const auto contradictions = [&] {
      return pair.carrier().counters().slips + pair.carrier().counters().phases_rejected;
    };
    const std::int32_t before = contradictions();
    pair.fly(2);
    EXPECT_GT(contradictions(), before) << seed;
    pair.fly(30);  // what a warm start may take
    while (!pair.done()) {
      pair.fly();
      EXPECT_EQ(pair.wrong_integers(), 0) << seed << " at " << pair.elapsed_s() << " s";
    }
    EXPECT_TRUE(pair.is_fixed()) << seed;
  }
}

// Cycle slips beside the wander, fifty times as many as a receiver has, half of them unreported.
TEST(PhaseWander, SlipsAreFoundBesideIt) {
  std::vector<std::string> overrides = Wander{1.0, 1.0}.overrides();
  for (const char* spacecraft : {"servicer", "target"}) {
    const std::string tracking = fmt::format("spacecraft.{}.sensors.gnss.tracking", spacecraft);
    overrides.push_back(tracking + ".cycle_slips_per_hour=1.0");
    overrides.push_back(tracking + ".undetected_slip_fraction=0.5");
  }
  std::int32_t found = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EmulatedPair pair(coast(), seed, overrides);
    while (!pair.done()) {
      pair.fly();
      if (!pair.valid()) continue;
      EXPECT_EQ(pair.wrong_integers(), 0) << seed << " at " << pair.elapsed_s() << " s";
    }
    EXPECT_TRUE(pair.is_fixed()) << seed;
    EXPECT_LT(pair.position_error_m(), 0.05) << seed;  // what a wrong fix may cost
    found += pair.carrier().counters().slips;
  }
  EXPECT_GT(found, 50);  // five flights of a third of an hour, two receivers, thirty signals: 100
}

}  // namespace

// Wrong integers: held on purpose, and made by slips that no receiver tells of.

namespace {

constexpr double kLargestMove_m = 0.05;  // what a wrong fix may cost

const CoastingPair& wrong_fix_coast() {
  static const CoastingPair pair(900);
  return pair;
}

/// Three times what the unknown places of both antennas alone leave of a position, root mean square.
double settled_m() {
  const twins::gnss::BodyFrameSettings body;
  return 3.0 * twins::gnss::static_floor_rms_m(body, body);
}

/// Held before the filter itself would have: the first epochs with phases.
class WrongFix : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(AfterEpochs, WrongFix, ::testing::Values(11, 13));

// The one most likely to be taken for the right one. It differs from that by a cycle of one satellite, and two epochs
// are enough for the others to outvote it.
TEST_P(WrongFix, TheSecondBestIntegersAreFoundOut) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    EmulatedPair pair(wrong_fix_coast(), seed);
    pair.fly(GetParam());
    ASSERT_TRUE(pair.hold_second_best()) << seed;
    ASSERT_GT(pair.wrong_integers(), 0) << seed;
    EXPECT_LT(pair.position_error_m(), kLargestMove_m) << seed;
    const auto said = [&] { return pair.carrier().counters().slips + pair.carrier().counters().phases_rejected; };
    const std::int32_t before = said();
    for (int epoch = 0; epoch < 2; ++epoch) {
      pair.fly();
      EXPECT_LT(pair.position_error_m(), kLargestMove_m) << seed;
    }
    EXPECT_GT(said(), before) << seed;
    while (!pair.done()) {
      pair.fly();
      EXPECT_EQ(pair.wrong_integers(), 0) << seed << " at " << pair.elapsed_s() << " s";
    }
    EXPECT_TRUE(pair.is_fixed()) << seed;
    EXPECT_LT(pair.position_error_m(), settled_m()) << seed;
  }
}

// No decision would take these: half of all satellites a cycle off, which moves the position by decimetres at once. The
// next epoch contradicts them, everything is given up, and the position with it.
TEST_P(WrongFix, AGrossMistakeIsGivenUpAtOnce) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EmulatedPair pair(wrong_fix_coast(), seed);
    pair.fly(GetParam());
    ASSERT_TRUE(pair.hold_shifted(1.0)) << seed;
    ASSERT_GT(pair.wrong_integers(), 5) << seed;
    pair.fly();
    EXPECT_EQ(pair.carrier().report().releases, 1) << seed;
    EXPECT_FALSE(pair.is_fixed()) << seed;
    EXPECT_EQ(pair.navigation().state().source, fsw::navigation::NavigationSource::kGnssFloat) << seed;
    pair.fly(30);  // what a warm start may take
    EXPECT_TRUE(pair.is_fixed()) << seed;
    while (!pair.done()) {
      EXPECT_EQ(pair.wrong_integers(), 0) << seed << " at " << pair.elapsed_s() << " s";
      pair.fly();
    }
    EXPECT_LT(pair.position_error_m(), settled_m()) << seed;
  }
}

// Three slips an hour of every signal, a hundred times as many as a receiver has, and it tells of none of them.
TEST(UnseenSlips, NeverStayInAHeldInteger) {
  const char* kTracking = "sensors.gnss.tracking";
  std::vector<std::string> overrides;
  for (const std::string spacecraft : {"servicer", "target"}) {
    const std::string tracking = "spacecraft." + spacecraft + "." + kTracking;
    overrides.push_back(tracking + ".cycle_slips_per_hour=3.0");
    overrides.push_back(tracking + ".undetected_slip_fraction=1.0");
  }
  std::int32_t found = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    EmulatedPair pair(wrong_fix_coast(), seed, overrides);
    bool was_fixed = false;
    while (!pair.done()) {
      pair.fly();
      if (!pair.valid()) continue;
      was_fixed = was_fixed || pair.is_fixed();
      EXPECT_EQ(pair.wrong_integers(), 0) << seed << " at " << pair.elapsed_s() << " s";
      if (was_fixed) {
        EXPECT_LT(pair.position_error_m(), kLargestMove_m) << seed << " at " << pair.elapsed_s() << " s";
      }
    }
    EXPECT_TRUE(pair.is_fixed()) << seed;
    found += pair.carrier().counters().slips;
  }
  EXPECT_GT(found, 200);  // ten flights of a quarter of an hour, two receivers, twenty signals and more: 300
}

}  // namespace

}  // namespace vbar::test
