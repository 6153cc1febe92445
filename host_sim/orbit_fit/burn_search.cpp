#include "host_sim/orbit_fit/burn_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "fsw/orbit/rtn.h"

namespace vbar::orbit_fit {

namespace {

using Matrix63 = Eigen::Matrix<double, 6, 3>;

/// Sums over the positions behind a candidate, in the coordinates of the orthogonal factor.
struct Candidate {
  double seconds = 0.0;
  Matrix63 impulse;             ///< B
  fsw::Matrix6 overlap;         ///< M
  Eigen::MatrixXd by_unknowns;  ///< W
  fsw::Vector6 remainder;       ///< sum Q6^T r
};

class Candidates {
 public:
  Candidates(const Batch& batch, const FittedOrbit& fitted, const std::array<bool, 3>& axes) : axes_(axes) {
    const Eigen::Index unknowns = fitted.design.cols(), rows = fitted.design.rows();
    const Eigen::VectorXd norms = fitted.design.colwise().norm();
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(fitted.design * norms.cwiseInverse().asDiagonal());
    const Eigen::MatrixXd Q = qr.householderQ() * Eigen::MatrixXd::Identity(rows, unknowns);
    const fsw::Matrix6 R66 =
        fsw::Matrix6(qr.matrixQR().topLeftCorner<6, 6>().triangularView<Eigen::Upper>()) * norms.head<6>().asDiagonal();
    const Eigen::VectorXd left = fitted.remainder - Q * (Q.transpose() * fitted.remainder);
    squares_ = left.squaredNorm();
    positions_ = rows / 3;

    Candidate sums;
    sums.overlap.setZero();
    sums.by_unknowns = Eigen::MatrixXd::Zero(6, unknowns);
    sums.remainder.setZero();
    const Arc& arc = batch.arc();
    Eigen::Index row = rows;
    for (std::size_t k = arc.seconds.size(); k-- > 1;) {
      if (!fitted.used[k]) continue;
      row -= 3;
      const Eigen::Matrix<double, 3, 6> Q6 = Q.block<3, 6>(row, 0);
      sums.overlap += Q6.transpose() * Q6;
      sums.by_unknowns += Q6.transpose() * Q.middleRows<3>(row);
      sums.remainder += Q6.transpose() * left.segment<3>(row);
      sums.seconds = 0.5 * (arc.seconds[k] + arc.seconds[k - 1]);
      Matrix63 at_burn = Matrix63::Zero();
      at_burn.bottomRows<3>() = fsw::orbit::R_rtn_eci(fitted.states[k]).transpose();
      sums.impulse = R66 * batch.transition().inverse_at(sums.seconds) * at_burn;
      candidates_.push_back(sums);
    }
    std::ranges::reverse(candidates_);
  }

  [[nodiscard]] std::size_t size() const { return candidates_.size(); }
  [[nodiscard]] double seconds(std::size_t k) const { return candidates_[k].seconds; }

  struct Solution {
    double reduction = 0.0;
    Eigen::VectorXd dv;  ///< RTN of each impulse
  };

  /// Impulses at candidates in ascending order.
  [[nodiscard]] Solution solve(const std::vector<std::size_t>& places) const {
    const auto count = static_cast<Eigen::Index>(3 * places.size());
    Eigen::MatrixXd normal(count, count);
    Eigen::VectorXd right(count);
    for (std::size_t a = 0; a < places.size(); ++a) {
      const Candidate& first = candidates_[places[a]];
      right.segment<3>(static_cast<Eigen::Index>(3 * a)) = first.impulse.transpose() * first.remainder;
      for (std::size_t b = a; b < places.size(); ++b) {
        const Candidate& later = candidates_[places[b]];
        const fsw::Matrix6 inner = later.overlap - first.by_unknowns * later.by_unknowns.transpose();
        const fsw::Matrix3 block = first.impulse.transpose() * inner * later.impulse;
        normal.block<3, 3>(static_cast<Eigen::Index>(3 * a), static_cast<Eigen::Index>(3 * b)) = block;
        normal.block<3, 3>(static_cast<Eigen::Index>(3 * b), static_cast<Eigen::Index>(3 * a)) = block.transpose();
      }
    }
    for (Eigen::Index k = 0; k < count; ++k) {
      if (axes_[static_cast<std::size_t>(k % 3)]) continue;
      normal.row(k).setZero();
      normal.col(k).setZero();
      normal(k, k) = 1.0;
      right[k] = 0.0;
    }
    const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
    const Eigen::LDLT<Eigen::MatrixXd> factor(scaled);
    constexpr double kSingular = 1e-9;
    if (factor.info() != Eigen::Success || factor.vectorD().minCoeff() < kSingular)
      return {0.0, Eigen::VectorXd::Zero(count)};
    Solution solution;
    solution.dv = scale.asDiagonal() * factor.solve(scale.asDiagonal() * right).eval();
    solution.reduction = right.dot(solution.dv);
    return solution;
  }

