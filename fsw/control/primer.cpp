#include "fsw/control/primer.h"

#include <algorithm>

#include "fsw/control/primer_program.h"
#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"

namespace vbar::fsw::control {
namespace {

constexpr std::size_t kCoarseTimes = 12;
static_assert(3 * kCoarseTimes <= kMaxActive);
constexpr std::size_t kMaxAdded = 10;  ///< impulses added to the active set at once
constexpr double kMinPivot = 1e-9;     ///< pivot of the equilibrated gramian; windows under about 0.1 s fall below
constexpr double kMinSpan = 1e-3;      ///< pivot of the active effects' gramian below which none is dropped
constexpr double kDropMargin = 0.01;   ///< impulses whose contact is lower than 1 by this leave the active set
constexpr double kGapShare = 1e-3;     ///< relative gap of each active set's program, in cost tolerances
constexpr double kProgress = 1e-2;     ///< relative decrease that counts as progress, likewise
constexpr double kNoBound = 1e300;
constexpr double kMaxResidual = 1e-10;  ///< residual of the impulses found, |target| = 1

/// The state in which the coarse times' gramian is the identity and |target| = 1.
struct Scaling {
  Matrix6 from_state = Matrix6::Identity();  ///< whitening transformation
  double target_norm = 1.0;                  ///< norm of the whitened target: unit of dv inside the program
};

Status check(const ImpulseGrid& grid, const Vector6& target, const PrimerSettings& settings) {
  const bool settings_valid = settings.cost_tolerance >= 1e-5 && settings.cost_tolerance <= 0.1 &&
                              settings.prune_ratio >= 0.0 && settings.prune_ratio < 1.0 && settings.max_rounds > 0 &&
                              settings.max_newton_steps > 0;
  if (!settings_valid || grid.effects.size() != grid.costs.size()) return Status::kInvalidArgument;
  return math::is_finite(target.cwiseAbs().sum()) ? Status::kOk : Status::kNotFinite;
}

/// Appends an impulse at a time of the grid to the program.
void add_impulse(const ImpulseGrid& grid, const Scaling& scaling, std::size_t time_index, AxisSet axes,
                 PrimerProgram& program) {
  ActiveImpulse& impulse = program.active[program.count++];
  impulse.effect = scaling.from_state * grid.effects[time_index];
  for (int axis = 0; axis < 3; ++axis) {
    if ((axes & (1U << axis)) == 0) impulse.effect.col(axis).setZero();
  }
  impulse.time_index = time_index;
  impulse.axes = axes;
}

/// Calls visit(index) for the coarse times: both ends and points between them by the golden ratio, whose spacing
/// is not commensurable with any period of the effects (at half and whole orbits they lose rank). A time may recur.
template <class Visit>
void for_each_coarse_time(std::size_t size, Visit visit) {
  constexpr double kGoldenRatio = 0.6180339887498949;
  visit(size - 1);
  double fraction = 0.0;
  for (std::size_t k = 1; k < kCoarseTimes; ++k) {
    visit(static_cast<std::size_t>(fraction * static_cast<double>(size)));
    fraction += kGoldenRatio;
    if (fraction >= 1.0) fraction -= 1.0;
  }
}

/// Whitening of the state by the gramian of the coarse times. kSingular if they do not span it.
Status make_scaling(const ImpulseGrid& grid, const Vector6& target, Scaling& scaling) {
  Matrix6 gramian = Matrix6::Zero();
  for_each_coarse_time(grid.effects.size(),
                       [&](std::size_t index) { gramian += grid.effects[index] * grid.effects[index].transpose(); });
  if (!math::is_finite(gramian.sum())) return Status::kNotFinite;
  if (!(gramian.diagonal().minCoeff() > 0.0)) return Status::kSingular;

  const Vector6 row_scale = gramian.diagonal().cwiseSqrt().cwiseInverse();
  const math::Cholesky6 factor(row_scale.asDiagonal() * gramian * row_scale.asDiagonal());
  if (!(factor.smallest_pivot() > kMinPivot)) return Status::kSingular;
  for (int c = 0; c < 6; ++c) {
    scaling.from_state.col(c) = factor.solve_lower(row_scale(c) * Vector6::Unit(c));
  }
  scaling.target_norm = (scaling.from_state * target).norm();
  return math::is_finite(scaling.target_norm) && scaling.target_norm > 0.0 ? Status::kOk : Status::kNotFinite;
}

/// A time at which the primer vector is too long.
struct Violation {
  std::size_t time_index = 0;
  Contact contact;
};

/// The contact function over the whole grid: its largest value and its highest peaks above 1.
struct GridScan {
  double largest_squared = 0.0;
  std::array<Violation, kMaxAdded> peaks{};  ///< highest first
  std::size_t peak_count = 0;
};

void insert_peak(const Violation& peak, GridScan& scan) {
  std::size_t place = scan.peak_count;
  if (place == kMaxAdded) {
    if (peak.contact.squared <= scan.peaks[place - 1].contact.squared) return;
    --place;
  } else {
    ++scan.peak_count;
  }
  for (; place > 0 && scan.peaks[place - 1].contact.squared < peak.contact.squared; --place) {
    scan.peaks[place] = scan.peaks[place - 1];
  }
  scan.peaks[place] = peak;
}

/// The ends of the grid count as peaks, a plateau by its last time. A non-finite value makes largest_squared non-finite
/// as well.
GridScan scan_grid(const ImpulseGrid& grid, const Vector6& lambda) {
  GridScan scan;
  Violation last;
  bool rising = true;
  double sum = 0.0;
  for (std::size_t k = 0; k < grid.effects.size(); ++k) {
    const Violation here{k, contact(grid.costs[k], grid.effects[k].transpose() * lambda)};
    sum += here.contact.squared;
    if (here.contact.squared > last.contact.squared) {
      rising = true;
    } else if (here.contact.squared < last.contact.squared) {
      if (rising && last.contact.squared > 1.0) insert_peak(last, scan);
      rising = false;
    }
    scan.largest_squared = std::max(scan.largest_squared, here.contact.squared);
    last = here;
  }
  if (rising && last.contact.squared > 1.0) insert_peak(last, scan);
  if (!math::is_finite(sum)) scan.largest_squared = sum;
  return scan;
}

bool spans(const Matrix6& gramian) {
  const math::Cholesky6 factor(gramian);
  return factor.smallest_pivot() > kMinSpan;
}

/// Drops the impulses whose contact is well below 1, except those without which the others would not span the state
/// space (lambda would then be unbounded).
void drop_inactive(PrimerProgram& program) {
  std::array<bool, kMaxActive> dropped{};
  Matrix6 kept_gramian = Matrix6::Zero();
  Matrix6 gramian = Matrix6::Zero();
  for (std::size_t k = 0; k < program.count; ++k) {
    const Matrix63& effect = program.active[k].effect;
    const double contact_squared = (effect.transpose() * program.lambda).squaredNorm();
    dropped[k] = contact_squared < (1.0 - kDropMargin) * (1.0 - kDropMargin);
    const Matrix6 own = effect * effect.transpose();
    gramian += own;
    if (!dropped[k]) kept_gramian += own;
  }
  if (!spans(kept_gramian)) {
    for (std::size_t k = 0; k < program.count; ++k) {
      if (!dropped[k]) continue;
      const Matrix6 without = gramian - program.active[k].effect * program.active[k].effect.transpose();
      dropped[k] = spans(without);
      if (dropped[k]) gramian = without;
    }
  }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < program.count; ++k) {
    if (!dropped[k]) program.active[kept++] = program.active[k];
  }
  program.count = kept;
}

void add_peaks(const ImpulseGrid& grid, const Scaling& scaling, const GridScan& scan, PrimerProgram& program) {
  for (std::size_t k = 0; k < scan.peak_count && program.count < kMaxActive; ++k) {
    add_impulse(grid, scaling, scan.peaks[k].time_index, scan.peaks[k].contact.axes, program);
  }
}

void start_program(const ImpulseGrid& grid, const Scaling& scaling, const Vector6& target, PrimerProgram& program) {
  program.target = scaling.from_state * target / scaling.target_norm;
  program.count = 0;
  for_each_coarse_time(grid.effects.size(), [&](std::size_t index) {
    const AxisGroups groups = axis_groups(grid.costs[index]);
    for (std::size_t k = 0; k < groups.count; ++k) add_impulse(grid, scaling, index, groups.group[k], program);
  });
}

/// The program's impulses in order of time, in the caller's units, merged by time; their cost and residual.
void store_impulses(const ImpulseGrid& grid, const PrimerProgram& program, double unit, PrimerSolution& solution) {
  for (std::size_t k = 0; k < program.count; ++k) {
    const ActiveImpulse& impulse = program.active[k];
    std::size_t place = 0;
    while (place < solution.count && solution.impulses[place].time_index < impulse.time_index) ++place;
    if (place == solution.count || solution.impulses[place].time_index != impulse.time_index) {
      for (std::size_t later = solution.count; later > place; --later) {
        solution.impulses[later] = solution.impulses[later - 1];
      }
      solution.impulses[place] = {impulse.time_index, Vector3::Zero()};
      ++solution.count;
    }
    solution.impulses[place].dv += unit * impulse.dv;
  }
  solution.residual = impulse_residual(program);
  for (std::size_t k = 0; k < solution.count; ++k) {
    solution.cost += impulse_cost(grid.costs[solution.impulses[k].time_index], solution.impulses[k].dv);
  }
}

}  // namespace

