// What may be held: true integers where there is information, none or a part where there is not, and wrong ones as
// seldom as claimed.

#include "fsw/gnss/ambiguity_validation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/gnss/lambda.h"
#include "tests/support/accuracy.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/sanitizers.h"
#include "tests/unit/fsw/gnss/ambiguity_problems.h"

namespace vbar::fsw::gnss {

namespace {

using problems::Matrix;
using problems::Problem;
using problems::Random;
using problems::Session;
using problems::Vector;

class AmbiguityValidation : public testing::Test {
 protected:
  Result<AmbiguityDecision> decide(const Vector& a, const Matrix& q, const ValidationCriteria& criteria = {}) {
    return decide_ambiguities({a.data(), static_cast<std::size_t>(a.size())},
                              {q.data(), static_cast<std::size_t>(q.size())}, criteria, *workspace_);
  }
  Result<AmbiguityDecision> decide(const Problem& problem, const ValidationCriteria& criteria = {}) {
    return decide(problem.ambiguities, problem.covariance, criteria);
  }

 private:
  std::unique_ptr<ValidationWorkspace> workspace_ = std::make_unique<ValidationWorkspace>();
};

/// Whether all that is held is the truth.
bool right(const AmbiguityDecision& decision, const Problem& problem) {
  for (std::size_t i = 0; i < decision.count; ++i) {
    if (decision.whole[i] != problem.integers(decision.position[i])) return false;
  }
  return true;
}

bool holds(const AmbiguityDecision& decision, Eigen::Index position) {
  const auto end = decision.position.begin() + static_cast<std::ptrdiff_t>(decision.count);
  return std::find(decision.position.begin(), end, static_cast<std::uint8_t>(position)) != end;
}

TEST_F(AmbiguityValidation, HoldsAllOfAStrongSession) {
  Random random(1);
  for (const Eigen::Index n : {4, 8, 16, 24}) {
    const Problem problem =
        problems::draw(problems::session_covariance(Session{.code_sigma_m = 0.3}, n, random), random);
    const AmbiguityDecision decision = decide(problem).value();
    ASSERT_EQ(decision.count, problem.size());
    EXPECT_EQ(decision.rejection_reason, RejectionReason::kNone);
    EXPECT_TRUE(right(decision, problem));
    EXPECT_EQ(decision.tried, 1U);
    for (std::size_t i = 0; i < decision.count; ++i) EXPECT_EQ(decision.position[i], i);
    EXPECT_GT(decision.success_rate, 0.999);
  }
}

TEST_F(AmbiguityValidation, HoldsNoneOfAHopelessSession) {
  // One epoch with code of 3 m: the baseline is known to metres, the wavelength is 0.19 m.
  Random random(2);
  const Session session{.epochs = 1, .youngest_epochs = 1, .code_sigma_m = 3.0, .phase_sigma_m = 0.003};
  const Problem problem = problems::draw(problems::session_covariance(session, 8, random), random);
  const AmbiguityDecision decision = decide(problem).value();
  EXPECT_EQ(decision.count, 0U);
  EXPECT_EQ(decision.rejection_reason, RejectionReason::kWeak);
}

TEST_F(AmbiguityValidation, LeavesOutTheSatellitesThatHaveJustRisen) {
  Random random(3);
  int complete = 0;
  for (int trial = 0; trial < 20; ++trial) {
    // Each new one with a float ambiguity of its own noise besides: 1 cycle, which no other ambiguity tells about.
    Matrix q = problems::session_covariance(Session{.code_sigma_m = 0.3}, 12, random);
    q(3, 3) += 1.0;
    q(7, 7) += 1.0;
    const Problem problem = problems::draw(q, random);
    const AmbiguityDecision decision = decide(problem).value();
    EXPECT_EQ(decision.rejection_reason, RejectionReason::kWeak);
    EXPECT_FALSE(holds(decision, 3));
    EXPECT_FALSE(holds(decision, 7));
    EXPECT_TRUE(right(decision, problem));
    if (decision.count == 10) ++complete;
  }
  EXPECT_EQ(complete, 20);  // the ten old ones are as strong as in HoldsAllOfAStrongSession
}

TEST_F(AmbiguityValidation, LeavesOutAnAmbiguityThatHasSlippedByHalfACycle) {
  Random random(4);
  int found = 0;
  for (int trial = 0; trial < 20; ++trial) {
    Problem problem = problems::draw(problems::session_covariance(Session{.code_sigma_m = 0.3}, 12, random), random);
    const Eigen::Index slipped = trial % 12;
    problem.ambiguities(slipped) += 0.5;
    const AmbiguityDecision decision = decide(problem).value();
    EXPECT_FALSE(holds(decision, slipped));
    EXPECT_TRUE(right(decision, problem));
    if (decision.count == 11 && decision.rejection_reason == RejectionReason::kNoFit) ++found;
  }
  EXPECT_EQ(found, 20);
}

TEST_F(AmbiguityValidation, HoldsNothingThatDoesNotFit) {
  // Floats a hundred times farther from integers than their covariance says: it cannot be the true one.
  Random random(5);
  const Matrix q = problems::session_covariance(Session{.epochs = 300, .code_sigma_m = 0.1}, 8, random);
  const Problem problem = problems::draw(q, random);
  const AmbiguityDecision decision = decide(problem.ambiguities, 1e-4 * q).value();
  EXPECT_EQ(decision.count, 0U);
  EXPECT_EQ(decision.rejection_reason, RejectionReason::kNoFit);
}

/// Float ambiguities of the others once some are held: conditional mean and covariance.
Problem condition(const Problem& problem, const AmbiguityDecision& decision) {
  const auto held = static_cast<Eigen::Index>(decision.count);
  const Eigen::Index n = problem.ambiguities.size();
  std::vector<Eigen::Index> fixed, free;
  for (Eigen::Index i = 0; i < n; ++i) (holds(decision, i) ? fixed : free).push_back(i);
  const Matrix gain =
      problem.covariance(free, fixed) * problem.covariance(fixed, fixed).ldlt().solve(Matrix::Identity(held, held));
  const Vector miss = Vector(problem.ambiguities(fixed)) - Eigen::Map<const Vector>(decision.whole.data(), held);
  Problem rest;
  rest.integers = problem.integers(free);
  rest.ambiguities = Vector(problem.ambiguities(free)) - gain * miss;
  rest.covariance = problem.covariance(free, free) - gain * problem.covariance(fixed, free);
  return rest;
}

TEST_F(AmbiguityValidation, TakesMoreThanTwentyFourInBatches) {
  Random random(6);
  for (const Eigen::Index n : {26, 40, 80}) {
    const Session session{.frequencies = 2, .epochs = 30, .youngest_epochs = 1, .code_sigma_m = 0.4};
    const Problem problem = problems::draw(problems::session_covariance(session, n, random), random);
    const AmbiguityDecision first = decide(problem).value();
    EXPECT_EQ(first.count, kMaxAmbiguities);
    EXPECT_TRUE(right(first, problem));
    Problem rest = condition(problem, first);
    std::size_t held = first.count;
    for (int batch = 0; batch < 4 && rest.size() > 0; ++batch) {
      const AmbiguityDecision next = decide(rest, {.min_count = 1}).value();
      EXPECT_TRUE(right(next, rest));
      held += next.count;
      rest = condition(rest, next);
    }
    EXPECT_EQ(held, problem.size());
  }
}

TEST_F(AmbiguityValidation, LeavesOutWhatDependsOnOthers) {
  Random random(7);
  const Problem problem = problems::draw(problems::session_covariance(Session{.code_sigma_m = 0.3}, 8, random), random);
  // The ninth is the eighth again.
  Matrix twice = Matrix::Identity(9, 8);
  twice(8, 7) = 1.0;
  const Matrix q = twice * problem.covariance * twice.transpose();
  const AmbiguityDecision decision = decide(twice * problem.ambiguities, q).value();
  EXPECT_EQ(decision.count, 8U);
  EXPECT_EQ(decision.rejection_reason, RejectionReason::kSearch);
  EXPECT_NE(holds(decision, 7), holds(decision, 8));
}

/// What became of 24,000 problems: sessions of every kind, weakened to where the decision is hard, and whatever subset
/// of their ambiguities passes.
struct Statistics {
  int drawn = 0;
  int fixed = 0;
  int partly = 0;
  int wrong = 0;
  [[nodiscard]] double part(int count) const { return static_cast<double>(count) / drawn; }
};

template <class Decide>
Statistics gather(std::uint64_t seed, const Decide& decide) {
  Random random(seed);
  Statistics statistics;
  for (int model = 0; model < vbar::test::share_under_sanitizers(400); ++model) {
    const Eigen::Index n = std::uniform_int_distribution<Eigen::Index>(4, 24)(random);
    // One draw a line: in what order operands are worked out is each compiler's own.
    const Matrix session = problems::random_session_covariance(n, random);
    const Matrix q = std::pow(10.0, problems::uniform(random, 0.0, 3.5)) * session;
    for (int draw = 0; draw < 60; ++draw) {
      const Problem problem = problems::draw(q, random);
      const AmbiguityDecision decision = decide(problem);
      ++statistics.drawn;
      if (decision.count == 0) continue;
      ++statistics.fixed;
      if (decision.count < problem.size()) ++statistics.partly;
      if (!right(decision, problem)) ++statistics.wrong;
    }
  }
  // The rate of wrong ones says something only if it fixes, wholly and partly, and not always.
  EXPECT_GT(statistics.part(statistics.fixed), 0.3);
  EXPECT_LT(statistics.part(statistics.fixed), 0.9);
  EXPECT_GT(statistics.part(statistics.partly), 0.03);
  return statistics;
}

TEST_F(AmbiguityValidation, SeldomHoldsWrongIntegers) {
  const Statistics statistics = gather(8, [this](const Problem& problem) { return decide(problem).value(); });
  accuracy::expect_below("ambiguity validation, rate of wrong fixes",
                         "simulated truth, 24,000 problems of any strength", statistics.part(statistics.wrong),
                         kFixFailureRate, "of problems");
}

TEST_F(AmbiguityValidation, SeldomHoldsWrongIntegersByTheFailureRateAlone) {
  // Without the fixed ratio that guards against wrong covariances, the table has to keep what it promises, in subsets
  // too.
  const Statistics statistics =
      gather(9, [this](const Problem& problem) { return decide(problem, {.min_ratio = 1.0}).value(); });
  accuracy::expect_below("ambiguity validation without a fixed ratio, rate of wrong fixes",
                         "simulated truth, 24,000 problems of any strength", statistics.part(statistics.wrong),
                         kFixFailureRate, "of problems");
}

TEST_F(AmbiguityValidation, RefusesWhatIsNoProblem) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vector a = Vector::Zero(4);
  const Matrix q = Matrix::Identity(4, 4);
  EXPECT_EQ(decide(a, Matrix::Identity(3, 3)).status(), Status::kInvalidArgument);
  EXPECT_EQ(decide(Vector::Zero(81), Matrix::Identity(81, 81)).status(), Status::kInvalidArgument);
  EXPECT_EQ(decide(nan * a, q).status(), Status::kNotFinite);
  EXPECT_EQ(decide(a, nan * q).status(), Status::kNotFinite);
  EXPECT_EQ(decide(a, q, {.min_success_rate = 0.5}).status(), Status::kInvalidArgument);
  EXPECT_EQ(decide(a, q, {.min_ratio = nan}).status(), Status::kInvalidArgument);
  EXPECT_EQ(decide(a, q, {.min_count = 0}).status(), Status::kInvalidArgument);
  EXPECT_EQ(decide(Vector(), Matrix()).value().rejection_reason, RejectionReason::kTooFew);
  EXPECT_EQ(decide(Vector::Zero(3), 1e-4 * Matrix::Identity(3, 3)).value().rejection_reason, RejectionReason::kTooFew);
  for (const Matrix& bad : {Matrix(Matrix::Zero(4, 4)), Matrix(-q), Matrix(Matrix::Ones(4, 4))}) {
    const AmbiguityDecision decision = decide(a, bad).value();
    EXPECT_EQ(decision.count, 0U);
    EXPECT_EQ(decision.rejection_reason, RejectionReason::kSearch);
  }
  EXPECT_EQ(decide(Vector::Constant(4, 1e300), q).value().rejection_reason, RejectionReason::kSearch);
}

TEST_F(AmbiguityValidation, AsksNothingOfTheHeap) {
  Random random(9);
  const Problem problem = problems::draw(
      problems::session_covariance(Session{.frequencies = 2, .epochs = 5, .youngest_epochs = 1}, 40, random), random);
  const std::size_t before = vbar::test::allocation_count();
  const bool ok = decide(problem).ok();
  EXPECT_EQ(vbar::test::allocation_count(), before);
  EXPECT_TRUE(ok);
}

}  // namespace

