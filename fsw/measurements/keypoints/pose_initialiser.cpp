#include "fsw/measurements/keypoints/pose_initialiser.h"

#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::measurements {
namespace {

constexpr Duration kOldest = duration_of_seconds(75);
constexpr double kLongestPair_s = 20.0;
constexpr double kPriorPosition_m = 300.0;
// Errors of neighbouring images are correlated: this number of them counts as one.
constexpr double kAlike = 3.0;
constexpr int kRounds = 3;

constexpr double square(double x) {
  return x * x;
}

/// The target's state from its position and velocity in the servicer's RTN.
orbit::CartesianState target_at(const orbit::CartesianState& servicer, const Vector6& rtn) {
  const Matrix3 R_eci_rtn = orbit::R_rtn_eci(servicer).transpose();
  const double angular_rate = math::sqrt(servicer.position_eci.cross(servicer.velocity_eci).squaredNorm()) /
                              servicer.position_eci.squaredNorm();
  const Vector3 position = rtn.head<3>();
  const Vector3 velocity = rtn.tail<3>() + Vector3(-angular_rate * position.y(), angular_rate * position.x(), 0.0);
  return {.position_eci = servicer.position_eci + R_eci_rtn * position,
          .velocity_eci = servicer.velocity_eci + R_eci_rtn * velocity};
}

Matrix6 roe_rtn_jacobian(const orbit::QnsElements& chief) {
  Matrix6 jacobian;
  for (int k = 0; k < 6; ++k) jacobian.col(k) = orbit::roe_from_rtn_linear(chief, Vector6::Unit(k));
  return jacobian;
}

}  // namespace

void PoseInitialiser::add(const PoseSample& sample) {
  std::size_t drop = size_ == kMaxSamples ? 1 : 0;
  while (drop < size_ && sample.time - samples_[drop].time > kOldest) ++drop;
  for (std::size_t k = drop; k < size_; ++k) samples_[k - drop] = samples_[k];
  size_ -= drop;
  orbit_from_ = orbit_from_ > drop ? orbit_from_ - drop : 0;
  samples_[size_++] = sample;
}

PoseInitialiser::Agreement PoseInitialiser::agreement_with(const filter::AttitudeState& attitude,
                                                           std::size_t from) const {
  Agreement agreement;
  for (std::size_t k = 0; k < size_; ++k) {
    const filter::AttitudeState then = filter::propagate_attitude(attitude, inertia_, {}, seconds_between(from, k));
    agreement.misses[k] = filter::rotation_vector_of(then.q_eci_body.conjugate() * samples_[k].q_eci_body);
    const double miss = agreement.misses[k].squaredNorm();
    agreement.is_in[k] = miss <= square(settings_.agreement);
    if (!agreement.is_in[k]) continue;
    ++agreement.count;
    agreement.squares += miss;
  }
  return agreement;
}

Result<AttitudeStart> PoseInitialiser::attitude() const {
  if (static_cast<int>(size_) < settings_.min_images) return Status::kNotReady;
  // Each pair of neighbours, and of next neighbours, defines a motion; the one with the largest consensus is chosen.
  Agreement best;
  filter::AttitudeState motion;
  std::size_t from = 0;
  for (std::size_t step = 1; step <= 2; ++step) {
    for (std::size_t k = 0; k + step < size_; ++k) {
      const double dt = seconds_between(k, k + step);
      if (!(dt > 0.0) || dt > kLongestPair_s) continue;
      filter::AttitudeState pair;
      pair.q_eci_body = samples_[k].q_eci_body;
      pair.rate_body =
          filter::rotation_vector_of(samples_[k].q_eci_body.conjugate() * samples_[k + step].q_eci_body) / dt;
      if (pair.rate_body.squaredNorm() > square(settings_.max_rate)) continue;
      const Agreement agreement = agreement_with(pair, k);
      if (agreement.count < best.count || (agreement.count == best.count && agreement.squares >= best.squares))
        continue;
      best = agreement;
      motion = pair;
      from = k;
    }
  }
  if (best.count < settings_.min_images || 2 * best.count <= static_cast<int>(size_)) return Status::kDidNotConverge;

  // Linear fit to the residuals of the consensus set, with equal weights: value and rate at the last sample.
  const std::size_t last = size_ - 1;
  AttitudeStart start;
  double own_variance = 0.0;
  for (int round = 0; round < 2; ++round) {
    double t1 = 0.0;
    double t2 = 0.0;
    double count = 0.0;
    Vector3 sum = Vector3::Zero();
    Vector3 sum_t = Vector3::Zero();
    own_variance = 0.0;
    for (std::size_t k = 0; k < size_; ++k) {
      if (!best.is_in[k]) continue;
      const double t = seconds_between(last, k);
      count += 1.0;
      t1 += t;
      t2 += t * t;
      sum += best.misses[k];
      sum_t += t * best.misses[k];
      own_variance += square(samples_[k].attitude_sigma);
    }
    const double determinant = count * t2 - t1 * t1;
    if (!(determinant > 0.0)) return Status::kDidNotConverge;
    const Vector3 offset = (t2 * sum - t1 * sum_t) / determinant;
    const Vector3 drift = (count * sum_t - t1 * sum) / determinant;
    filter::AttitudeState at_last = filter::propagate_attitude(motion, inertia_, {}, seconds_between(from, last));
    at_last.q_eci_body = (at_last.q_eci_body * filter::quaternion_of_rotation_vector(offset)).normalized();
    // A body rotated by `offset` has the same rate in other axes; the rate of the residual is added.
    at_last.rate_body += drift + at_last.rate_body.cross(offset);
    start.attitude = at_last;
    start.agreeing = best.count;
    const double variance = kAlike * (own_variance / count + square(settings_.attitude_sigma));
    start.covariance.setZero();
    for (int axis = 0; axis < 3; ++axis) {
      start.covariance(axis, axis) = variance * t2 / determinant;
      start.covariance(axis, 3 + axis) = -variance * t1 / determinant;
      start.covariance(3 + axis, axis) = -variance * t1 / determinant;
      start.covariance(3 + axis, 3 + axis) = variance * count / determinant;
    }
    motion = at_last;
    from = last;
    best = agreement_with(motion, from);
    if (best.count < settings_.min_images) return Status::kDidNotConverge;
  }
  return start;
}