Result<PrimerSolution> solve_primer(const ImpulseGrid& grid, const Vector6& target, const PrimerSettings& settings,
                                    PrimerWorkspace& workspace) {
  const Status valid = check(grid, target, settings);
  if (valid != Status::kOk) return valid;
  if (target.isZero(0.0)) return PrimerSolution{};
  if (grid.effects.empty()) return Status::kSingular;

  Scaling scaling;
  const Status scaled = make_scaling(grid, target, scaling);
  if (scaled != Status::kOk) return scaled;
  PrimerProgram& program = workspace.program;
  start_program(grid, scaling, target, program);
  const Status started = start_primer_program(program);
  if (started != Status::kOk) return started;

  PrimerSolution solution;
  double min_bound = kNoBound;
  for (int round = 1; round <= settings.max_rounds; ++round) {
    const PrimerProgramEnd end =
        solve_primer_program(program, kGapShare * settings.cost_tolerance, settings.max_newton_steps);
    solution.newton_steps += end.steps;
    solution.rounds = round;
    if (end.status != Status::kOk) return Status::kDidNotConverge;

    solution.lambda = scaling.from_state.transpose() * program.lambda;
    const GridScan scan = scan_grid(grid, solution.lambda);
    if (!math::is_finite(scan.largest_squared)) return Status::kNotFinite;
    const double largest = math::sqrt(scan.largest_squared);
    if (largest <= 1.0 + settings.cost_tolerance) {
      solution.lambda /= std::max(1.0, largest);  // now feasible at every time
      solution.lower_bound = target.dot(solution.lambda);
      const double cost_limit = (1.0 + settings.cost_tolerance) * solution.lower_bound / scaling.target_norm;
      extract_impulses(program, settings.prune_ratio, cost_limit);
      store_impulses(grid, program, scaling.target_norm, solution);
      return solution.residual <= kMaxResidual ? Result<PrimerSolution>(solution) : Status::kDidNotConverge;
    }
    // If the dual has several optima, an exchange need not bring progress; dropping would then cycle.
    const double bound = program.target.dot(program.lambda);
    if (bound < min_bound * (1.0 - kProgress * settings.cost_tolerance)) drop_inactive(program);
    min_bound = std::min(min_bound, bound);
    add_peaks(grid, scaling, scan, program);
    const Status restarted = restart_primer_program(program);
    if (restarted != Status::kOk) return Status::kDidNotConverge;
  }
  return Status::kDidNotConverge;
}

}  // namespace vbar::fsw::control
