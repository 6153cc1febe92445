#include "fsw/navigation/angles_only_navigation.h"

#include <array>

#include <Eigen/Geometry>

#include "fsw/math/math.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::navigation {
namespace {

constexpr Duration kSegment = duration_of_seconds(600);  // coasts go by these: the Earth's orientation is renewed
constexpr int kMaxSegments = 1000;
constexpr Duration kFarthestAhead = duration_of_seconds(7200);

// So many bearings refused in a row put the estimate in doubt, the second time more than the first; the third time it
// is no more than what was known beforehand, and a batch begins. The bearings that were believed before the first
// refusal have by then spoilt the range, so that is doubted with the rest.
constexpr int kRefusedBeforeDoubt = 5;
constexpr std::array<double, 3> kDoubtedVelocity = {0.1, 1.0, 1.0};     // m/s
constexpr std::array<double, 3> kDoubtedLongitude = {0.02, 0.05, 0.1};  // of itself

/// Change of the target's ROE by a change of the servicer's inertial state (m, m/s), to O(e).
Matrix6 roe_slope(const orbit::CartesianState& servicer, const orbit::QnsElements& elements) {
  const Matrix3 R_rtn_eci = orbit::R_rtn_eci(servicer);
  const double radius2 = servicer.position_eci.squaredNorm();
  const Vector3 turning(0.0, 0.0, servicer.position_eci.cross(servicer.velocity_eci).norm() / radius2);
  Matrix6 slope;
  for (int k = 0; k < 6; ++k) {
    const Vector3 axis = R_rtn_eci.col(k % 3);
    Vector6 rtn = Vector6::Zero();
    if (k < 3) {
      rtn << -axis, turning.cross(axis);
    } else {
      rtn.tail<3>() = -axis;
    }
    slope.col(k) = orbit::roe_from_rtn_linear(elements, rtn);
  }
  return slope;
}

}  // namespace

void AnglesOnlyNavigation::configure(const AnglesOnlySettings& settings) {
  settings_ = settings;
  flight_.own_orbit = OwnOrbit(settings.own_orbit);
  flight_.filter.configure(settings.filter);
  batch_.clear();
  filter_runs_ = false;
  refused_in_a_row_ = 0;
  doubts_in_a_row_ = 0;
}

void AnglesOnlyNavigation::set_apriori(const TargetApriori& apriori) {
  apriori_ = apriori;
  apriori_target_ = apriori.target;
  apriori_reached_ = apriori.time;
  rests_on_apriori_ = false;
  flight_.filter.reset();
  batch_.clear();
  filter_runs_ = false;
}

BearingFate AnglesOnlyNavigation::update(const AnglesOnlyEpoch& epoch, std::span<const Burn> burns) {
  last_update_ = {};
  if (flight_.own_orbit.started()) {
    if (epoch.time < flight_.epoch) return BearingFate::kNone;
    advance(flight_, epoch.time, epoch.sun_eci, burns, filter_runs_ ? nullptr : &batch_);
    if (epoch.servicer_gnss.has_value()) flight_.own_orbit.take(*epoch.servicer_gnss);
  } else if (epoch.servicer_gnss.has_value()) {
    flight_.own_orbit.begin(*epoch.servicer_gnss);
    flight_.epoch = epoch.time;
  }
  if (!flight_.own_orbit.started()) return BearingFate::kNone;
  if (!flight_.filter.started()) begin(epoch);
  if (rests_on_apriori_) rest_on_apriori(epoch);
  if (!flight_.filter.started() || !epoch.bearing.has_value()) return BearingFate::kNone;
  return take_bearing(epoch, *epoch.bearing);
}

/// From what was known beforehand.
void AnglesOnlyNavigation::begin(const AnglesOnlyEpoch& epoch) {
  if (filter_runs_) ++counters_.restarts;
  filter_runs_ = false;
  batch_.clear();
  rests_on_apriori_ = apriori_.has_value() && apriori_->time <= epoch.time;
}