Result<OrbitStart> PoseInitialiser::orbit() const {
  if (static_cast<int>(size_ - orbit_from_) < settings_.min_images) return Status::kNotReady;
  const std::size_t last = size_ - 1;
  const auto chief = orbit::qns_from_cartesian(samples_[last].servicer);
  if (!chief.ok()) return chief.status();
  const Matrix6 roe_jacobian = roe_rtn_jacobian(chief.value());
  const double n = orbit::mean_motion(chief.value().a);

  std::array<Eigen::Matrix<double, 3, 6>, kMaxSamples> rows;  // whitened
  std::array<Vector3, kMaxSamples> values;
  std::array<bool, kMaxSamples> is_in{};
  int used = 0;
  for (std::size_t k = orbit_from_; k < size_; ++k) {
    const auto then = orbit::qns_from_cartesian(samples_[k].servicer);
    if (!then.ok()) return then.status();
    Matrix6 drifted = roe_jacobian;
    drifted.row(1) -= 1.5 * n * seconds_between(last, k) * roe_jacobian.row(0);
    const Matrix3 R_rtn_eci = orbit::R_rtn_eci(samples_[k].servicer);
    const Vector3 position = R_rtn_eci * samples_[k].relative_eci;
    // Covariance of the pose, and a share of the distance along the line of sight.
    const Vector3 range_sigma = settings_.range_sigma_share * position;
    const Matrix3 covariance = R_rtn_eci * samples_[k].covariance_eci * R_rtn_eci.transpose() +
                               range_sigma * range_sigma.transpose() + 1e-4 * Matrix3::Identity();
    const math::Cholesky<3> factor(kAlike * covariance);
    if (!factor.ok()) continue;
    for (int c = 0; c < 6; ++c) {
      const Vector6 moved = orbit::rtn_from_roe_linear(then.value(), drifted.col(c));
      rows[k].col(c) = factor.solve_lower(moved.head<3>());
    }
    values[k] = factor.solve_lower(position);
    is_in[k] = true;
    ++used;
  }

  Matrix6 formation = Matrix6::Zero();
  for (int element = 0; element < 6; ++element) {
    const Vector6 jacobian = chief.value().a / settings_.sigma_a_roe_m(element) * roe_jacobian.row(element).transpose();
    formation += jacobian * jacobian.transpose();
  }

  OrbitStart start;
  for (int round = 0; round < kRounds; ++round) {
    if (used < settings_.min_images) return Status::kDidNotConverge;
    Matrix6 normal = Matrix6::Zero();
    Vector6 right = Vector6::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      normal(axis, axis) = 1.0 / square(kPriorPosition_m);
    }
    normal += formation;
    for (std::size_t k = orbit_from_; k < size_; ++k) {
      if (!is_in[k]) continue;
      normal += rows[k].transpose().lazyProduct(rows[k]);
      right += rows[k].transpose() * values[k];
    }
    const math::Cholesky6 factor(normal);
    if (!factor.ok()) return Status::kSingular;
    const Vector6 rtn = factor.solve(right);
    const auto roe = roe_of_target(samples_[last].servicer, target_at(samples_[last].servicer, rtn));
    if (!roe.ok()) return roe.status();
    start.roe = roe.value();
    start.covariance = roe_jacobian.lazyProduct(factor.inverse()).lazyProduct(roe_jacobian.transpose());
    start.used = used;
    // The worst outlier is removed.
    std::size_t worst = kMaxSamples;
    double maximum = settings_.position_gate / kAlike;
    for (std::size_t k = orbit_from_; k < size_; ++k) {
      if (!is_in[k]) continue;
      const double miss = (values[k] - rows[k] * rtn).squaredNorm();
      if (miss > maximum) {
        maximum = miss;
        worst = k;
      }
    }
    if (worst == kMaxSamples) return start;
    is_in[worst] = false;
    --used;
  }
  return Status::kDidNotConverge;
}

}  // namespace vbar::fsw::measurements
