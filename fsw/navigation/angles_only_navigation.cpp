#include "fsw/navigation/angles_only_navigation.h"

#include <array>

#include <Eigen/Geometry>

#include "fsw/math/math.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::navigation {
namespace {

constexpr Duration kSegment = duration_of_seconds(600);  // propagation interval of one Earth orientation
constexpr int kMaxSegments = 1000;
constexpr Duration kFarthestAhead = duration_of_seconds(7200);

// This number of consecutive refused bearings inflates the covariance, the second time more than the first; the third
// time the filter returns to the a-priori orbit and a batch begins. The bearings accepted before the first refusal have
// by then corrupted the range, so that its uncertainty is inflated as well.
constexpr int kRefusedBeforeInflation = 5;
constexpr std::array<double, 3> kInflatedVelocity = {0.1, 1.0, 1.0};     // m/s
constexpr std::array<double, 3> kInflatedLongitude = {0.02, 0.05, 0.1};  // relative

/// Jacobian of the target's ROE with respect to the servicer's inertial state (m, m/s), to O(e).
Matrix6 roe_jacobian(const orbit::CartesianState& servicer, const orbit::QnsElements& elements) {
  const Matrix3 R_rtn_eci = orbit::R_rtn_eci(servicer);
  const double radius2 = servicer.position_eci.squaredNorm();
  const Vector3 angular_rate(0.0, 0.0, servicer.position_eci.cross(servicer.velocity_eci).norm() / radius2);
  Matrix6 jacobian;
  for (int k = 0; k < 6; ++k) {
    const Vector3 axis = R_rtn_eci.col(k % 3);
    Vector6 rtn = Vector6::Zero();
    if (k < 3) {
      rtn << -axis, angular_rate.cross(axis);
    } else {
      rtn.tail<3>() = -axis;
    }
    jacobian.col(k) = orbit::roe_from_rtn_linear(elements, rtn);
  }
  return jacobian;
}

}  // namespace

void AnglesOnlyNavigation::configure(const AnglesOnlySettings& settings) {
  settings_ = settings;
  orbits_.own_orbit = OwnOrbit(settings.own_orbit);
  orbits_.filter.configure(settings.filter);
  batch_.clear();
  filter_runs_ = false;
  refused_in_a_row_ = 0;
  inflations_in_a_row_ = 0;
}

void AnglesOnlyNavigation::set_apriori(const TargetApriori& apriori) {
  apriori_ = apriori;
  apriori_target_ = apriori.target;
  apriori_reached_ = apriori.time;
  is_apriori_only_ = false;
  orbits_.filter.reset();
  batch_.clear();
  filter_runs_ = false;
}

BearingEditStatus AnglesOnlyNavigation::update(const AnglesOnlyEpoch& epoch, std::span<const Burn> burns) {
  last_update_ = {};
  if (orbits_.own_orbit.started()) {
    if (epoch.time < orbits_.epoch) return BearingEditStatus::kNone;
    advance(orbits_, epoch.time, epoch.sun_eci, burns, filter_runs_ ? nullptr : &batch_);
    if (epoch.servicer_gnss.has_value()) orbits_.own_orbit.take(*epoch.servicer_gnss);
  } else if (epoch.servicer_gnss.has_value()) {
    orbits_.own_orbit.begin(*epoch.servicer_gnss);
    orbits_.epoch = epoch.time;
  }
  if (!orbits_.own_orbit.started()) return BearingEditStatus::kNone;
  if (!orbits_.filter.started()) begin(epoch);
  if (is_apriori_only_) reset_to_apriori(epoch);
  if (!orbits_.filter.started() || !epoch.bearing.has_value()) return BearingEditStatus::kNone;
  return take_bearing(epoch, *epoch.bearing);
}

/// From the a-priori orbit.
void AnglesOnlyNavigation::begin(const AnglesOnlyEpoch& epoch) {
  if (filter_runs_) ++counters_.restarts;
  filter_runs_ = false;
  batch_.clear();
  is_apriori_only_ = apriori_.has_value() && apriori_->time <= epoch.time;
}

