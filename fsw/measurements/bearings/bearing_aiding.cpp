#include "fsw/measurements/bearings/bearing_aiding.h"

#include <algorithm>
#include <array>

#include "fsw/estimation/unscented.h"
#include "fsw/math/math.h"

namespace vbar::fsw::measurements {

namespace {

using filter::kAt;

constexpr double square(double x) {
  return x * x;
}

}  // namespace

Status bearing_rows(const filter::RelativeNavigationFilter& filter, const target_tracking::BearingMeasurement& bearing,
                    const Vector3& sun_eci, const BearingModel& model, filter::MeasurementBatch& batch) {
  using Transform = estimation::UnscentedTransform<filter::Roe::kSize>;
  const orbit::CartesianState servicer = filter.servicer();
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok()) return chief.status();
  Transform transform;
  if (const Status status = transform.start(filter.roe(), filter.roe_covariance()); status != Status::kOk)
    return status;
  const filter::Estimate& estimate = filter.estimate();
  const Matrix3 axes = target_tracking::bearing_axes(bearing.direction_eci, servicer);
  const Vector3 camera = servicer.position_eci + bearing.origin_eci;
  batch.clear(2);
  std::array<Vector2, Transform::kPoints> values;
  double centroid_noise = 0.0;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    const auto target = orbit::target_from_roe(chief.value(), transform.point(k));
    if (!target.ok()) return target.status();
    const Vector3 sight = target_tracking::centre_of_brightness(target.value().position_eci, camera, sun_eci,
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

namespace {

using filter::SolutionStatus;

// This number of consecutive rejected bearings inflates the covariance, the second time more than the first; the third
// time a batch begins. The bearings accepted before the first rejection have by then corrupted the range, so that its
// uncertainty is inflated as well.
constexpr int kRejectedBeforeInflation = 5;
// A source that contradicts an orbit confirmed by others is suspended in place of all this, after this number of
// rejected bearings in excess of accepted ones, and until this number of consecutive bearings agrees.
constexpr int kRejectedBeforeSuspension = 3;
constexpr int kAgreeingBeforeAiding = 3;
constexpr std::array<double, 3> kInflatedVelocity = {0.1, 1.0, 1.0};    // m/s
constexpr std::array<double, 3> kInflatedDistance = {0.02, 0.05, 0.1};  // relative

// Innovations of bearings further apart than this are not neighbours.
constexpr Duration kNeighbours = duration_of_seconds(300);
// Without an accepted bearing for this long the source no longer aids: longer than an eclipse.
constexpr Duration kSilence = duration_of_seconds(2700);

}  // namespace

void BearingAiding::configure(const BearingSettings& settings) {
  if (!(settings.batch == settings_.batch)) batch_.clear();
  settings_ = settings;
}

BearingEditStatus BearingAiding::process(GpsTime time,
                                         const std::optional<target_tracking::BearingMeasurement>& bearing,
                                         const Vector3& sun_eci, filter::RelativeNavigationFilter& filter) {
  last_update_ = {};
  if (aid_.state() == AidState::kOff) aid_.go_to(AidState::kWaiting, time);
  follow_burns(filter);
  check_age(time);
  if (!bearing || !filter.has_relative()) return BearingEditStatus::kNone;
  if (filter.solution_status() != SolutionStatus::kEstimated) return collect(*bearing, sun_eci, filter);
  batch_.clear();
  activate_blocks(filter);
  return process_measurement(*bearing, sun_eci, filter);
}

void BearingAiding::check_age(GpsTime now) {
  if (aid_.state() == AidState::kAiding && now - last_accepted_ > kSilence) aid_.go_to(AidState::kSuspended, now);
}

void BearingAiding::follow_burns(const filter::RelativeNavigationFilter& filter) {
  for (const filter::Impulse& impulse : filter.impulses()) {
    if (impulse.time >= burns_until_) batch_.add_burn(impulse.time, impulse.dv_eci);
  }
  burns_until_ = filter.epoch();
}

void BearingAiding::activate_blocks(filter::RelativeNavigationFilter& filter) const {
  filter::Estimate& estimate = filter.estimate();
  const auto& processes = filter.settings().processes;
  if (!filter::is_active<BrightnessOffset>(estimate)) {
    filter::initialize_block<BrightnessOffset>(estimate, processes.of<BrightnessOffset>());
  }
  if (!filter::is_active<CentroidWander>(estimate)) {
    filter::initialize_block<CentroidWander>(estimate, processes.of<CentroidWander>());
  }
  if (!filter::is_active<BearingBias>(estimate)) {
    filter::initialize_block<BearingBias>(estimate, processes.of<BearingBias>());
  }
}

void BearingAiding::deactivate_blocks(filter::RelativeNavigationFilter& filter) const {
  filter::Estimate& estimate = filter.estimate();
  filter::deactivate_block<BrightnessOffset>(estimate);
  filter::deactivate_block<CentroidWander>(estimate);
  filter::deactivate_block<BearingBias>(estimate);
}

void BearingAiding::stop(GpsTime now, filter::RelativeNavigationFilter& filter) {
  if (aid_.is_on()) deactivate_blocks(filter);
  batch_.clear();
  aid_.go_to(AidState::kOff, now);
}

/// A batch that does not converge is solved again with every further bearing.
BearingEditStatus BearingAiding::collect(const target_tracking::BearingMeasurement& bearing, const Vector3& sun_eci,
                                         filter::RelativeNavigationFilter& filter) {
  aid_.go_to(AidState::kStarting, bearing.time);
  batch_.add(bearing);
  if (static_cast<int>(batch_.size()) < settings_.batch.bearings) return BearingEditStatus::kBatch;
  const auto solved = batch_.solve(filter.servicer(), filter.roe(), filter.roe_covariance(), filter.settings().earth,
                                   sun_eci, settings_.batch);
  if (!solved.ok()) {
    ++counters_.batches_failed;
    return BearingEditStatus::kBatch;
  }
  const measurements::BatchSolution& solution = solved.value();
  filter::Estimate& estimate = filter.estimate();
  deactivate_blocks(filter);
  filter.initialize_relative(solution.roe, solution.covariance.topLeftCorner<6, 6>(), SolutionStatus::kEstimated);
  activate_blocks(filter);
  constexpr int kBias = filter::kAt<BearingBias>;
  for (int axis = 0; axis < 2; ++axis) {
    estimate.reset(kBias + axis, solution.bias(axis), solution.covariance(6 + axis, 6 + axis));
    for (int k = 0; k < 6; ++k) estimate.correlate(k, kBias + axis, solution.covariance(k, 6 + axis));
  }
  estimate.correlate(kBias, kBias + 1, solution.covariance(6, 7));
  filter.finish_update();
  filter.confirm_relative(kSource);
  counters_.used += solution.used;
  last_accepted_ = batch_.last_time();
  batch_.clear();
  if (filter.has_relative()) aid_.go_to(AidState::kAiding, bearing.time);
  return BearingEditStatus::kBatch;
}

BearingEditStatus BearingAiding::process_measurement(const target_tracking::BearingMeasurement& bearing,
                                                     const Vector3& sun_eci, filter::RelativeNavigationFilter& filter) {
  if (!filter.is_precisely_determined()) centroid_scale_ = 1.0;
  BearingModel model = settings_.model;
  model.centroid_noise_m *= math::sqrt(centroid_scale_);
  filter.adaptation<CentroidWander>().variance_factor = centroid_scale_;
  filter::MeasurementBatch& batch = filter.workspace();
  if (bearing_rows(filter, bearing, sun_eci, model, batch) != Status::kOk) return BearingEditStatus::kRejected;
  estimation::predict_innovations(filter.estimate(), batch);
  last_update_.prefit = batch.residual.head<2>();
  last_update_.postfit = last_update_.prefit;
  last_update_.nis = estimation::group_nis(batch, 0, 2);
  aid_.consistency().add(last_update_.nis, 2);
  adapt_centroid_noise(filter);
  if (!(last_update_.nis <= settings_.gate)) {
    count_rejection(bearing.time, filter);
    return BearingEditStatus::kRejected;
  }
  if (aid_.is_contradicting() && ++agreeing_in_a_row_ < kAgreeingBeforeAiding) return BearingEditStatus::kRejected;
  adapt_noise(bearing, batch, filter);
  if (!filter.update(kSource, batch)) return BearingEditStatus::kRejected;
  last_update_.postfit = batch.residual.head<2>();
  ++counters_.used;
  aid_.set_contradicting(false);
  rejected_in_excess_ = rejected_in_excess_ > 0 ? rejected_in_excess_ - 1 : 0;
  rejected_in_a_row_ = 0;
  inflations_in_a_row_ = 0;
  last_accepted_ = bearing.time;
  aid_.go_to(AidState::kAiding, bearing.time);
  return BearingEditStatus::kFilter;
}

void BearingAiding::adapt_noise(const target_tracking::BearingMeasurement& bearing,
                                const filter::MeasurementBatch& batch, filter::RelativeNavigationFilter& filter) {
  filter::AdaptiveNoise& noise = filter.relative_orbit().noise();
  if (bearing.time - last_processed_ > kNeighbours) noise.interrupt();
  last_processed_ = bearing.time;
  // An empirical acceleration stands for the process noise.
  if (filter.is_precisely_determined()) return noise.interrupt();
  // Near the target the centroid dominates, whose errors follow its tumbling: the same sign from image to image.
  const bool is_of_centroid = batch.noise(0, 0) > 2.0 * bearing.sigma * bearing.sigma;
  using Correlation = filter::AdaptiveNoise::Correlation;
  noise.add(
      {batch.residual(0) / math::sqrt(batch.innovation(0, 0)), batch.residual(1) / math::sqrt(batch.innovation(1, 1))},
      is_of_centroid ? Correlation::kOfEither : Correlation::kOfLag);
}

/// Where receivers determine the orbit, the innovations measure the errors of the centroid, which the attitude of the
/// target changes: that of a target that follows the orbit varies less than that of a tumbling one, and once an orbit,
/// as the Sun moves about it, by a factor of ten. By a tenth of the misfit with each bearing, so that an hour suffices
/// for a decrease; an outlying bearing at once, before the gate rejects several in a row.
void BearingAiding::adapt_centroid_noise(const filter::RelativeNavigationFilter& filter) {
  constexpr double kShare = 0.1;
  constexpr double kMaxMisfit = 15.0;
  constexpr double kMinScale = 0.03, kMaxScale = 9.0;
  if (!filter.is_precisely_determined()) return;
  const double misfit = std::min(0.5 * last_update_.nis, kMaxMisfit);
  centroid_scale_ = std::clamp(centroid_scale_ * (1.0 + kShare * (misfit - 1.0)), kMinScale, kMaxScale);
}

void BearingAiding::count_rejection(GpsTime time, filter::RelativeNavigationFilter& filter) {
  ++counters_.rejected;
  agreeing_in_a_row_ = 0;
  if (filter.is_confirmed_by_others(kSource)) {
    rejected_in_a_row_ = 0;
    if (++rejected_in_excess_ < kRejectedBeforeSuspension) return;
    aid_.set_contradicting(true);
    aid_.go_to(AidState::kSuspended, time);
    return;
  }
  aid_.set_contradicting(false);
  rejected_in_excess_ = 0;
  if (++rejected_in_a_row_ < kRejectedBeforeInflation) return;
  rejected_in_a_row_ = 0;
  const double distance_m = math::abs(filter.a_roe_m()(1));
  filter.inflate_relative(kInflatedVelocity[inflations_in_a_row_],
                          kInflatedDistance[inflations_in_a_row_] * distance_m);
  ++counters_.inflations;
  aid_.go_to(AidState::kSuspended, time);
  if (++inflations_in_a_row_ < kInflatedVelocity.size()) return;
  inflations_in_a_row_ = 0;
  ++counters_.restarts;
  filter.mark_inconsistent();
  batch_.clear();
  aid_.go_to(AidState::kFailed, time);
}

}  // namespace vbar::fsw::measurements