/// What was known beforehand is where the target is, not where it is from the servicer, and the servicer's orbit is
/// still being learned: a decimetre a second of it makes 200 m of a * da. So until a batch is worked out the elements
/// are formed anew at each epoch, and the servicer's uncertainty is theirs too.
void AnglesOnlyNavigation::rest_on_apriori(const AnglesOnlyEpoch& epoch) {
  for (int segment = 0; segment < kMaxSegments && apriori_reached_ < epoch.time; ++segment) {
    const Duration left = epoch.time - apriori_reached_;
    const GpsTime next = left > kSegment ? apriori_reached_ + kSegment : epoch.time;
    const Propagation propagation(apriori_reached_, settings_.earth, epoch.sun_eci);
    apriori_target_ = propagation.coast(apriori_target_, seconds(next - apriori_reached_));
    apriori_reached_ = next;
  }
  const orbit::CartesianState own = flight_.own_orbit.state();
  const auto roe = roe_of_target(own, apriori_target_);
  const auto servicer = orbit::qns_from_cartesian(own);
  if (apriori_reached_ < epoch.time || !roe.ok() || !servicer.ok()) return;
  const double a = servicer.value().a;
  Matrix6 drift = Matrix6::Identity();
  drift(1, 0) = -1.5 * orbit::mean_motion(a) * seconds(epoch.time - apriori_->time);
  Matrix6 covariance = Matrix6::Zero();
  covariance.diagonal() = (apriori_->sigma_a_roe_m / a).cwiseAbs2();
  const Matrix6 known = drift.lazyProduct(covariance).lazyProduct(drift.transpose());
  const Matrix6 slope = roe_slope(own, servicer.value());
  flight_.filter.begin(roe.value(),
                       known + slope.lazyProduct(flight_.own_orbit.covariance()).lazyProduct(slope.transpose()));
}

void AnglesOnlyNavigation::advance(Flight& flight, GpsTime time, const Vector3& sun_eci, std::span<const Burn> burns,
                                   BearingBatch* batch) const {
  const auto coast_to = [&](GpsTime goal) {
    for (int segment = 0; segment < kMaxSegments && flight.epoch < goal; ++segment) {
      const GpsTime next = goal - flight.epoch > kSegment ? flight.epoch + kSegment : goal;
      const Propagation propagation(flight.epoch, settings_.earth, sun_eci);
      const double dt = seconds(next - flight.epoch);
      flight.filter.advance(propagation, flight.own_orbit.state(), dt);
      flight.own_orbit.advance(propagation, dt);
      flight.epoch = next;
    }
  };
  for (const Burn& burn : burns) {
    if (burn.time < flight.epoch) continue;
    if (burn.time >= time) break;
    coast_to(burn.time);
    const orbit::CartesianState servicer = flight.own_orbit.state();
    const Vector3 dv_eci = orbit::R_rtn_eci(servicer).transpose() * burn.dv_rtn;
    const double sigma =
        settings_.filter.maneuver_sigma + settings_.filter.maneuver_sigma_relative * math::sqrt(dv_eci.squaredNorm());
    flight.filter.add_servicer_impulse(servicer, dv_eci);
    flight.own_orbit.add_impulse(dv_eci, sigma);
    if (batch != nullptr) batch->add_burn(burn.time, dv_eci);
  }
  coast_to(time);
}

BearingFate AnglesOnlyNavigation::take_bearing(const AnglesOnlyEpoch& epoch, const BearingMeasurement& bearing) {
  if (!filter_runs_) {
    batch_.add(bearing);
    if (static_cast<int>(batch_.size()) >= settings_.batch.bearings) solve_batch(epoch.sun_eci);
    return BearingFate::kBatch;
  }
  last_update_ = flight_.filter.take(bearing, flight_.own_orbit.state(), epoch.sun_eci);
  if (!last_update_.accepted) {
    count_refusal();
    return BearingFate::kRefused;
  }
  ++counters_.bearings_used;
  refused_in_a_row_ = 0;
  doubts_in_a_row_ = 0;
  last_bearing_ = bearing.time;
  return BearingFate::kFilter;
}