// The ratio test's table against the one case that has a formula and against models that it was not simulated with; the
// chi-square tail against the printed tables.

namespace {

/// Standard deviation of one ambiguity that rounding misses at the given rate.
double sigma_of(double failure_rate) {
  double low = 0.01;
  double high = 10.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (std::erfc(0.5 / (middle * std::sqrt(2.0))) < failure_rate ? low : high) = middle;
  }
  return low;
}

/// One ambiguity of truth 0: the ratio is ((1 - e) / e)^2 at a distance e from the nearest integer, so wrong integers
/// are accepted at floats within 1 / (1 + sqrt(ratio)) of any other integer.
double wrong_and_accepted(double sigma, double ratio) {
  const double reach = 1.0 / (1.0 + std::sqrt(ratio));
  double sum = 0.0;
  for (int z = 1; z <= 20; ++z) {
    const double scale = 1.0 / (sigma * std::sqrt(2.0));
    sum += std::erfc((z - reach) * scale) - std::erfc((z + reach) * scale);  // both signs of z
  }
  return sum;
}

TEST(RatioThreshold, KeepsTheFailureRateOfOneAmbiguity) {
  for (const double failure_rate : {0.002, 0.005, 0.01, 0.02, 0.05, 0.1}) {
    const double rate = wrong_and_accepted(sigma_of(failure_rate), ratio_threshold(1, failure_rate));
    // Simulated with 100 events an entry, the strictest of 12: 10 % of scatter each, so within -40 % and +10 %.
    EXPECT_GT(rate, 0.6 * kFixFailureRate) << failure_rate;
    EXPECT_LT(rate, 1.1 * kFixFailureRate) << failure_rate;
  }
}

