#pragma once
// Measurement model of a bearing: rows of the filter.

#include "fsw/navigation/bearing.h"
#include "fsw/trunk/trunk.h"

namespace vbar::fsw::sources {

struct BearingModel {
  /// 1 sigma, m, per axis: centroid of the target's light about its mean, independent from image to image (its attitude
  /// and illumination change meanwhile). In metres it is the same at all ranges: negligible beyond 30 km, most of the
  /// error within 10 km.
  double centroid_noise_m = 0.08;

  bool operator==(const BearingModel&) const = default;
};

/// Fills the batch with the two components of the measured direction across the predicted one (bearing_axes(), rad).
/// The filter stands at the time of the bearing. Any status of the orbit conversions if there is no target to predict.
///
/// Model: axes (rho + sun_offset s + wander - o) / |...| + bearing bias; rho is sampled over the ROE, all others
/// enter linearly.
Status bearing_rows(const filter::RelativeNavigationFilter& filter, const navigation::BearingMeasurement& bearing,
                    const Vector3& sun_eci, const BearingModel& model, filter::MeasurementBatch& batch);

}  // namespace vbar::fsw::sources