/// A batch that does not come out is tried again with every further bearing.
void AnglesOnlyNavigation::solve_batch(const Vector3& sun_eci) {
  const auto solution = batch_.solve(flight_.own_orbit.state(), flight_.filter.roe(), flight_.filter.roe_covariance(),
                                     settings_.earth, sun_eci, settings_.batch);
  if (!solution.ok()) {
    ++counters_.batches_failed;
    return;
  }
  flight_.filter.begin(solution.value().roe, solution.value().bias, solution.value().covariance);
  if (!flight_.filter.started()) return;
  filter_runs_ = true;
  rests_on_apriori_ = false;
  counters_.bearings_used += solution.value().used;
  last_bearing_ = batch_.last_time();
  batch_.clear();
}

void AnglesOnlyNavigation::count_refusal() {
  ++counters_.bearings_refused;
  if (++refused_in_a_row_ < kRefusedBeforeDoubt) return;
  refused_in_a_row_ = 0;
  flight_.filter.doubt(flight_.own_orbit.state(), kDoubtedVelocity[doubts_in_a_row_],
                       kDoubtedLongitude[doubts_in_a_row_]);
  // If it was a burn, the servicer's orbit does not know of it either.
  flight_.own_orbit.add_impulse(Vector3::Zero(), kDoubtedVelocity[doubts_in_a_row_]);
  ++counters_.doubts;
  if (++doubts_in_a_row_ < kDoubtedVelocity.size()) return;
  doubts_in_a_row_ = 0;
  ++counters_.restarts;
  filter_runs_ = false;
  batch_.clear();
}

Vector6 AnglesOnlyNavigation::a_roe_m() const {
  const auto servicer = orbit::qns_from_cartesian(flight_.own_orbit.state());
  return servicer.ok() ? Vector6(servicer.value().a * flight_.filter.roe()) : Vector6(Vector6::Zero());
}

Matrix6 AnglesOnlyNavigation::a_roe_covariance_m2() const {
  const auto servicer = orbit::qns_from_cartesian(flight_.own_orbit.state());
  return servicer.ok() ? Matrix6(servicer.value().a * servicer.value().a * flight_.filter.roe_covariance())
                       : Matrix6(Matrix6::Zero());
}

/// By the slope of the exact map, by differences.
Matrix6 AnglesOnlyNavigation::covariance_rtn() const {
  constexpr double kLittle = 1e-6;
  const orbit::CartesianState servicer = flight_.own_orbit.state();
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok() || !flight_.filter.started()) return Matrix6::Zero();
  Matrix6 slope;
  for (int k = 0; k < 6; ++k) {
    const auto plus = target_from_roe(chief.value(), flight_.filter.roe() + kLittle * Vector6::Unit(k));
    const auto minus = target_from_roe(chief.value(), flight_.filter.roe() - kLittle * Vector6::Unit(k));
    if (!plus.ok() || !minus.ok()) return Matrix6::Zero();
    const auto a = orbit::relative_state_rtn(servicer, plus.value());
    const auto b = orbit::relative_state_rtn(servicer, minus.value());
    slope.col(k) << (a.position_rtn - b.position_rtn) / (2.0 * kLittle),
        (a.velocity_rtn - b.velocity_rtn) / (2.0 * kLittle);
  }
  return slope.lazyProduct(flight_.filter.roe_covariance()).lazyProduct(slope.transpose());
}

Result<BearingPrediction> AnglesOnlyNavigation::predict(GpsTime time, const Vector3& origin_eci, const Vector3& sun_eci,
                                                        std::span<const Burn> burns) const {
  if (!has_target()) return Status::kNotReady;
  if (time < flight_.epoch || time - flight_.epoch > kFarthestAhead) return Status::kOutOfRange;
  Flight ahead = flight_;
  advance(ahead, time, sun_eci, burns, nullptr);
  return ahead.filter.predict(ahead.own_orbit.state(), origin_eci, sun_eci);
}

}  // namespace vbar::fsw::navigation