TEST(RatioThreshold, IsStricterForFewerAmbiguitiesAndWeakerModels) {
  for (std::size_t n = 1; n <= kMaxAmbiguities; ++n) {
    EXPECT_EQ(ratio_threshold(n, 0.0), 1.0);
    EXPECT_EQ(ratio_threshold(n, kFixFailureRate), 1.0);
    double before = 1.0;
    for (double rate = kFixFailureRate; rate <= kLargestModelFailureRate; rate *= 1.05) {
      EXPECT_GE(ratio_threshold(n, rate), before);
      before = ratio_threshold(n, rate);
      if (n > 1) {
        EXPECT_LE(ratio_threshold(n, rate), ratio_threshold(n - 1, rate));
      }
    }
  }
}

TEST(RatioThreshold, ReachesNowhereWhatItWasNotMadeFor) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(ratio_threshold(0, 0.01), infinity);
  EXPECT_EQ(ratio_threshold(8, 0.11), infinity);
  EXPECT_EQ(ratio_threshold(8, std::numeric_limits<double>::quiet_NaN()), infinity);
  EXPECT_EQ(ratio_threshold(8, 1.0), infinity);
}

TEST(RatioThreshold, KeepsTheFailureRateOfModelsItWasNotSimulatedWith) {
  problems::Random random(77);
  constexpr int kDraws = 1000;
  int wrong = 0;
  int accepted = 0;
  int drawn = 0;
  for (int model = 0; model < 30; ++model) {
    const Eigen::Index n = std::uniform_int_distribution<Eigen::Index>(4, 24)(random);
    problems::Matrix q = problems::random_session_covariance(n, random);
    const problems::Vector zero = problems::Vector::Zero(n);
    double failure_rate = 0.0;
    const double wanted = std::pow(10.0, problems::uniform(random, -2.7, -1.0));
    for (int step = 0; step < 400 && failure_rate < wanted; ++step) {  // weaker until it fails that often
      Decorrelation problem;
      q *= 1.05;
      ASSERT_EQ(
          problem.compute({zero.data(), static_cast<std::size_t>(n)}, {q.data(), static_cast<std::size_t>(n * n)}),
          Status::kOk);
      failure_rate = 1.0 - bootstrap_success_rate(problem.d());
    }
    const double threshold = ratio_threshold(static_cast<std::size_t>(n), failure_rate);
    for (int draw = 0; draw < kDraws; ++draw) {
      const problems::Problem problem = problems::draw(q, random);
      const IntegerSolution solution =
          resolve_ambiguities({problem.ambiguities.data(), problem.size()}, {q.data(), problem.size() * problem.size()})
              .value();
      ++drawn;
      if (solution.second_norm2 < threshold * solution.best_norm2) continue;
      ++accepted;
      if (!std::equal(problem.integers.begin(), problem.integers.end(), solution.best.begin())) ++wrong;
    }
  }
  accuracy::expect_below("ratio test, rate of wrong integers accepted", "simulated truth, 30,000 problems of 30 models",
                         static_cast<double>(wrong) / drawn, kFixFailureRate, "of problems");
  EXPECT_GT(accepted, drawn / 2);
}

