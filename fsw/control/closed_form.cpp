#include "fsw/control/closed_form.h"

#include <span>

#include "fsw/control/arrival.h"
#include "fsw/control/correction.h"
#include "fsw/control/near_circular.h"
#include "fsw/control/plan.h"
#include "fsw/control/tangential.h"
#include "fsw/math/math.h"

namespace vbar::fsw::control {
namespace {

// Impulses below this share of the plan are rounding errors.
constexpr double kNegligibleShare = 1e-6;

// Residual that a plan may have, as a share of the pseudo-state.
constexpr double kAcceptedResidual = 1e-6;

// Inclination changes below this, m, are rounding errors.
constexpr double kNoInclinationChange = 1e-9;

// Holds the impulses of a manoeuvring deputy.
struct DeputyBurns {
  static constexpr std::size_t kMax = TangentialBurns::kMax + 1;
  std::array<double, kMax> offsets{};  ///< s into the window
  std::array<Vector3, kMax> dv{};
  std::size_t count = 0;

  void add(double offset, const Vector3& impulse) {
    offsets[count] = offset;
    dv[count++] = impulse;
  }
  [[nodiscard]] double cost() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < count; ++k) sum += dv[k].norm();
    return sum;
  }
};

// Holds the problem with derived quantities common to all steps.
struct Model {
  const ControlProblem& problem;
  const ClosedFormSettings& settings;
  NearCircularOrbit orbit;
  double window = 0.0;  ///< s
  double latest = 0.0;  ///< last offset at which a burn is allowed, s

  [[nodiscard]] Matrix63 effect(double offset) const {
    return arrival_effect(problem.servicer_mean, problem.start, problem.start + nearest_duration(offset),
                          problem.arrival);
  }
  // Returns the residual of the pseudo-state after `burns`.
  [[nodiscard]] Vector6 residual(const DeputyBurns& burns) const {
    Vector6 left = problem.pseudo_state;
    for (std::size_t k = 0; k < burns.count; ++k) left -= effect(burns.offsets[k]) * burns.dv[k];
    return left;
  }
};

// Holds normal impulses, each of which achieves the inclination change by itself.
struct NormalBurns {
  struct Impulse {
    double offset = 0.0;  ///< s into the window
    double dv = 0.0;      ///< m/s along N
  };
  std::array<Impulse, kMaxPhaseTimes> impulses{};
  std::size_t count = 0;
};

// The node drifts with the inclination change between burn and arrival, so that the desired change, and its phase,
// depend slightly on the time to go: a contraction by the ratio of the drift rates, about 1e-3.
NormalBurns normal_burns(const Model& model, const Vector6& target) {
  constexpr int kRounds = 4;
  const NearCircularOrbit& orbit = model.orbit;
  const double dix = target[4];
  const double half_turn = math::kPi / orbit.latitude_rate;
  const double nominal_phase = math::atan2(target[5], dix);
  const double nominal_offset = math::wrap_to_pi(nominal_phase - orbit.u) / orbit.latitude_rate;

  NormalBurns burns;
  if (math::hypot(dix, target[5]) * orbit.a < kNoInclinationChange) return burns;
  const int before = static_cast<int>(math::floor(nominal_offset / half_turn)) + 1;
  for (int m = -before; burns.count < kMaxPhaseTimes; ++m) {
    double offset = nominal_offset + m * half_turn;
    if (offset > model.latest + half_turn) break;
    double diy = target[5];
    for (int round = 0; round < kRounds; ++round) {
      diy = target[5] - orbit.node_drift_rate * (model.window - offset) * dix;
      const double phase_change = math::wrap_to_pi(math::atan2(diy, dix) - nominal_phase);
      offset = nominal_offset + m * half_turn + phase_change / orbit.latitude_rate;
    }
    if (offset < 0.0 || offset > model.latest) continue;
    const double parity = m % 2 == 0 ? 1.0 : -1.0;
    burns.impulses[burns.count++] = {offset, parity * orbit.n * orbit.a * math::hypot(dix, diy)};
  }
  return burns;
}

// Times at which a tangential impulse changes the eccentricity vector along the desired change, or against it.
PhaseTimes tangential_grid(const Model& model, const TangentialTask& task) {
  const NearCircularOrbit& orbit = model.orbit;
  const double now = eccentricity_phase(orbit, model.window, 0.0);
  const double minimum = 0.5 * orbit.n * model.settings.eccentricity_floor_m;
  const bool has_phase = math::hypot(task.e_cos, task.e_sin) > minimum;
  const double phase = has_phase ? math::wrap_to_pi(math::atan2(task.e_sin, task.e_cos) - now) : 0.0;
  return phase_times(phase, orbit.latitude_rate - orbit.perigee_rate, model.latest);
}

