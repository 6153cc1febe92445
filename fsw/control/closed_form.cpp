#include "fsw/control/closed_form.h"

#include "fsw/control/arrival.h"
#include "fsw/math/math.h"

namespace vbar::fsw::control {
namespace {

constexpr std::size_t kMaxTimes = 40;  // twice a revolution: windows up to 20 revolutions
constexpr double kMergeWithin = 60.0;  // s; burns closer than this become one

/// An admissible burn time and the sign with which a burn there counts.
struct Opportunity {
  double offset = 0.0;  // s after the start
  double parity = 1.0;
};

struct Opportunities {
  std::array<Opportunity, kMaxTimes> at{};
  std::size_t count = 0;
};

/// Times in [0, window] at which an angle that is `angle` at the start and grows by `rate` equals `phase` modulo pi.
Opportunities opportunities(double phase, double angle, double rate, double window) {
  Opportunities found;
  double to_go = math::wrap_to_pi(phase - angle);
  double parity = 1.0;
  if (to_go < 0.0) {
    to_go += math::kPi;
    parity = -1.0;
  }
  for (double offset = to_go / rate; offset <= window && found.count < kMaxTimes; offset += math::kPi / rate) {
    found.at[found.count++] = {offset, parity};
    parity = -parity;
  }
  return found;
}

/// Burns at c (one parity) and a, b (the other) that meet sum, de and moment; cost infinite-free: the denominator is a time.
struct Triple {
  std::array<Opportunity, 3> at{};
  std::array<double, 3> dv{};
  double cost = 0.0;
};

Triple solve_triple(const TangentialTask& task, double de, Opportunity a, Opportunity b, Opportunity c) {
  const double p = a.parity;
  const double x_c = 0.5 * (task.sum - p * de);
  const double majority = 0.5 * (task.sum + p * de);
  const double tau_a = task.window - a.offset;
  const double tau_b = task.window - b.offset;
  const double tau_c = task.window - c.offset;
  const double x_a = (task.moment - tau_c * x_c - tau_b * majority) / (tau_a - tau_b);
  const double x_b = majority - x_a;
  Triple triple{{a, b, c}, {x_a, x_b, x_c}, math::abs(x_a) + math::abs(x_b) + math::abs(x_c)};
  return triple;
}

/// Burns in order of time.
TangentialScheme in_order(const Triple& triple) {
  std::array<std::size_t, 3> order{0, 1, 2};
  for (std::size_t k = 1; k < 3; ++k) {
    for (std::size_t j = k; j > 0 && triple.at[order[j]].offset < triple.at[order[j - 1]].offset; --j) {
      const std::size_t later = order[j - 1];
      order[j - 1] = order[j];
      order[j] = later;
    }
  }
  TangentialScheme scheme;
  for (std::size_t k = 0; k < 3; ++k) {
    scheme.offset[k] = triple.at[order[k]].offset;
    scheme.dv[k] = triple.dv[order[k]];
  }
  scheme.cost = triple.cost;
  return scheme;
}

}  // namespace

Result<TangentialScheme> cheapest_tangential_scheme(const NearCircularOrbit& orbit, const Vector6& pseudo_state,
                                                    double window) {
  const TangentialTask task = tangential_task(orbit, pseudo_state, window);
  const double de = math::hypot(task.e_cos, task.e_sin);
  // Phase wanted at the end of the window; where there is nothing to turn, the first burn is now.
  constexpr double kNoEccentricityChange = 1e-9;  // of ROE: 7 mm
  const double now = eccentricity_phase(orbit, window, 0.0);
  const bool turns = math::hypot(pseudo_state[2], pseudo_state[3]) > kNoEccentricityChange;
  const double phase = turns ? math::atan2(task.e_sin, task.e_cos) : now;
  const Opportunities times = opportunities(phase, now, orbit.latitude_rate - orbit.perigee_rate, window);

  bool found = false;
  Triple best;
  for (std::size_t i = 0; i < times.count; ++i) {
    for (std::size_t j = i + 1; j < times.count; ++j) {
      if (times.at[i].parity * times.at[j].parity < 0.0) continue;
      for (std::size_t k = 0; k < times.count; ++k) {
        if (times.at[k].parity * times.at[i].parity > 0.0) continue;
        const Triple candidate = solve_triple(task, de, times.at[i], times.at[j], times.at[k]);
        if (!found || candidate.cost < best.cost) best = candidate;
        found = true;
      }
    }
  }
  if (!found) return Status::kNotReady;
  TangentialScheme scheme = in_order(best);
  scheme.bounds = reachable_bounds(orbit, pseudo_state, window);
  return scheme;
}

namespace {

/// Burns of a deputy, T and N, at offsets from the start.
struct DeputyBurn {
  double offset = 0.0;
  Vector3 dv = Vector3::Zero();
};

struct DeputyBurns {
  std::array<DeputyBurn, 6> burn{};
  std::size_t count = 0;
};

/// The normal part of `pseudo_state` in proportion to the tangential burns, each share at the opportunity nearest to its
/// tangential burn, and in the same burn if that is within kMergeWithin.
DeputyBurns with_normal_burns(const NearCircularOrbit& orbit, const Vector6& pseudo_state, double window,
                              const TangentialScheme& scheme) {
  DeputyBurns burns;
  for (std::size_t k = 0; k < 3; ++k) burns.burn[burns.count++] = {scheme.offset[k], {0.0, scheme.dv[k], 0.0}};
  const double dix = pseudo_state[4];
  const double total = scheme.cost > 0.0 ? scheme.cost : 1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double share = scheme.cost > 0.0 ? math::abs(scheme.dv[k]) / total : 1.0 / 3.0;
    // Between a burn and the end J2 turns dix into diy: what is wanted at the end is wanted less of that at the burn.
    const double diy = pseudo_state[5] - orbit.node_drift_rate * (window - scheme.offset[k]) * dix;
    const double dv_n = share * orbit.n * orbit.a * math::hypot(dix, diy);
    if (dv_n == 0.0) continue;
    const Opportunities times = opportunities(math::atan2(diy, dix), orbit.u, orbit.latitude_rate, window);
    if (times.count == 0) continue;
    Opportunity nearest = times.at[0];
    for (std::size_t m = 1; m < times.count; ++m) {
      if (math::abs(times.at[m].offset - scheme.offset[k]) < math::abs(nearest.offset - scheme.offset[k])) {
        nearest = times.at[m];
      }
    }
    const Vector3 dv{0.0, 0.0, nearest.parity * dv_n};
    if (math::abs(nearest.offset - scheme.offset[k]) < kMergeWithin) {
      burns.burn[k].dv += dv;
    } else {
      burns.burn[burns.count++] = {nearest.offset, dv};
    }
  }
  return burns;
}

/// ROE at the arrival that the burns leave undone.
Vector6 residual(const ControlProblem& problem, const DeputyBurns& burns) {
  Vector6 left = problem.pseudo_state;
  for (std::size_t k = 0; k < burns.count; ++k) {
    const GpsTime time = problem.start + nearest_duration(burns.burn[k].offset);
    left -= arrival_effect(problem.servicer_mean, problem.start, time, problem.arrival) * burns.burn[k].dv;
  }
  return left;
}

/// In order of time, turned into the servicer's.
Plan plan_of(const ControlProblem& problem, const DeputyBurns& burns) {
  Plan plan;
  plan.solver = Solver::kClosedForm;
  for (std::size_t k = 0; k < burns.count; ++k) {
    const Burn burn{problem.start + nearest_duration(burns.burn[k].offset), -burns.burn[k].dv};
    std::size_t place = plan.count++;
    for (; place > 0 && burn.time < plan.burns[place - 1].time; --place) plan.burns[place] = plan.burns[place - 1];
    plan.burns[place] = burn;
  }
  return plan;
}

}  // namespace

Result<Plan> solve_closed_form(const ControlProblem& problem) {
  if (problem.arrival <= problem.start) return Status::kInvalidArgument;
  if (!math::is_finite(problem.pseudo_state.sum())) return Status::kNotFinite;
  const double window = seconds(problem.arrival - problem.start);
  const NearCircularOrbit orbit = near_circular_orbit(problem.servicer_mean);

  constexpr int kMaxRounds = 12;
  Vector6 wanted = problem.pseudo_state;
  DeputyBurns best;
  double best_left = -1.0;
  for (int round = 0; round < kMaxRounds; ++round) {
    const Result<TangentialScheme> scheme = cheapest_tangential_scheme(orbit, wanted, window);
    if (!scheme.ok()) return scheme.status();
    const DeputyBurns burns = with_normal_burns(orbit, wanted, window, scheme.value());
    const Vector6 left = residual(problem, burns);
    if (best_left < 0.0 || left.norm() < best_left) {
      best = burns;
      best_left = left.norm();
    }
    if (best_left <= 1e-9 * problem.pseudo_state.norm()) break;
    wanted += left;
  }
  return plan_of(problem, best);
}

}  // namespace vbar::fsw::control
