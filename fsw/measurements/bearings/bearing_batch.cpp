#include "fsw/measurements/bearings/bearing_batch.h"

#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::measurements {
namespace {

constexpr int kMaxIterations = 15;
constexpr double kDifferenceStep = 1e-7;                 // of an element, for its Jacobian: 0.7 m
constexpr double kConverged = 1e-3;                      // of a sigma, every unknown
constexpr double kHuber = 3.0;                           // residuals beyond this number of sigma have a linear cost
constexpr double kOutlier = 5.0;                         // residuals beyond this do not count as used
constexpr Duration kSegment = duration_of_seconds(600);  // the Earth's orientation is updated after each

}  // namespace

void BearingBatch::add(const target_tracking::BearingMeasurement& bearing) {
  if (count_ == kCapacity) {
    for (std::size_t k = 0; k < kCapacity / 2; ++k) bearings_[k] = bearings_[k + kCapacity / 2];
    count_ = kCapacity / 2;
  }
  bearings_[count_++] = bearing;
}

void BearingBatch::add_burn(GpsTime time, const Vector3& dv_eci) {
  if (count_ == 0) return;
  if (burn_count_ == kMaxBurns) {
    clear();
    return;
  }
  burns_[burn_count_++] = {time, dv_eci};
}

/// All orbits are propagated backwards together, from the last bearing to the first.
Status BearingBatch::linearise(const orbit::CartesianState& servicer, const Unknowns& x,
                               const orbit::EarthOrientation& earth, const Vector3& sun_eci, double huber,
                               Linearised& result) {
  result = {};
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok()) return chief.status();
  std::array<orbit::CartesianState, kOrbits> orbits;
  orbits[0] = servicer;
  for (int k = 1; k < kOrbits; ++k) {
    Vector6 roe = x.head<6>();
    if (k >= 2) roe(k - 2) += kDifferenceStep;
    const auto target = target_from_roe(chief.value(), roe);
    if (!target.ok()) return target.status();
    orbits[static_cast<std::size_t>(k)] = target.value();
  }
  GpsTime now = last_time();
  std::size_t burns_left = burn_count_;
  const auto move_to = [&](GpsTime time) {
    for (int part = 0; part < 1000 && now > time; ++part) {
      const GpsTime next = now - time > kSegment ? now - kSegment : time;
      const filter::Propagation propagation(now, earth, sun_eci);
      for (orbit::CartesianState& orbit : orbits) orbit = propagation.coast(orbit, seconds(next - now));
      now = next;
    }
  };
  for (std::size_t k = count_; k-- > 0;) {
    const target_tracking::BearingMeasurement& bearing = bearings_[k];
    for (; burns_left > 0 && burns_[burns_left - 1].time >= bearing.time; --burns_left) {
      move_to(burns_[burns_left - 1].time);
      orbits[0].velocity_eci -= burns_[burns_left - 1].dv_eci;
    }
    move_to(bearing.time);
    const Matrix3 axes = target_tracking::bearing_axes(bearing.direction_eci, orbits[0]);
    const auto seen = [&](std::size_t orbit) {
      const Vector3 sight = orbits[orbit].position_eci - orbits[0].position_eci - bearing.origin_eci;
      return Vector2(axes.topRows<2>() * sight / math::sqrt(sight.squaredNorm()));
    };
    const Vector2 target = seen(1);
    Eigen::Matrix<double, 2, kUnknowns> jacobian;
    for (int j = 0; j < 6; ++j) jacobian.col(j) = (seen(static_cast<std::size_t>(2 + j)) - target) / kDifferenceStep;
    jacobian.rightCols<2>() = Matrix2::Identity();
    const Vector2 residual = -(target + x.tail<2>());
    const double distance = math::sqrt(residual.squaredNorm()) / bearing.sigma;
    const double weight = distance <= huber ? 1.0 : huber / distance;
    const double information = weight / (bearing.sigma * bearing.sigma);
    result.normal += information * jacobian.transpose().lazyProduct(jacobian);
    result.right += information * jacobian.transpose().lazyProduct(residual);
    result.cost += distance <= huber ? distance * distance : huber * (2.0 * distance - huber);
    result.chi_square += distance * distance;
    ++result.bearings;
    if (distance <= kOutlier) {
      ++result.used;
      result.chi_square_of_used += distance * distance;
    }
  }
  return math::is_finite(result.cost) ? Status::kOk : Status::kNotFinite;
}

Result<BearingBatch::NormalEquations> BearingBatch::normal_equations(const orbit::CartesianState& servicer,
                                                                     const Unknowns& x,
                                                                     const orbit::EarthOrientation& earth,
                                                                     const Vector3& sun_eci) {
  if (count_ == 0) return Status::kNotReady;
  constexpr double kNotRobust = 1e300;
  Linearised all;
  if (const Status status = linearise(servicer, x, earth, sun_eci, kNotRobust, all); status != Status::kOk)
    return status;
  return static_cast<const NormalEquations&>(all);
}

Result<BatchSolution> BearingBatch::solve(const orbit::CartesianState& servicer, const Vector6& prior_roe,
                                          const Matrix6& prior_covariance, const orbit::EarthOrientation& earth,
                                          const Vector3& sun_eci, const BearingBatchSettings& settings) {
  if (count_ < kMinBearings) return Status::kNotReady;
  Normal prior_covariance_all = settings.bias_sigma * settings.bias_sigma * Normal::Identity();
  prior_covariance_all.topLeftCorner<6, 6>() = prior_covariance;
  const math::Cholesky<kUnknowns> prior(prior_covariance_all);
  if (!prior.ok()) return Status::kSingular;
  const Normal prior_information = prior.inverse();
  Unknowns before;
  before << prior_roe, 0.0, 0.0;
  const auto cost_of = [&](const Linearised& at, const Unknowns& x) {
    return at.cost + (x - before).dot(prior_information.lazyProduct(x - before));
  };

  Unknowns x = before;
  Linearised now;
  if (const Status status = linearise(servicer, x, earth, sun_eci, kHuber, now); status != Status::kOk) return status;
  double damping = 0.0;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const Normal information = now.normal + prior_information;
    Normal damped = information;
    damped.diagonal() *= 1.0 + damping;
    const math::Cholesky<kUnknowns> factor(damped);
    if (!factor.ok()) return Status::kSingular;
    const Unknowns step = factor.solve(now.right - prior_information.lazyProduct(x - before));
    Linearised next;
    const Status status = linearise(servicer, x + step, earth, sun_eci, kHuber, next);
    if (status != Status::kOk || cost_of(next, x + step) > cost_of(now, x) * (1.0 + 1e-9) + 1e-9) {
      damping = damping == 0.0 ? 1e-3 : 10.0 * damping;
      continue;
    }
    const double moved = step.dot(information.lazyProduct(step));  // squared, in sigmas
    x += step;
    now = next;
    damping *= 0.1;
    if (moved > kConverged * kConverged) continue;
    const math::Cholesky<kUnknowns> found(now.normal + prior_information);
    if (!found.ok()) return Status::kSingular;
    const BatchSolution solution{.roe = x.head<6>(),
                                 .bias = x.tail<2>(),
                                 .covariance = found.inverse(),
                                 .used = now.used,
                                 .chi_square = now.used > 0 ? now.chi_square_of_used / (2.0 * now.used) : 0.0};
    const bool fits = now.used >= settings.min_share_used * static_cast<double>(count_) &&
                      solution.chi_square <= settings.max_chi_square;
    if (!fits) return Status::kOutOfRange;
    return solution;
  }
  return Status::kDidNotConverge;
}

}  // namespace vbar::fsw::measurements
