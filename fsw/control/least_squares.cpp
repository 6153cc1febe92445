#include "fsw/control/least_squares.h"

#include <array>

#include "fsw/control/arrival.h"
#include "fsw/control/plan.h"
#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"
#include "fsw/math/symmetric_eigen.h"

namespace vbar::fsw::control {
namespace {

constexpr std::size_t kMaxTimes = 3;
constexpr double kMaxCondition = 1e5;
constexpr double kGoodCondition = 1e2;  ///< the middle is used if its condition is not worse than this

/// Times of the middle burn, as parts of the horizon, in order of preference. Their distances to both ends are
/// incommensurable, so that a horizon that makes one of them singular leaves others.
constexpr std::array<double, 5> kMiddlePlaces{0.5, 0.4, 0.65, 0.28, 0.83};

/// Holds the times and effects of the impulses, and the spectrum of the weighted system.
struct System {
  std::array<GpsTime, kMaxTimes> times{};
  std::array<Matrix63, kMaxTimes> effects{};  ///< m of a*ROE per m/s of the deputy
  std::size_t count = 0;
  double smallest = 0.0;
  double largest = 0.0;

  [[nodiscard]] bool better_than(const System& other) const {
    return smallest * other.largest > other.smallest * largest;
  }
  [[nodiscard]] bool conditioned_below(double limit) const { return smallest * limit > largest; }
};

Matrix6 weighted_gramian(const System& system, const Vector6& weight) {
  Matrix6 gramian = Matrix6::Zero();
  for (std::size_t k = 0; k < system.count; ++k) {
    const Matrix63 weighted = weight.asDiagonal() * system.effects[k];
    gramian += weighted * weighted.transpose();
  }
  return gramian;
}

/// Makes the system of burns at both ends and, with three burns, at `middle_place` of the horizon.
Result<System> make_system(const ControlProblem& problem, const LeastSquaresSettings& settings, double middle_place) {
  const Duration horizon = problem.arrival - problem.start;
  const Duration middle = nearest_duration(middle_place * seconds(horizon));
  System system;
  system.times[system.count++] = problem.start;
  if (settings.burn_count == 3) system.times[system.count++] = problem.start + middle;
  system.times[system.count++] = problem.arrival;
  for (std::size_t k = 0; k < system.count; ++k) {
    system.effects[k] = problem.servicer_mean.a *
                        arrival_effect(problem.servicer_mean, problem.start, system.times[k], problem.arrival);
  }
  const auto eigen = math::symmetric_eigen<6>(weighted_gramian(system, settings.weight));
  if (!eigen.ok()) return eigen.status();
  const double minimum = eigen.value().values(0);
  system.smallest = minimum > 0.0 ? math::sqrt(minimum) : 0.0;
  system.largest = math::sqrt(eigen.value().values(5));
  return system;
}

/// Returns the first well-conditioned system over the places of the middle burn, or the best one.
Result<System> choose_system(const ControlProblem& problem, const LeastSquaresSettings& settings) {
  Result<System> best = make_system(problem, settings, kMiddlePlaces[0]);
  if (settings.burn_count == 2) return best;
  for (std::size_t k = 1; k < kMiddlePlaces.size(); ++k) {
    if (!best.ok() || best.value().conditioned_below(kGoodCondition)) return best;
    const Result<System> other = make_system(problem, settings, kMiddlePlaces[k]);
    if (!other.ok() || other.value().better_than(best.value())) best = other;
  }
  return best;
}

bool valid(const LeastSquaresSettings& settings) {
  return (settings.burn_count == 2 || settings.burn_count == 3) && settings.regularisation >= 0.0 &&
         math::is_finite(settings.regularisation) && settings.weight.minCoeff() > 0.0 &&
         math::is_finite(settings.weight.sum());
}

}  // namespace

Result<Plan> solve_least_squares(const ControlProblem& problem, const LeastSquaresSettings& settings,
                                 LeastSquaresReport* report) {
  if (!valid(settings)) return Status::kInvalidArgument;
  const Status checked = check_problem(problem);
  if (checked != Status::kOk) return checked;
  const Result<System> chosen = choose_system(problem, settings);
  if (!chosen.ok()) return chosen.status();
  const System& system = chosen.value();
  if (!system.conditioned_below(kMaxCondition)) return Status::kSingular;

  // With as many unknowns as equations or more, (B'B + alpha I)^-1 B' = B' (B B' + alpha I)^-1: a 6x6 system, B = W A.
  Matrix6 normal = weighted_gramian(system, settings.weight);
  normal.diagonal().array() += settings.regularisation;
  const math::Cholesky6 factor(normal);
  if (!factor.ok()) return Status::kSingular;
  const Vector6 target = problem.servicer_mean.a * problem.pseudo_state;
  const Vector6 multiplier = settings.weight.cwiseProduct(factor.solve(settings.weight.cwiseProduct(target)));

  Plan plan;
  plan.solver = LeastSquares::kId;
  Vector6 residual = target;
  for (std::size_t k = 0; k < system.count; ++k) {
    const Vector3 dv_deputy = system.effects[k].transpose() * multiplier;
    residual -= system.effects[k] * dv_deputy;
    plan.burns[plan.count++] = {system.times[k], -dv_deputy};
  }
  if (!math::is_finite(residual.sum())) return Status::kNotFinite;
  if (report != nullptr) *report = {system.smallest, system.largest, residual.norm(), system.times[1]};
  return plan;
}

}  // namespace vbar::fsw::control