// The grid and half orbits from both ends of the window.
struct Offsets {
  std::array<double, 3 * kMaxPhaseTimes> values{};
  std::size_t count = 0;
};

Offsets grid_and_edges(const Model& model, const PhaseTimes& grid) {
  const double half_turn = math::kPi / (model.orbit.latitude_rate - model.orbit.perigee_rate);
  Offsets offsets;
  for (const PhaseTime& time : grid.all()) offsets.values[offsets.count++] = time.offset;
  for (std::size_t k = 0; k < kMaxPhaseTimes; ++k) {
    const double along = static_cast<double>(k) * half_turn;
    if (along > model.latest) break;
    offsets.values[offsets.count++] = along;
    offsets.values[offsets.count++] = model.latest - along;
  }
  return offsets;
}

enum class InPlane : unsigned char { kGrid, kGridAndEdges };

Result<TangentialBurns> tangential_burns(const Model& model, const Vector6& target, InPlane method) {
  const TangentialTask task = tangential_task(model.orbit, target, model.window);
  const PhaseTimes grid = tangential_grid(model, task);
  if (method == InPlane::kGrid) return cheapest_three_burns(task, grid.all());
  const Offsets offsets = grid_and_edges(model, grid);
  return cheapest_four_burns(model.orbit, task, {offsets.values.data(), offsets.count});
}

// One solution: tangential impulses and the choice of normal ones, the coupling between them (J2, eccentricity)
// iterated away with the earliest normal impulse.
struct Solution {
  Vector6 target;  ///< corrected goal of the near-circular model
  TangentialBurns tangential;
  NormalBurns normal;
};

DeputyBurns separate_burns(const Solution& solution) {
  DeputyBurns burns;
  for (std::size_t k = 0; k < solution.tangential.count; ++k) {
    const TangentialBurns::Impulse& impulse = solution.tangential.impulses[k];
    burns.add(impulse.offset, {0.0, impulse.dv, 0.0});
  }
  if (solution.normal.count > 0)
    burns.add(solution.normal.impulses[0].offset, {0.0, 0.0, solution.normal.impulses[0].dv});
  return burns;
}

Result<Solution> coupled_solution(const Model& model, InPlane method) {
  constexpr int kRounds = 5;
  Vector6 target = model.problem.pseudo_state;
  Solution solution;
  for (int round = 0; round < kRounds; ++round) {
    const Result<TangentialBurns> tangential = tangential_burns(model, target, method);
    if (!tangential.ok()) return tangential.status();
    solution = {target, tangential.value(), normal_burns(model, target)};
    target += model.residual(separate_burns(solution));
  }
  return solution;
}

// The normal impulse is distributed over the tangential burns that have a normal time within the merge window, in
// proportion to their sizes: the components then add in quadrature. Those burns move to the normal time.
DeputyBurns spread_burns(const Model& model, const Solution& solution) {
  std::array<const NormalBurns::Impulse*, TangentialBurns::kMax> partner{};
  double shared = 0.0;
  for (std::size_t k = 0; k < solution.tangential.count; ++k) {
    double nearest = model.settings.merge_window;
    for (std::size_t j = 0; j < solution.normal.count; ++j) {
      const double apart = math::abs(solution.normal.impulses[j].offset - solution.tangential.impulses[k].offset);
      if (apart > nearest) continue;
      nearest = apart;
      partner[k] = &solution.normal.impulses[j];
    }
    if (partner[k] != nullptr) shared += math::abs(solution.tangential.impulses[k].dv);
  }
  if (shared <= 0.0) return separate_burns(solution);

  DeputyBurns burns;
  for (std::size_t k = 0; k < solution.tangential.count; ++k) {
    const TangentialBurns::Impulse& tangential = solution.tangential.impulses[k];
    if (partner[k] == nullptr) {
      burns.add(tangential.offset, {0.0, tangential.dv, 0.0});
    } else {
      burns.add(partner[k]->offset, {0.0, tangential.dv, partner[k]->dv * math::abs(tangential.dv) / shared});
    }
  }
  return burns;
}

