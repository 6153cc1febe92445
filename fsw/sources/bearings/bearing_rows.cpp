#include "fsw/sources/bearings/bearing_rows.h"

#include <array>

#include "fsw/estimation/unscented.h"
#include "fsw/math/math.h"

namespace vbar::fsw::sources {
namespace {

using filter::kAt;

constexpr double square(double x) {
  return x * x;
}

}  // namespace

Status bearing_rows(const filter::RelativeNavigationFilter& filter, const navigation::BearingMeasurement& bearing,
                    const Vector3& sun_eci, const BearingModel& model, filter::MeasurementBatch& batch) {
  using Transform = estimation::UnscentedTransform<filter::Roe::kSize>;
  const orbit::CartesianState servicer = filter.servicer();
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok()) return chief.status();
  Transform transform;
  if (const Status status = transform.start(filter.roe(), filter.roe_covariance()); status != Status::kOk)
    return status;
  const filter::Estimate& estimate = filter.estimate();
  const Matrix3 axes = navigation::bearing_axes(bearing.direction_eci, servicer);
  const Vector3 camera = servicer.position_eci + bearing.origin_eci;
  batch.clear(2);
  std::array<Vector2, Transform::kPoints> values;
  double centroid_noise = 0.0;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    const auto target = orbit::target_from_roe(chief.value(), transform.point(k));
    if (!target.ok()) return target.status();
    const Vector3 sight = navigation::centre_of_brightness(target.value().position_eci, camera, sun_eci,
                                                           estimate.mean(kAt<BrightnessOffset>)) -
                          camera;
    const double range = math::sqrt(sight.squaredNorm());
    values[k] = axes.topRows<2>() * sight / range;
    if (k > 0) continue;
    centroid_noise = model.centroid_noise_m / range;
    const Vector2 along_sun = axes.topRows<2>() * (sun_eci - sight.dot(sun_eci) / square(range) * sight) / range;
    for (int axis = 0; axis < 2; ++axis) {
      batch.sensitivity(kAt<BrightnessOffset>, axis) = along_sun(axis);
      batch.sensitivity(kAt<CentroidWander> + axis, axis) = 1.0 / range;
      batch.sensitivity(kAt<BearingBias> + axis, axis) = 1.0;
    }
  }
  const auto regression = transform.regress<2>(values);
  const double variance = square(bearing.sigma) + square(centroid_noise);
  for (int axis = 0; axis < 2; ++axis) {
    batch.sensitivity.col(axis).head<6>() = regression.jacobian.row(axis).transpose();
    const double linear = estimate.mean(kAt<BearingBias> + axis) + batch.sensitivity(kAt<CentroidWander> + axis, axis) *
                                                                       estimate.mean(kAt<CentroidWander> + axis);
    batch.residual(axis) = -(regression.mean(axis) + linear);  // the measured direction has no component across itself
    batch.noise.col(axis).head<2>() = regression.nonlinearity.col(axis);
    batch.noise(axis, axis) += variance;
  }
  return Status::kOk;
}

}  // namespace vbar::fsw::sources
