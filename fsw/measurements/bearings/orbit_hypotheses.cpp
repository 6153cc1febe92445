#include "fsw/measurements/bearings/orbit_hypotheses.h"

#include <array>

#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::measurements {
namespace {

using Normal = BearingBatch::Normal;
using Unknowns = BearingBatch::Unknowns;
using Cholesky = math::Cholesky<BearingBatch::kUnknowns>;

/// An unknown burn, m/s on each axis, and what it may have added to the distance, of which bearings say little.
struct UnknownBurn {
  double velocity_sigma;
  double distance_share;
};
constexpr std::array<UnknownBurn, 4> kBurns{{{1e-3, 1e-3}, {1e-2, 5e-3}, {0.1, 0.02}, {1.0, 0.1}}};

constexpr std::array<double, 8> kScatters{1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0};

constexpr int kMaxIterations = 4;
constexpr double kConverged = 0.01;  // of a sigma, all unknowns together

constexpr double square(double x) {
  return x * x;
}

double log_determinant(const Cholesky& factor) {
  double sum = 0.0;
  for (int k = 0; k < BearingBatch::kUnknowns; ++k) sum -= 2.0 * math::log(factor.solve_lower(Unknowns::Unit(k))(k));
  return sum;
}

/// Covariance of the ROE after a burn, which may have been at any time since the last bearing before the window: the
/// mean over four times, with the drift of the mean longitude since. kAsEstimated: as it is.
Result<Matrix6> covariance_of(const EstimatedOrbit& estimated, int alternative) {
  if (alternative == OrbitVerdict::kAsEstimated) return estimated.covariance;
  const auto chief = orbit::qns_from_cartesian(estimated.servicer);
  if (!chief.ok()) return chief.status();
  const UnknownBurn& burn = kBurns[static_cast<std::size_t>(alternative)];
  const double n = orbit::mean_motion(chief.value().a);
  constexpr int kTimes = 4;
  Matrix6 covariance = estimated.covariance;
  for (int k = 0; k < kTimes; ++k) {
    const double angle = n * estimated.unseen_s * k / (kTimes - 1);
    orbit::QnsElements then = chief.value();
    then.u -= angle;
    Matrix63 gamma = orbit::roe_control_matrix(then);
    gamma.row(1) -= 1.5 * angle * gamma.row(0);
    covariance += (square(burn.velocity_sigma) / kTimes * gamma).lazyProduct(gamma.transpose());
  }
  covariance(1, 1) += square(burn.distance_share * estimated.distance_m / chief.value().a);
  return covariance;
}

/// The same with the errors that all bearings have in common.
Result<Normal> covariance_of_all(const EstimatedOrbit& estimated, int alternative) {
  const Result<Matrix6> orbit = covariance_of(estimated, alternative);
  if (!orbit.ok()) return orbit.status();
  Normal all = square(estimated.common_sigma) * Normal::Identity();
  all.topLeftCorner<6, 6>() = orbit.value();
  return all;
}

struct Likelihood {
  double log = 0.0;
  double scatter = 1.0;
};

/// The largest likelihood over the factors of the scatter.
Result<Likelihood> likelihood_of(const BearingBatch::NormalEquations& window, const Normal& covariance) {
  const Cholesky prior(covariance);
  if (!prior.ok()) return Status::kSingular;
  const Normal information = prior.inverse();
  const double log_determinant_of_prior = log_determinant(prior);
  const int values = 2 * window.bearings;
  Likelihood best;
  for (std::size_t k = 0; k < kScatters.size(); ++k) {
    const double scatter = kScatters[k];
    const Cholesky posterior(window.normal + scatter * information);
    if (!posterior.ok()) return Status::kSingular;
    const double misfit = (window.chi_square - window.right.dot(posterior.solve(window.right))) / scatter;
    // A factor has the prior density of a scale, 1 / k.
    const double log_scatter = math::log(scatter);
    const double log = -0.5 * (misfit + (values - BearingBatch::kUnknowns) * log_scatter + log_determinant_of_prior +
                               log_determinant(posterior)) -
                       log_scatter;
    if (k == 0 || log > best.log) best = {log, scatter};
  }
  return best;
}

}  // namespace

Result<OrbitVerdict> weigh_orbits(BearingBatch& window, const EstimatedOrbit& estimated) {
  const auto equations = window.normal_equations(estimated.servicer, BearingBatch::unknowns_of(estimated.roe),
                                                 estimated.earth, estimated.sun_eci);
  if (!equations.ok()) return equations.status();
  OrbitVerdict verdict;
  double as_estimated = 0.0;
  for (int k = OrbitVerdict::kAsEstimated; k < static_cast<int>(kBurns.size()); ++k) {
    const Result<Normal> covariance = covariance_of_all(estimated, k);
    if (!covariance.ok()) return covariance.status();
    const Result<Likelihood> likelihood = likelihood_of(equations.value(), covariance.value());
    if (!likelihood.ok()) return likelihood.status();
    if (k == OrbitVerdict::kAsEstimated) {
      as_estimated = likelihood.value().log;
      verdict.scatter = likelihood.value().scatter;
      continue;
    }
    const double odds = likelihood.value().log - as_estimated;
    if (verdict.best != OrbitVerdict::kAsEstimated && odds <= verdict.log_odds) continue;
    verdict.best = k;
    verdict.log_odds = odds;
    verdict.best_scatter = likelihood.value().scatter;
  }
  return verdict;
}

Result<RevisedOrbit> revised_orbit(BearingBatch& window, const EstimatedOrbit& estimated, const OrbitVerdict& verdict) {
  const Result<Normal> covariance = covariance_of_all(estimated, verdict.best);
  if (!covariance.ok()) return covariance.status();
  const Cholesky prior(covariance.value());
  if (!prior.ok()) return Status::kSingular;
  const Normal information = verdict.best_scatter * prior.inverse();
  const Unknowns before = BearingBatch::unknowns_of(estimated.roe);
  Unknowns x = before;
  for (int k = 0; k < kMaxIterations; ++k) {
    const auto equations = window.normal_equations(estimated.servicer, x, estimated.earth, estimated.sun_eci);
    if (!equations.ok()) return equations.status();
    const Normal all = equations.value().normal + information;
    const Cholesky factor(all);
    if (!factor.ok()) return Status::kSingular;
    const Unknowns step = factor.solve(equations.value().right - information.lazyProduct(x - before));
    x += step;
    if (step.dot(all.lazyProduct(step)) > square(kConverged) * verdict.best_scatter) continue;
    RevisedOrbit revised;
    revised.roe = x.head<6>();
    revised.covariance = verdict.best_scatter * factor.inverse().topLeftCorner<6, 6>();
    return revised;
  }
  return Status::kDidNotConverge;
}

Result<Matrix6> widest_covariance(const EstimatedOrbit& estimated) {
  return covariance_of(estimated, static_cast<int>(kBurns.size()) - 1);
}

}  // namespace vbar::fsw::measurements
