#include <algorithm>
#include <utility>

#include "fsw/control/primer_program.h"
#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"

namespace vbar::fsw::control {
namespace {

constexpr std::size_t kDimension = 6;
constexpr double kRegularisation = 1e-14;  ///< share of the trace of the weighted gramian
constexpr int kPasses = 3;                 ///< passes of iterative refinement
constexpr double kExact = 1e-13;           ///< residual that rounding leaves with |target| = 1

/// A subset of the program's impulses with new values.
struct Selection {
  std::array<std::size_t, kMaxActive> index{};
  std::array<Vector3, kMaxActive> dv;
  std::size_t count = 0;
};

Selection all_impulses(const PrimerProgram& program) {
  Selection all;
  for (std::size_t k = 0; k < program.count; ++k) {
    if (program.active[k].dv.squaredNorm() <= 0.0) continue;
    all.index[all.count] = k;
    all.dv[all.count++] = program.active[k].dv;
  }
  return all;
}

void remove(Selection& selection, std::size_t place) {
  --selection.count;
  for (std::size_t k = place; k < selection.count; ++k) {
    selection.index[k] = selection.index[k + 1];
    selection.dv[k] = selection.dv[k + 1];
  }
}

double cost_of(const Selection& selection) {
  double sum = 0.0;
  for (std::size_t k = 0; k < selection.count; ++k) sum += selection.dv[k].norm();
  return sum;
}

Vector6 residual_of(const PrimerProgram& program, const Selection& selection) {
  Vector6 residual = program.target;
  for (std::size_t k = 0; k < selection.count; ++k) {
    residual -= program.active[selection.index[k]].effect * selection.dv[k];
  }
  return residual;
}

/// A vector v != 0 with columns * v = 0 for seven columns in six dimensions: elimination with full pivoting; the
/// columns left without a pivot are free, the last of them is set to one.
std::array<double, kDimension + 1> null_vector(Eigen::Matrix<double, 6, 7> columns) {
  std::array<int, kDimension + 1> order{0, 1, 2, 3, 4, 5, 6};
  int rank = 0;
  for (; rank < 6; ++rank) {
    int pivot_row = rank;
    int pivot_column = rank;
    for (int c = rank; c < 7; ++c) {
      for (int r = rank; r < 6; ++r) {
        if (math::abs(columns(r, c)) > math::abs(columns(pivot_row, pivot_column))) {
          pivot_row = r;
          pivot_column = c;
        }
      }
    }
    if (math::abs(columns(pivot_row, pivot_column)) < kExact) break;
    columns.row(rank).swap(columns.row(pivot_row));
    columns.col(rank).swap(columns.col(pivot_column));
    std::swap(order[static_cast<std::size_t>(rank)], order[static_cast<std::size_t>(pivot_column)]);
    for (int r = rank + 1; r < 6; ++r) columns.row(r) -= columns(r, rank) / columns(rank, rank) * columns.row(rank);
  }
  Eigen::Matrix<double, 7, 1> v = Eigen::Matrix<double, 7, 1>::Zero();
  v(rank) = 1.0;
  for (int r = rank - 1; r >= 0; --r) {
    double sum = 0.0;
    for (int c = r + 1; c <= rank; ++c) sum += columns(r, c) * v(c);
    v(r) = -sum / columns(r, r);
  }
  std::array<double, kDimension + 1> result{};
  for (std::size_t k = 0; k < result.size(); ++k) result[static_cast<std::size_t>(order[k])] = v(static_cast<int>(k));
  return result;
}

/// Caratheodory's step on the first seven impulses: shifts their magnitudes along a null vector, in the direction that
/// does not raise the cost, until one of them vanishes.
void eliminate_one(const PrimerProgram& program, Selection& selection) {
  Eigen::Matrix<double, 6, 7> columns;
  std::array<double, kDimension + 1> magnitude{};
  for (std::size_t k = 0; k <= kDimension; ++k) {
    magnitude[k] = selection.dv[k].norm();
    if (!(magnitude[k] > 0.0)) {  // vanished together with the one eliminated before
      remove(selection, k);
      return;
    }
    columns.col(static_cast<int>(k)) = program.active[selection.index[k]].effect * (selection.dv[k] / magnitude[k]);
  }
  std::array<double, kDimension + 1> shift = null_vector(columns);
  double cost_rate = 0.0;
  for (const double v : shift) cost_rate += v;
  if (cost_rate > 0.0) {
    for (double& v : shift) v = -v;
  }
  // A shift without negative part would reach the target at no cost; only rounding errors can produce one.
  double length = 0.0;
  std::size_t vanishing = kDimension + 1;
  for (std::size_t k = 0; k <= kDimension; ++k) {
    if (shift[k] < 0.0 && (vanishing > kDimension || -magnitude[k] / shift[k] < length)) {
      length = -magnitude[k] / shift[k];
      vanishing = k;
    }
  }
  if (vanishing > kDimension) vanishing = 0;
  for (std::size_t k = 0; k <= kDimension; ++k) selection.dv[k] *= 1.0 + length * shift[k] / magnitude[k];
  remove(selection, vanishing);
}

/// Smallest change of the impulses, weighted by their size, that reaches the target; returns the residual. A
/// few impulses may span less than the state space and yet reach the target: hence the regularisation, whose error the
/// passes remove.
double meet_target(const PrimerProgram& program, Selection& selection) {
  Matrix6 normal = Matrix6::Zero();
  std::array<double, kMaxActive> weight{};
  for (std::size_t k = 0; k < selection.count; ++k) {
    const Matrix63& effect = program.active[selection.index[k]].effect;
    weight[k] = selection.dv[k].squaredNorm();
    normal += weight[k] * effect * effect.transpose();
  }
  normal.diagonal().array() += kRegularisation * normal.trace();
  const math::Cholesky6 factor(normal);
  for (int pass = 0; pass < kPasses; ++pass) {
    const Vector6 multiplier = factor.solve(residual_of(program, selection));
    for (std::size_t k = 0; k < selection.count; ++k) {
      selection.dv[k] += weight[k] * (program.active[selection.index[k]].effect.transpose() * multiplier);
    }
  }
  return residual_of(program, selection).norm();
}

/// Replaces `selection` by `candidate` if it reaches the target at no more than `cost_limit`.
bool accept(const PrimerProgram& program, Selection candidate, double cost_limit, Selection& selection) {
  if (candidate.count == 0 || !(meet_target(program, candidate) <= kExact) || !(cost_of(candidate) <= cost_limit)) {
    return false;
  }
  selection = candidate;
  return true;
}

/// Removes the residual of rounding and of the interior-point method.
void polish(const PrimerProgram& program, Selection& selection) {
  Selection polished = selection;
  if (meet_target(program, polished) < residual_of(program, selection).norm()) selection = polished;
}

/// Index of the smallest impulse between `above` and `limit`; count if there is none.
std::size_t smallest_impulse(const Selection& selection, double above, double limit) {
  std::size_t smallest = selection.count;
  double size = limit;
  for (std::size_t k = 0; k < selection.count; ++k) {
    const double dv = selection.dv[k].norm();
    if (dv > above && dv < size) {
      size = dv;
      smallest = k;
    }
  }
  return smallest;
}

void prune_small(const PrimerProgram& program, double ratio, double cost_limit, Selection& selection) {
  double largest = 0.0;
  for (std::size_t k = 0; k < selection.count; ++k) largest = std::max(largest, selection.dv[k].norm());
  double tried = 0.0;
  for (std::size_t attempt = 0; attempt < kDimension; ++attempt) {
    const std::size_t place = smallest_impulse(selection, tried, ratio * largest);
    if (place == selection.count) return;
    tried = selection.dv[place].norm();
    Selection candidate = selection;
    remove(candidate, place);
    accept(program, candidate, cost_limit, selection);
  }
}

/// True if impulses a and b are of the same thruster at times next to each other.
bool are_neighbours(const ActiveImpulse& a, const ActiveImpulse& b) {
  const std::size_t distance = a.time_index > b.time_index ? a.time_index - b.time_index : b.time_index - a.time_index;
  return distance == 1 && a.axes == b.axes;
}

/// Adds one impulse to a larger neighbour, if that is accepted.
bool join_one_pair(const PrimerProgram& program, double cost_limit, Selection& selection) {
  for (std::size_t a = 0; a < selection.count; ++a) {
    for (std::size_t b = 0; b < selection.count; ++b) {
      if (!are_neighbours(program.active[selection.index[a]], program.active[selection.index[b]])) continue;
      if (selection.dv[a].squaredNorm() < selection.dv[b].squaredNorm()) continue;
      Selection candidate = selection;
      candidate.dv[a] += candidate.dv[b];
      remove(candidate, b);
      if (accept(program, candidate, cost_limit, selection)) return true;
    }
  }
  return false;
}

void store(const Selection& selection, PrimerProgram& program) {
  // The selection's indices rise, so no impulse is overwritten before it has been read.
  for (std::size_t k = 0; k < selection.count; ++k) {
    program.active[k] = program.active[selection.index[k]];
    program.active[k].dv = selection.dv[k];
    program.active[k].bound = selection.dv[k].norm();
  }
  program.count = selection.count;
}

}  // namespace

void extract_impulses(PrimerProgram& program, double prune_ratio, double cost_limit) {
  Selection selection = all_impulses(program);
  while (selection.count > kDimension) eliminate_one(program, selection);

  prune_small(program, prune_ratio, cost_limit, selection);
  // The optimum of a continuous time between two grid points appears as a pair of impulses there.
  while (join_one_pair(program, cost_limit, selection)) {
  }
  polish(program, selection);
  store(selection, program);
}

double impulse_residual(const PrimerProgram& program) {
  return residual_of(program, all_impulses(program)).norm();
}

}  // namespace vbar::fsw::control
