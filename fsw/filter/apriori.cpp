#include "fsw/filter/apriori.h"

#include <Eigen/Geometry>

#include "fsw/filter/propagation.h"
#include "fsw/filter/relative_orbit.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "fsw/orbit/sun.h"

namespace vbar::fsw::filter {
namespace {

constexpr Duration kSegment = duration_of_seconds(600);  // propagation interval of one Earth orientation
constexpr int kMaxSegments = 1000;
constexpr Duration kOldestRoe = duration_of_seconds(600);

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

/// Covariance (dimensionless) of the a-priori elements after a drift of the mean longitude.
Matrix6 drifted(const Vector6& sigma_a_roe_m, double a, double dt, Matrix6& drift) {
  drift = Matrix6::Identity();
  drift(1, 0) = -1.5 * orbit::mean_motion(a) * dt;
  Matrix6 covariance = Matrix6::Zero();
  covariance.diagonal() = (sigma_a_roe_m / a).cwiseAbs2();
  return drift.lazyProduct(covariance).lazyProduct(drift.transpose());
}

}  // namespace

Result<AprioriRoe> Apriori::at(GpsTime time, const AbsoluteOrbitFilter& absolute_orbit,
                               const orbit::EarthOrientation& earth) {
  if (time < known_.time || !absolute_orbit.started()) return Status::kNotReady;
  return known_.kind == TargetApriori::Kind::kAbsoluteOrbit ? of_absolute_orbit(time, absolute_orbit, earth)
                                                            : of_mean_roe(time, absolute_orbit);
}

Result<AprioriRoe> Apriori::of_absolute_orbit(GpsTime time, const AbsoluteOrbitFilter& absolute_orbit,
                                              const orbit::EarthOrientation& earth) {
  for (int segment = 0; segment < kMaxSegments && reached_ < time; ++segment) {
    const GpsTime next = time - reached_ > kSegment ? reached_ + kSegment : time;
    const filter::Propagation propagation(reached_, earth, orbit::sun_position_gcrf(reached_).normalized());
    target_ = propagation.coast(target_, seconds(next - reached_));
    reached_ = next;
  }
  if (reached_ < time) return Status::kOutOfRange;
  const orbit::CartesianState own = absolute_orbit.state();
  const auto roe = roe_of_target(own, target_);
  const auto servicer = orbit::qns_from_cartesian(own);
  if (!roe.ok()) return roe.status();
  if (!servicer.ok()) return servicer.status();
  Matrix6 drift;
  AprioriRoe result;
  result.roe = roe.value();
  const Matrix6 jacobian = roe_jacobian(own, servicer.value());
  result.covariance = drifted(known_.sigma_a_roe_m, servicer.value().a, seconds(time - known_.time), drift) +
                      jacobian.lazyProduct(absolute_orbit.covariance()).lazyProduct(jacobian.transpose());
  return result;
}

Result<AprioriRoe> Apriori::of_mean_roe(GpsTime time, const AbsoluteOrbitFilter& absolute_orbit) const {
  if (time - known_.time > kOldestRoe) return Status::kNotReady;
  const auto chief = orbit::qns_from_cartesian(absolute_orbit.state());
  if (!chief.ok()) return chief.status();
  const auto chief_mean = orbit::mean_from_osculating(chief.value());
  if (!chief_mean.ok()) return chief_mean.status();
  const double a = chief_mean.value().a;
  Matrix6 drift;
  AprioriRoe result;
  result.covariance = drifted(known_.sigma_a_roe_m, a, seconds(time - known_.time), drift);
  const Vector6 mean_roe = drift * known_.mean_a_roe_m / a;
  const auto target = orbit::osculating_from_mean(orbit::qns_from_roe(chief_mean.value(), mean_roe));
  if (!target.ok()) return target.status();
  result.roe = orbit::roe_from_qns(chief.value(), target.value());
  return result;
}

}  // namespace vbar::fsw::filter
