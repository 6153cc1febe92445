#include "fsw/measurements/bearings/kept_orbit.h"

#include "fsw/math/math.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/sun.h"

namespace vbar::fsw::measurements {

using filter::kAt;

namespace {

constexpr Duration kSegment = duration_of_seconds(600);
constexpr int kMaxSegments = 80;  // beyond kLongest

// An acceleration that errs by sigma for this long errs as white noise of sigma^2 times it would.
constexpr double kAccelerationMemory_s = 6000.0;

constexpr double square(double x) {
  return x * x;
}

}  // namespace

void KeptOrbit::keep(const filter::RelativeNavigationFilter& filter) {
  if (is_kept()) return;
  const auto target = filter.target();
  if (!target.ok()) return;
  pair_ = Pair{filter.servicer(), target.value()};
  since_ = epoch_ = filter.epoch();
  covariance_ = filter.roe_covariance();
  const filter::Estimate& estimate = filter.estimate();
  constexpr int kDrag = kAt<filter::DifferentialAccelerations>;
  differential_ = {.drag = estimate.mean(kDrag), .from_sun = estimate.mean(kDrag + 1)};
  differential_variance_ = estimate.variance(kDrag) + estimate.variance(kDrag + 1);
}

void KeptOrbit::advance(const filter::RelativeNavigationFilter& filter) {
  if (!is_kept()) return;
  bool is_valid = filter.epoch() - since_ <= kLongest;
  for (const filter::Impulse& impulse : filter.impulses()) {
    if (!is_valid || impulse.time < epoch_) continue;
    is_valid = coast_to(impulse.time, filter) && apply(impulse, filter.settings());
  }
  if (!is_valid || !coast_to(filter.epoch(), filter)) forget();
}

/// False if it cannot be propagated until then.
bool KeptOrbit::coast_to(GpsTime time, const filter::RelativeNavigationFilter& filter) {
  for (int segment = 0; segment < kMaxSegments && epoch_ < time; ++segment) {
    const GpsTime next = time - epoch_ > kSegment ? epoch_ + kSegment : time;
    const double dt = seconds(next - epoch_);
    const auto osculating = orbit::qns_from_cartesian(pair_->servicer);
    if (!osculating.ok()) return false;
    const auto mean = orbit::mean_from_osculating(osculating.value());
    if (!mean.ok()) return false;
    const Matrix6 transition = orbit::roe_transition_j2(mean.value(), dt);
    Matrix6 covariance = transition.lazyProduct(covariance_).lazyProduct(transition.transpose());
    const double psd = filter.relative_orbit().noise().psd() + differential_variance_ * kAccelerationMemory_s;
    filter::add_velocity_noise(osculating.value(), psd, dt, covariance);
    covariance_ = covariance;
    const filter::Propagation propagation(epoch_, filter.settings().earth,
                                          orbit::sun_position_gcrf(epoch_).normalized());
    pair_->target = propagation.coast(pair_->target, dt, differential_);
    pair_->servicer = propagation.coast(pair_->servicer, dt);
    epoch_ = next;
  }
  return epoch_ == time && math::is_finite(covariance_.sum());
}

bool KeptOrbit::apply(const filter::Impulse& impulse, const filter::FilterSettings& settings) {
  const auto before = orbit::qns_from_cartesian(pair_->servicer);
  if (!before.ok()) return false;
  const double sigma = settings.burn_errors().of(impulse.dv_eci);
  const Matrix63 gamma = orbit::roe_control_matrix(before.value());
  covariance_ += (square(sigma) * gamma).lazyProduct(gamma.transpose());
  pair_->servicer.velocity_eci += impulse.dv_eci;
  return true;
}

Vector6 KeptOrbit::roe() const {
  if (!is_kept()) return Vector6::Zero();
  const auto roe = orbit::roe_of_target(pair_->servicer, pair_->target);
  return roe.ok() ? roe.value() : Vector6::Zero();
}

Result<orbit::CartesianState> KeptOrbit::target(const orbit::CartesianState& servicer) const {
  if (!is_kept()) return Status::kNotReady;
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok()) return chief.status();
  return orbit::target_from_roe(chief.value(), roe());
}

}  // namespace vbar::fsw::measurements