/// The a-priori orbit is an absolute orbit of the target, not a relative one, and the servicer's orbit is not yet
/// accurate: an error of 0.1 m/s causes 200 m of a * da. Until a batch has been solved, the elements are therefore
/// recomputed at each epoch, and their covariance includes that of the servicer.
void AnglesOnlyNavigation::reset_to_apriori(const AnglesOnlyEpoch& epoch) {
  for (int segment = 0; segment < kMaxSegments && apriori_reached_ < epoch.time; ++segment) {
    const Duration left = epoch.time - apriori_reached_;
    const GpsTime next = left > kSegment ? apriori_reached_ + kSegment : epoch.time;
    const Propagation propagation(apriori_reached_, settings_.earth, epoch.sun_eci);
    apriori_target_ = propagation.coast(apriori_target_, seconds(next - apriori_reached_));
    apriori_reached_ = next;
  }
  const orbit::CartesianState own = orbits_.own_orbit.state();
  const auto roe = roe_of_target(own, apriori_target_);
  const auto servicer = orbit::qns_from_cartesian(own);
  if (apriori_reached_ < epoch.time || !roe.ok() || !servicer.ok()) return;
  const double a = servicer.value().a;
  Matrix6 drift = Matrix6::Identity();
  drift(1, 0) = -1.5 * orbit::mean_motion(a) * seconds(epoch.time - apriori_->time);
  Matrix6 covariance = Matrix6::Zero();
  covariance.diagonal() = (apriori_->sigma_a_roe_m / a).cwiseAbs2();
  const Matrix6 known = drift.lazyProduct(covariance).lazyProduct(drift.transpose());
  const Matrix6 jacobian = roe_jacobian(own, servicer.value());
  orbits_.filter.begin(roe.value(),
                       known + jacobian.lazyProduct(orbits_.own_orbit.covariance()).lazyProduct(jacobian.transpose()));
}

void AnglesOnlyNavigation::advance(OrbitPair& orbits, GpsTime time, const Vector3& sun_eci, std::span<const Burn> burns,
                                   BearingBatch* batch) const {
  const auto coast_to = [&](GpsTime goal) {
    for (int segment = 0; segment < kMaxSegments && orbits.epoch < goal; ++segment) {
      const GpsTime next = goal - orbits.epoch > kSegment ? orbits.epoch + kSegment : goal;
      const Propagation propagation(orbits.epoch, settings_.earth, sun_eci);
      const double dt = seconds(next - orbits.epoch);
      orbits.filter.advance(propagation, orbits.own_orbit.state(), dt);
      orbits.own_orbit.advance(propagation, dt);
      orbits.epoch = next;
    }
  };
  for (const Burn& burn : burns) {
    if (burn.time < orbits.epoch) continue;
    if (burn.time >= time) break;
    coast_to(burn.time);
    const orbit::CartesianState servicer = orbits.own_orbit.state();
    const Vector3 dv_eci = orbit::R_rtn_eci(servicer).transpose() * burn.dv_rtn;
    const double sigma =
        settings_.filter.maneuver_sigma + settings_.filter.maneuver_sigma_relative * math::sqrt(dv_eci.squaredNorm());
    orbits.filter.add_servicer_impulse(servicer, dv_eci);
    orbits.own_orbit.add_impulse(dv_eci, sigma);
    if (batch != nullptr) batch->add_burn(burn.time, dv_eci);
  }
  coast_to(time);
}

BearingEditStatus AnglesOnlyNavigation::take_bearing(const AnglesOnlyEpoch& epoch, const BearingMeasurement& bearing) {
  if (!filter_runs_) {
    batch_.add(bearing);
    if (static_cast<int>(batch_.size()) >= settings_.batch.bearings) solve_batch(epoch.sun_eci);
    return BearingEditStatus::kBatch;
  }
  last_update_ = orbits_.filter.take(bearing, orbits_.own_orbit.state(), epoch.sun_eci);
  if (!last_update_.accepted) {
    count_refusal();
    return BearingEditStatus::kRefused;
  }
  ++counters_.bearings_used;
  refused_in_a_row_ = 0;
  inflations_in_a_row_ = 0;
  last_bearing_ = bearing.time;
  return BearingEditStatus::kFilter;
}