TEST(ChiSquare, TailIsThatOfThePrintedTables) {
  // Abramowitz and Stegun, table 26.8: x for a tail of 0.05 and of 0.001, given with six and five digits.
  struct Row {
    std::size_t degrees;
    double x05, x001;
  };
  for (const Row& row : {Row{1, 3.84146, 10.828}, Row{2, 5.99147, 13.816}, Row{5, 11.0705, 20.515},
                         Row{10, 18.3070, 29.588}, Row{24, 36.4151, 51.179}}) {
    EXPECT_NEAR(chi_square_tail(row.x05, row.degrees), 0.05, 0.05 * 1e-5 * row.x05) << row.degrees;
    EXPECT_NEAR(chi_square_tail(row.x001, row.degrees), 0.001, 0.001 * 5e-4) << row.degrees;
  }
  EXPECT_EQ(chi_square_tail(0.0, 7), 1.0);
  EXPECT_EQ(chi_square_tail(0.0, 8), 1.0);
  EXPECT_EQ(chi_square_tail(1e6, 24), 0.0);
  // One more degree of freedom by the density: Q(x, v + 2) - Q(x, v) = (x/2)^(v/2) exp(-x/2) / Gamma(v/2 + 1), 26.4.8.
  for (std::size_t v = 1; v <= 22; ++v) {
    const double x = 0.7 * static_cast<double>(v) + 1.0;
    const double half = 0.5 * static_cast<double>(v);
    EXPECT_NEAR(chi_square_tail(x, v + 2) - chi_square_tail(x, v),
                std::exp(half * std::log(0.5 * x) - 0.5 * x - std::lgamma(half + 1.0)), 1e-14);
  }
}

}  // namespace

}  // namespace vbar::fsw::gnss
