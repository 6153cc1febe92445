// Twenty minutes of experiment 3 with receivers whose carrier phases wander, as those of an RF generator do, and a
// filter that is configured for it, rightly or by a factor of two wrongly: first fix, integers, consistency.

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/integration/experiment3/emulated_pair.h"
#include "tests/support/accuracy.h"

namespace vbar::test {
namespace {

constexpr int kDuration_s = 1200;

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

Outcome fly(const Wander& wander, std::uint64_t first_seed, int seeds) {
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
    const Outcome outcome = fly({wander_mm, wander_mm}, 1, 10);
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
    const Outcome outcome = fly(wander, 11, 10);
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
}  // namespace vbar::test