DeputyBurns without_negligible(const DeputyBurns& burns) {
  const double minimum = kNegligibleShare * burns.cost();
  DeputyBurns kept;
  for (std::size_t k = 0; k < burns.count; ++k) {
    if (burns.dv[k].norm() > minimum) kept.add(burns.offsets[k], burns.dv[k]);
  }
  return kept;
}

bool meets(const Model& model, const Vector6& left) {
  return left.norm() <= kAcceptedResidual * model.problem.pseudo_state.norm();
}

// Removes the residual of merging and of the near-circular model, as far as burns at these times can: one linear step
// solves the linear model, a second one its rounding errors.
Result<DeputyBurns> polished(const Model& model, DeputyBurns burns) {
  constexpr int kRounds = 2;
  std::array<Matrix63, DeputyBurns::kMax> effects;
  for (std::size_t k = 0; k < burns.count; ++k) effects[k] = model.effect(burns.offsets[k]);
  for (int round = 0; round < kRounds; ++round) {
    const Result<Correction> correction = least_norm_correction({effects.data(), burns.count}, model.residual(burns));
    if (!correction.ok()) return correction.status();
    for (std::size_t k = 0; k < burns.count; ++k) burns.dv[k] += correction.value().dv[k];
  }
  return burns;
}

enum class Arrangement : unsigned char { kSeparate, kSpread };

// Burns at the normal phase cannot change the inclination vector across it. A residual in that direction changes the
// phase itself; no other residual may, to avoid divergence.
Result<DeputyBurns> arranged(const Model& model, Solution solution, Arrangement arrangement) {
  constexpr int kRounds = 4;
  Vector6 target = solution.target;
  for (int round = 0; round < kRounds; ++round) {
    const DeputyBurns raw =
        arrangement == Arrangement::kSeparate ? separate_burns(solution) : spread_burns(model, solution);
    const Result<DeputyBurns> burns = polished(model, without_negligible(raw));
    if (!burns.ok()) return burns;
    const Vector6 left = model.residual(burns.value());
    if (meets(model, left)) return burns;
    target.tail<2>() += left.tail<2>();
    solution.normal = normal_burns(model, target);
  }
  return Status::kDidNotConverge;
}

Burn* burn_at(Plan& plan, GpsTime time) {
  for (std::size_t k = 0; k < plan.count; ++k) {
    if (plan.burns[k].time == time) return &plan.burns[k];
  }
  return nullptr;
}

// In order of time; burns of the same instant are merged.
Plan servicer_plan(const Model& model, const DeputyBurns& burns) {
  Plan plan;
  plan.solver = ClosedForm::kId;
  for (std::size_t k = 0; k < burns.count; ++k) {
    const Burn burn{model.problem.start + nearest_duration(burns.offsets[k]), -burns.dv[k]};
    if (Burn* same = burn_at(plan, burn.time)) {
      same->dv_rtn += burn.dv_rtn;
      continue;
    }
    std::size_t slot = plan.count++;
    for (; slot > 0 && burn.time < plan.burns[slot - 1].time; --slot) plan.burns[slot] = plan.burns[slot - 1];
    plan.burns[slot] = burn;
  }
  return plan;
}

}  // namespace

Result<Plan> solve_closed_form(const ControlProblem& problem, const ClosedFormSettings& settings) {
  const Status valid = check_problem(problem);
  if (valid != Status::kOk) return valid;
  const double window = seconds(problem.arrival - problem.start);
  if (window <= settings.final_coast) return Status::kInvalidArgument;
  const Model model{problem, settings, near_circular_orbit(problem.servicer_mean), window,
                    window - settings.final_coast};

  if (problem.pseudo_state.isZero(0.0)) return servicer_plan(model, {});
  Result<Plan> best = Status::kSingular;
  double best_cost = 0.0;
  for (const InPlane method : {InPlane::kGrid, InPlane::kGridAndEdges}) {
    const Result<Solution> solution = coupled_solution(model, method);
    if (!solution.ok()) {
      if (!best.ok()) best = solution.status();
      continue;
    }
    for (const Arrangement arrangement : {Arrangement::kSeparate, Arrangement::kSpread}) {
      const Result<DeputyBurns> candidate = arranged(model, solution.value(), arrangement);
      if (!candidate.ok()) {
        if (!best.ok()) best = candidate.status();
        continue;
      }
      const double cost = candidate.value().cost();
      if (best.ok() && cost >= best_cost) continue;
      best = servicer_plan(model, candidate.value());
      best_cost = cost;
    }
  }
  return best;
}

}  // namespace vbar::fsw::control