/// A batch that does not converge is solved again with every further bearing.
void AnglesOnlyNavigation::solve_batch(const Vector3& sun_eci) {
  const auto solution = batch_.solve(orbits_.own_orbit.state(), orbits_.filter.roe(), orbits_.filter.roe_covariance(),
                                     settings_.earth, sun_eci, settings_.batch);
  if (!solution.ok()) {
    ++counters_.batches_failed;
    return;
  }
  orbits_.filter.begin(solution.value().roe, solution.value().bias, solution.value().covariance);
  if (!orbits_.filter.started()) return;
  filter_runs_ = true;
  is_apriori_only_ = false;
  counters_.bearings_used += solution.value().used;
  last_bearing_ = batch_.last_time();
  batch_.clear();
}

void AnglesOnlyNavigation::count_refusal() {
  ++counters_.bearings_refused;
  if (++refused_in_a_row_ < kRefusedBeforeInflation) return;
  refused_in_a_row_ = 0;
  orbits_.filter.inflate_covariance(orbits_.own_orbit.state(), kInflatedVelocity[inflations_in_a_row_],
                                    kInflatedLongitude[inflations_in_a_row_]);
  // An unknown burn would affect the servicer's orbit as well.
  orbits_.own_orbit.add_impulse(Vector3::Zero(), kInflatedVelocity[inflations_in_a_row_]);
  ++counters_.inflations;
  if (++inflations_in_a_row_ < kInflatedVelocity.size()) return;
  inflations_in_a_row_ = 0;
  ++counters_.restarts;
  filter_runs_ = false;
  batch_.clear();
}

Vector6 AnglesOnlyNavigation::a_roe_m() const {
  const auto servicer = orbit::qns_from_cartesian(orbits_.own_orbit.state());
  return servicer.ok() ? Vector6(servicer.value().a * orbits_.filter.roe()) : Vector6(Vector6::Zero());
}

Matrix6 AnglesOnlyNavigation::a_roe_covariance_m2() const {
  const auto servicer = orbit::qns_from_cartesian(orbits_.own_orbit.state());
  return servicer.ok() ? Matrix6(servicer.value().a * servicer.value().a * orbits_.filter.roe_covariance())
                       : Matrix6(Matrix6::Zero());
}

/// By the Jacobian of the exact map, from finite differences.
Matrix6 AnglesOnlyNavigation::covariance_rtn() const {
  constexpr double kDifferenceStep = 1e-6;
  const orbit::CartesianState servicer = orbits_.own_orbit.state();
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok() || !orbits_.filter.started()) return Matrix6::Zero();
  Matrix6 jacobian;
  for (int k = 0; k < 6; ++k) {
    const auto plus = target_from_roe(chief.value(), orbits_.filter.roe() + kDifferenceStep * Vector6::Unit(k));
    const auto minus = target_from_roe(chief.value(), orbits_.filter.roe() - kDifferenceStep * Vector6::Unit(k));
    if (!plus.ok() || !minus.ok()) return Matrix6::Zero();
    const auto a = orbit::relative_state_rtn(servicer, plus.value());
    const auto b = orbit::relative_state_rtn(servicer, minus.value());
    jacobian.col(k) << (a.position_rtn - b.position_rtn) / (2.0 * kDifferenceStep),
        (a.velocity_rtn - b.velocity_rtn) / (2.0 * kDifferenceStep);
  }
  return jacobian.lazyProduct(orbits_.filter.roe_covariance()).lazyProduct(jacobian.transpose());
}

Result<BearingPrediction> AnglesOnlyNavigation::predict(GpsTime time, const Vector3& origin_eci, const Vector3& sun_eci,
                                                        std::span<const Burn> burns) const {
  if (!has_target()) return Status::kNotReady;
  if (time < orbits_.epoch || time - orbits_.epoch > kFarthestAhead) return Status::kOutOfRange;
  OrbitPair ahead = orbits_;
  advance(ahead, time, sun_eci, burns, nullptr);
  return ahead.filter.predict(ahead.own_orbit.state(), origin_eci, sun_eci);
}

}  // namespace vbar::fsw::navigation
