#include "fsw/control/tangential.h"

#include <Eigen/LU>

#include "fsw/math/math.h"

namespace vbar::fsw::control {
namespace {

using Vector4 = Eigen::Matrix<double, 4, 1>;
using Matrix4 = Eigen::Matrix<double, 4, 4>;

// Largest relative difference of equally cheap solutions. The earlier times are then chosen, independent of rounding
// errors.
constexpr double kSameCost = 1e-9;

// Returns the magnitudes at three times; kSingular if they share one parity.
Result<TangentialBurns> three_burns(const TangentialTask& task, const std::array<PhaseTime, 3>& times) {
  // The one of the single parity is c; a and b share the other.
  std::size_t c = 3;
  for (std::size_t k = 0; k < 3; ++k) {
    if (times[(k + 1) % 3].parity != times[k].parity && times[(k + 2) % 3].parity != times[k].parity) c = k;
  }
  if (c == 3) return Status::kSingular;
  const std::size_t a = (c + 1) % 3;
  const std::size_t b = (c + 2) % 3;
  const double tau_b = task.window - times[b].offset;
  const double tau_c = task.window - times[c].offset;

  // sum x = S, sum parity x = D, sum tau x = L
  const double along = math::hypot(task.e_cos, task.e_sin) * times[a].parity;
  const double majority = 0.5 * (task.sum + along);
  const double x_c = 0.5 * (task.sum - along);
  const double x_a = (task.moment - tau_c * x_c - tau_b * majority) / (times[b].offset - times[a].offset);
  TangentialBurns burns;
  burns.impulses[c] = {times[c].offset, x_c};
  burns.impulses[a] = {times[a].offset, x_a};
  burns.impulses[b] = {times[b].offset, majority - x_a};
  burns.count = 3;
  return burns;
}

// Returns the effect of a unit tangential impulse on [sum, moment / window, e_cos, e_sin].
Vector4 column(const NearCircularOrbit& orbit, double window, double offset) {
  const double phase = eccentricity_phase(orbit, window, offset);
  return {1.0, 1.0 - offset / window, math::cos(phase), math::sin(phase)};
}

Vector4 right_hand_side(const TangentialTask& task) {
  return {task.sum, task.moment / task.window, task.e_cos, task.e_sin};
}

// One basis of the simplex method: four columns, each with a sign such that its variable is not negative. Index
// kArtificial and above are the four unit columns of the start, with a cost so high that they leave.
struct Basis {
  static constexpr std::size_t kArtificial = 1U << 16;
  static constexpr double kArtificialPrice = 1e4;

  Matrix4 columns = Matrix4::Zero();
  Vector4 prices = Vector4::Constant(kArtificialPrice);
  std::array<std::size_t, 4> members{};

  explicit Basis(const Vector4& rhs) {
    for (int row = 0; row < 4; ++row) {
      columns(row, row) = rhs[row] < 0.0 ? -1.0 : 1.0;
      members[static_cast<std::size_t>(row)] = kArtificial + static_cast<std::size_t>(row);
    }
  }
  void replace(int slot, std::size_t member, const Vector4& signed_column) {
    columns.col(slot) = signed_column;
    prices[slot] = 1.0;
    members[static_cast<std::size_t>(slot)] = member;
  }
};

}  // namespace

PhaseTimes phase_times(double phase, double rate, double window) {
  PhaseTimes result;
  const double first = phase / rate;
  const double half_turn = math::kPi / rate;
  int m = static_cast<int>(math::floor(-first / half_turn));
  for (; result.count < kMaxPhaseTimes; ++m) {
    const double offset = first + m * half_turn;
    if (offset > window) break;
    if (offset >= 0.0) result.times[result.count++] = {offset, m % 2 == 0 ? 1.0 : -1.0};
  }
  return result;
}

double TangentialBurns::cost() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < count; ++k) sum += math::abs(impulses[k].dv);
  return sum;
}

Result<TangentialBurns> cheapest_three_burns(const TangentialTask& task, std::span<const PhaseTime> grid) {
  Result<TangentialBurns> best = Status::kSingular;
  double best_cost = 0.0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    for (std::size_t j = i + 1; j < grid.size(); ++j) {
      for (std::size_t k = j + 1; k < grid.size(); ++k) {
        const Result<TangentialBurns> trial = three_burns(task, {grid[i], grid[j], grid[k]});
        if (!trial.ok()) continue;
        const double cost = trial.value().cost();
        if (best.ok() && cost >= best_cost * (1.0 - kSameCost)) continue;
        best = trial;
        best_cost = cost;
      }
    }
  }
  return best;
}

Result<TangentialBurns> cheapest_four_burns(const NearCircularOrbit& orbit, const TangentialTask& task,
                                            std::span<const double> offsets) {
  constexpr int kMaxPivots = 100;
  constexpr double kOptimal = 1e-9;
  const Vector4 rhs = right_hand_side(task);
  Basis basis(rhs);
  for (int pivot = 0; pivot < kMaxPivots; ++pivot) {
    const Matrix4 inverse = basis.columns.inverse();
    const Vector4 amounts = inverse * rhs;
    const Vector4 duals = inverse.transpose() * basis.prices;

    // The column with the most negative reduced cost enters, with the sign that makes its amount positive.
    std::size_t entering = offsets.size();
    double steepest = 1.0 + kOptimal;
    Vector4 entering_column = Vector4::Zero();
    for (std::size_t k = 0; k < offsets.size(); ++k) {
      const Vector4 candidate = column(orbit, task.window, offsets[k]);
      const double gain = duals.dot(candidate);
      if (math::abs(gain) <= steepest) continue;
      steepest = math::abs(gain);
      entering = k;
      entering_column = gain < 0.0 ? Vector4(-candidate) : candidate;
    }
    if (entering == offsets.size()) {
      TangentialBurns burns;
      for (std::size_t slot = 0; slot < 4; ++slot) {
        const int row = static_cast<int>(slot);
        if (basis.members[slot] >= Basis::kArtificial) {
          if (amounts[row] > 1e-9 * (1e-6 + rhs.cwiseAbs().maxCoeff())) return Status::kSingular;
          continue;
        }
        const double dv = amounts[row] * basis.columns(0, row);
        burns.impulses[burns.count++] = {offsets[basis.members[slot]], dv};
      }
      return burns;
    }

    const Vector4 use = inverse * entering_column;
    int leaving = -1;
    double minimum = 0.0;
    for (int row = 0; row < 4; ++row) {
      if (use[row] < 1e-12) continue;
      const double ratio = amounts[row] / use[row];
      if (leaving >= 0 && ratio >= minimum) continue;
      leaving = row;
      minimum = ratio;
    }
    if (leaving < 0) return Status::kSingular;
    basis.replace(leaving, entering, entering_column);
  }
  return Status::kDidNotConverge;
}

}  // namespace vbar::fsw::control
