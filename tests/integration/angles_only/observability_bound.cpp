#include "tests/integration/angles_only/observability_bound.h"

#include <array>
#include <stdexcept>

#include <Eigen/LU>

#include "fsw/orbit/roe.h"

namespace vbar::test {
namespace {

namespace nav = fsw::navigation;
namespace orbit = fsw::orbit;
using Information = Eigen::Matrix<double, 8, 8>;

constexpr double kDifferenceStep_m = 10.0;

/// Target orbits beside the true one: element k a little more and less.
std::array<orbit::CartesianState, 12> neighbours(const TrueEpoch& start, double& a) {
  const orbit::QnsElements servicer = orbit::qns_from_cartesian(start.servicer).value();
  const orbit::QnsElements target = orbit::qns_from_cartesian(start.target).value();
  const fsw::Vector6 roe = orbit::roe_from_qns(servicer, target);
  a = servicer.a;
  std::array<orbit::CartesianState, 12> result;
  for (int k = 0; k < 12; ++k) {
    fsw::Vector6 shifted = roe;
    shifted(k / 2) += (k % 2 == 0 ? kDifferenceStep_m : -kDifferenceStep_m) / a;
    result[static_cast<std::size_t>(k)] = orbit::cartesian_from_qns(orbit::qns_from_roe(servicer, shifted)).value();
  }
  return result;
}

}  // namespace

std::vector<double> position_bound(const TrueFlight& flight, const std::vector<std::size_t>& epochs,
                                   const BoundSettings& settings) {
  double a = 0.0;
  std::array<orbit::CartesianState, 12> orbits = neighbours(flight.epochs.front(), a);
  Information information = Information::Zero();
  for (int k = 0; k < 6; ++k) {
    information(k, k) = 1.0 / (settings.prior_sigma_a_roe_m(k) * settings.prior_sigma_a_roe_m(k));
  }
  // A bias that is not there is known all too well.
  const double bias_sigma = settings.bias_sigma > 0.0 ? settings.bias_sigma : 1e-12;
  for (int k = 6; k < 8; ++k) information(k, k) = 1.0 / (bias_sigma * bias_sigma);

  std::vector<double> bounds;
  for (std::size_t k = 0; k < flight.epochs.size() && bounds.size() < epochs.size(); ++k) {
    const TrueEpoch& epoch = flight.epochs[k];
    if (k > 0) {
      const TrueEpoch& last = flight.epochs[k - 1];
      const nav::Propagation propagation(last.time, flight.earth, last.sun_eci);
      for (orbit::CartesianState& o : orbits) o = propagation.coast(o, fsw::seconds(epoch.time - last.time));
    }
    Eigen::Matrix<double, 3, 6> moves;  // of the target's position, m, per metre of a * ROE at the start
    for (int j = 0; j < 6; ++j) {
      const auto plus = static_cast<std::size_t>(2 * j);
      moves.col(j) = (orbits[plus].position_eci - orbits[plus + 1].position_eci) / (2.0 * kDifferenceStep_m);
    }
    const fsw::Vector3 sight = epoch.target.position_eci - epoch.servicer.position_eci;
    const double range = sight.norm();
    if (epoch.is_target_lit) {
      Eigen::Matrix<double, 2, 8> slope;
      slope.leftCols<6>() = nav::bearing_axes(sight / range, epoch.servicer).topRows<2>() * moves / range;
      slope.rightCols<2>().setIdentity();
      const double resolved = settings.resolved_share * kTargetRadius_m / range;
      const double variance = settings.bearing_sigma * settings.bearing_sigma + resolved * resolved;
      information += slope.transpose() * slope / variance;
    }
    if (k != epochs[bounds.size()]) continue;
    // Metres and radians: scaled to a unit diagonal before the inverse.
    const Eigen::Matrix<double, 8, 1> scale = information.diagonal().cwiseSqrt().cwiseInverse();
    const Information covariance = scale.asDiagonal() *
                                   Information(scale.asDiagonal() * information * scale.asDiagonal()).inverse() *
                                   scale.asDiagonal();
    bounds.push_back(std::sqrt((moves * covariance.topLeftCorner<6, 6>() * moves.transpose()).trace()));
  }
  if (bounds.size() != epochs.size()) throw std::invalid_argument("an epoch beyond the flight");
  return bounds;
}

}  // namespace vbar::test