  [[nodiscard]] double rms_after(double reduction) const {
    return std::sqrt(std::max(0.0, squares_ - reduction) / static_cast<double>(positions_));
  }

 private:
  std::array<bool, 3> axes_;
  std::vector<Candidate> candidates_;
  double squares_ = 0.0;
  Eigen::Index positions_ = 1;
};

struct Best {
  std::vector<std::size_t> places;
  Candidates::Solution solution;
  void take(std::vector<std::size_t> at, Candidates::Solution found) {
    if (found.reduction <= solution.reduction) return;
    places = std::move(at);
    solution = std::move(found);
  }
};

Best best_single(const Candidates& candidates) {
  Best best;
  for (std::size_t k = 0; k < candidates.size(); ++k) best.take({k}, candidates.solve({k}));
  return best;
}

/// The pair with both impulses within `reach_s` of a time: a coarse grid, then all candidates about its best.
Best best_pair(const Candidates& candidates, double about_s, double reach_s) {
  const auto place_of = [&](double seconds) {
    std::size_t k = 0;
    while (k + 1 < candidates.size() && candidates.seconds(k) < seconds) ++k;
    return k;
  };
  const std::size_t from = place_of(about_s - reach_s), to = place_of(about_s + reach_s) + 1;
  constexpr std::size_t kGrid = 100;
  std::size_t stride = std::max<std::size_t>(1, (to - from) / kGrid);
  Best best;
  for (std::size_t a = from; a < to; a += stride)
    for (std::size_t b = a + stride; b < to; b += stride) best.take({a, b}, candidates.solve({a, b}));
  while (stride > 1 && !best.places.empty()) {
    const std::size_t finer = std::max<std::size_t>(1, stride / 4);
    const std::vector<std::size_t> centre = best.places;
    const auto low = [&](std::size_t place) { return place > from + stride ? place - stride : from; };
    for (std::size_t a = low(centre[0]); a <= centre[0] + stride && a < to; a += finer)
      for (std::size_t b = std::max(low(centre[1]), a + 1); b <= centre[1] + stride && b < to; b += finer)
        best.take({a, b}, candidates.solve({a, b}));
    stride = finer;
  }
  return best;
}

/// Impulses explain a residual if they halve it, beyond what so many more unknowns (a time and three components each)
/// take from as many independent residuals: a force that is not modelled well leaves more, and a short arc has few.
constexpr double kExplains = 0.5;

bool explains(const FittedOrbit& fitted, double rms_before, double rms_after, std::size_t impulses) {
  const double independent = static_cast<double>(fitted.remainder.size()) / fitted.correlated;
  const double left = std::max(1.0, independent - 4.0 * static_cast<double>(impulses)) / independent;
  return rms_after < kExplains * std::sqrt(left) * rms_before;
}

}  // namespace

std::optional<Break> find_break(const Batch& batch, const FittedOrbit& fitted, const Estimated& estimated) {
  const double radius_m = batch.arc().first.position_eci.norm();
  const double period_s =
      2.0 * std::numbers::pi * std::sqrt(radius_m * radius_m * radius_m / batch.dynamics().data().gravity->gm());
  // Within fewer revolutions an impulse does what a smooth force does.
  constexpr double kMinRevolutions = 3.0;
  if (batch.arc().length_s() < kMinRevolutions * period_s) return std::nullopt;
  const Candidates candidates(batch, fitted, estimated.burn_axes);
  Best best = best_single(candidates);
  if (best.places.empty()) return std::nullopt;
  constexpr double kReach_revolutions = 2.0;
  Best pair = best_pair(candidates, candidates.seconds(best.places.front()), kReach_revolutions * period_s);
  const double one_leaves_m = candidates.rms_after(best.solution.reduction);
  if (!pair.places.empty() && candidates.rms_after(pair.solution.reduction) < kExplains * one_leaves_m)
    best = std::move(pair);
  Break found;
  found.rms_m = candidates.rms_after(best.solution.reduction);
  if (!explains(fitted, candidates.rms_after(0.0), found.rms_m, best.places.size())) return std::nullopt;
  for (std::size_t k = 0; k < best.places.size(); ++k)
    found.burns.push_back(
        {candidates.seconds(best.places[k]), best.solution.dv.segment<3>(static_cast<Eigen::Index>(3 * k)), 0.0});
  return found;
}

FittedOrbit fit_with_found_burns(const Batch& batch, FittedOrbit fitted, const Estimated& estimated,
                                 std::size_t largest) {
  while (fitted.parameters.burns.size() < largest) {
    const std::optional<Break> found = find_break(batch, fitted, estimated);
    if (!found || fitted.parameters.burns.size() + found->burns.size() > largest) break;
    OrbitParameters with = fitted.parameters;
    with.burns.insert(with.burns.end(), found->burns.begin(), found->burns.end());
    std::ranges::sort(with.burns, {}, &Burn::seconds);
    FittedOrbit again = batch.fit(with, estimated);
    if (!(again.rms_m < fitted.rms_m)) break;
    fitted = std::move(again);
  }
  return fitted;
}

}  // namespace vbar::orbit_fit
