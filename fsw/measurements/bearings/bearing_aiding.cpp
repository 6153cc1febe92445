#include "fsw/measurements/bearings/bearing_aiding.h"

#include <algorithm>
#include <array>

#include "fsw/estimation/unscented.h"
#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"

namespace vbar::fsw::measurements {

namespace {

using filter::kAt;

constexpr double square(double x) {
  return x * x;
}

target_tracking::BrightnessOffsets offsets_of(const filter::Estimate& estimate) {
  return {.to_sun_m = estimate.mean(kAt<BrightnessOffset>), .to_earth_m = estimate.mean(kAt<EarthlightOffset>)};
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
  double growth = 1.0;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    const auto target = orbit::target_from_roe(chief.value(), transform.point(k));
    if (!target.ok()) return target.status();
    const Vector3 sight =
        target_tracking::centre_of_brightness(target.value().position_eci, camera, sun_eci, offsets_of(estimate)) -
        camera;
    const double range = math::sqrt(sight.squaredNorm());
    values[k] = axes.topRows<2>() * sight / range;
    if (k > 0) continue;
    growth = target_tracking::centroid_scatter_growth(target_tracking::cos_phase_of(sight, sun_eci));
    centroid_noise = growth * model.centroid_noise_m / range;
    const Vector2 along_sun = axes.topRows<2>() * target_tracking::brightness_displacement(sight, sun_eci) / range;
    const Vector2 to_earth =
        axes.topRows<2>() * target_tracking::earthlight_displacement(sight, target.value().position_eci) / range;
    for (int axis = 0; axis < 2; ++axis) {
      batch.sensitivity(kAt<BrightnessOffset>, axis) = along_sun(axis);
      batch.sensitivity(kAt<EarthlightOffset>, axis) = to_earth(axis);
      batch.sensitivity(kAt<CentroidWander> + axis, axis) = growth / range;
      batch.sensitivity(kAt<BearingBias> + axis, axis) = 1.0;
    }
  }
  const auto regression = transform.regress<2>(values);
  const double variance = model.scatter * (square(bearing.sigma) + square(centroid_noise));
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

// Bearings that contradict the orbit open a window, in which hypotheses are weighed from this number of rejected ones
// on. It closes after this number of consecutive ones that agree, and is given up when it is full or a gap interrupts
// it.
constexpr int kRejectedBeforeWeighing = 3;
constexpr int kAgreeingBeforeClosing = 4;
constexpr std::size_t kLargestWindow = 30;
// Log-likelihood by which a changed orbit must exceed the orbit as estimated: a probability of 1e-3. From the second
// limit down, more scatter than stated explains the bearings, and is used for the next ones.
constexpr double kDecisive = 7.0;
constexpr double kIsScatter = -1.0;
constexpr double kMaxScatter = 64.0;
// An unknown burn is sought within half a day.
constexpr double kLongestUnseen_s = 43200.0;
// A source that contradicts an orbit confirmed by others is suspended in place of all this, after this number of
// rejected bearings in excess of accepted ones, and until this number of consecutive bearings agrees.
constexpr int kRejectedBeforeSuspension = 3;
constexpr int kAgreeingBeforeAiding = 3;
// Correlation of neighbouring innovations from which the orbit lags: three sigma of 50 pairs of two white ones.
constexpr double kLagging = 0.3;

// Innovations of bearings further apart than this are not neighbours.
constexpr Duration kNeighbours = duration_of_seconds(300);
// Without an accepted bearing for this long the source no longer aids: longer than an eclipse.
constexpr Duration kSilence = duration_of_seconds(2700);

}  // namespace

void BearingAiding::configure(const BearingSettings& settings) {
  if (!(settings.batch == settings_.batch)) close_window();
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

namespace {

/// Calls apply<Block>() for the blocks of the target's centroid.
template <class Apply>
void for_each_block_of_centroid(Apply&& apply) {
  apply.template operator()<BrightnessOffset>();
  apply.template operator()<EarthlightOffset>();
  apply.template operator()<CentroidWander>();
}

}  // namespace

void BearingAiding::activate_blocks(filter::RelativeNavigationFilter& filter) const {
  filter::Estimate& estimate = filter.estimate();
  const auto& processes = filter.settings().processes;
  const auto activate = [&]<class Block>() {
    if (!filter::is_active<Block>(estimate)) filter::initialize_block<Block>(estimate, processes.of<Block>());
  };
  for_each_block_of_centroid(activate);
  activate.template operator()<BearingBias>();
}

void BearingAiding::deactivate_blocks(filter::RelativeNavigationFilter& filter) const {
  const auto deactivate = [&]<class Block>() { filter::deactivate_block<Block>(filter.estimate()); };
  for_each_block_of_centroid(deactivate);
  deactivate.template operator()<BearingBias>();
}

const KeptOrbit& BearingAiding::kept_at_epoch(const filter::RelativeNavigationFilter& filter) {
  kept_.advance(filter);
  return kept_;
}

void BearingAiding::return_to_kept(GpsTime now, filter::RelativeNavigationFilter& filter) {
  filter.initialize_relative(kept_.roe(), kept_.covariance(), SolutionStatus::kEstimated);
  deactivate_blocks(filter);
  close_window();
  scatter_ = 1.0;
  kept_.forget();
  ++counters_.returns;
  aid_.go_to(AidState::kSuspended, now);
}

void BearingAiding::stop(GpsTime now, filter::RelativeNavigationFilter& filter) {
  if (aid_.is_on()) deactivate_blocks(filter);
  kept_.forget();
  close_window();
  aid_.go_to(AidState::kOff, now);
}

namespace {

void take_bias(const BatchSolution& solution, filter::Estimate& estimate) {
  constexpr int kBias = kAt<BearingBias>;
  for (int axis = 0; axis < 2; ++axis) {
    estimate.reset(kBias + axis, solution.bias(axis), solution.covariance(6 + axis, 6 + axis));
    for (int k = 0; k < 6; ++k) estimate.correlate(k, kBias + axis, solution.covariance(k, 6 + axis));
  }
  estimate.correlate(kBias, kBias + 1, solution.covariance(6, 7));
}

}  // namespace

/// A batch that does not converge is solved again with every further bearing.
BearingEditStatus BearingAiding::collect(const target_tracking::BearingMeasurement& bearing, const Vector3& sun_eci,
                                         filter::RelativeNavigationFilter& filter) {
  aid_.go_to(AidState::kStarting, bearing.time);
  add_to_window(bearing, sun_eci, filter);
  if (static_cast<int>(batch_.size()) < settings_.batch.bearings) return BearingEditStatus::kBatch;
  const bool has_failed = filter.solution_status() == SolutionStatus::kInconsistent;
  const EstimatedOrbit known = estimated_orbit(filter, sun_eci);
  // After contradictions the orbit may have changed, and the target may be near enough for its shape to matter.
  const auto prior = has_failed ? widest_covariance(known) : Result<Matrix6>(known.covariance);
  if (!prior.ok()) return BearingEditStatus::kBatch;
  BearingBatchSettings settings = settings_.batch;
  if (has_failed) settings.bias_sigma = known.common_sigma;
  const auto solved = batch_.solve(known.servicer, known.roe, prior.value(), known.earth, sun_eci, settings);
  if (!solved.ok()) {
    ++counters_.batches_failed;
    return BearingEditStatus::kBatch;
  }
  const measurements::BatchSolution& solution = solved.value();
  filter::Estimate& estimate = filter.estimate();
  deactivate_blocks(filter);
  filter.initialize_relative(solution.roe, solution.covariance.topLeftCorner<6, 6>(), SolutionStatus::kEstimated);
  activate_blocks(filter);
  if (!has_failed) take_bias(solution, estimate);
  filter.finish_update();
  filter.confirm_relative(kSource);
  counters_.used += solution.used;
  last_accepted_ = batch_.last_time();
  close_window();
  if (filter.has_relative()) aid_.go_to(AidState::kAiding, bearing.time);
  return BearingEditStatus::kBatch;
}

BearingModel BearingAiding::model_now() const {
  BearingModel model = settings_.model;
  model.centroid_noise_m *= math::sqrt(centroid_scale_);
  model.scatter = scatter_;
  return model;
}

/// Rows and innovations of a bearing, into the workspace of the filter.
Status BearingAiding::predict(const target_tracking::BearingMeasurement& bearing, const Vector3& sun_eci,
                              filter::RelativeNavigationFilter& filter) {
  filter.adaptation<CentroidWander>().variance_factor = centroid_scale_;
  filter::MeasurementBatch& batch = filter.workspace();
  if (const Status status = bearing_rows(filter, bearing, sun_eci, model_now(), batch); status != Status::kOk)
    return status;
  estimation::predict_innovations(filter.estimate(), batch);
  last_update_.prefit = batch.residual.head<2>();
  last_update_.postfit = last_update_.prefit;
  last_update_.nis = estimation::group_nis(batch, 0, 2);
  return Status::kOk;
}

/// The centroid as unknown as before the first bearing. A target that follows the orbit shows it at the same place for
/// half an orbit; as the Sun leaves one face for the next, or reaches a dark body from behind, it moves across the
/// body.
void BearingAiding::forget_centroid(filter::RelativeNavigationFilter& filter) {
  centroid_scale_ = 1.0;
  const auto& processes = filter.settings().processes;
  for_each_block_of_centroid(
      [&]<class Block>() { filter::initialize_block<Block>(filter.estimate(), processes.of<Block>()); });
}

BearingEditStatus BearingAiding::process_measurement(const target_tracking::BearingMeasurement& bearing,
                                                     const Vector3& sun_eci, filter::RelativeNavigationFilter& filter) {
  if (batch_.size() > 0 && bearing.time - batch_.last_time() > kSilence) close_window();
  if (!filter.is_precisely_determined()) centroid_scale_ = 1.0;
  filter::MeasurementBatch& batch = filter.workspace();
  if (predict(bearing, sun_eci, filter) != Status::kOk) return BearingEditStatus::kRejected;
  last_bearing_ = bearing;
  last_sun_eci_ = sun_eci;
  // A bearing contradicts other sources by more than the stated size of the target's centroid errors only.
  if (centroid_scale_ < 1.0 && !(last_update_.nis <= settings_.gate)) {
    forget_centroid(filter);
    if (predict(bearing, sun_eci, filter) != Status::kOk) return BearingEditStatus::kRejected;
  }
  aid_.consistency().add(last_update_.nis, 2);
  note_correlation(bearing, batch);
  adapt_centroid_noise(filter);
  adapt_scatter();
  if (!(last_update_.nis <= settings_.gate)) {
    count_rejection(bearing, sun_eci, filter);
    return BearingEditStatus::kRejected;
  }
  if (aid_.is_contradicting() && ++agreeing_in_a_row_ < kAgreeingBeforeAiding) return BearingEditStatus::kRejected;
  if (batch_.size() > 0) {
    // Agreement by more scatter is not agreement with the orbit.
    agreeing_in_window_ = last_update_.nis * scatter_ <= settings_.gate ? agreeing_in_window_ + 1 : 0;
    add_to_window(bearing, sun_eci, filter);
  }
  adapt_noise(bearing, batch, filter);
  if (!filter.update(kSource, batch)) return BearingEditStatus::kRejected;
  last_update_.postfit = batch.residual.head<2>();
  ++counters_.used;
  aid_.set_contradicting(false);
  rejected_in_excess_ = rejected_in_excess_ > 0 ? rejected_in_excess_ - 1 : 0;
  last_accepted_ = bearing.time;
  aid_.go_to(AidState::kAiding, bearing.time);
  if (agreeing_in_window_ >= kAgreeingBeforeClosing) close_window();
  if (agreeing_in_window_ == 0) weigh_window(bearing.time, sun_eci, filter);
  return BearingEditStatus::kFilter;
}

void BearingAiding::adapt_noise(const target_tracking::BearingMeasurement& bearing,
                                const filter::MeasurementBatch& batch, filter::RelativeNavigationFilter& filter) {
  filter::AdaptiveNoise& noise = filter.relative_orbit().noise();
  if (bearing.time - last_accepted_ > kNeighbours) noise.interrupt();
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
  constexpr double kMinScale = 0.01, kMaxScale = 9.0;
  if (!filter.is_precisely_determined()) return;
  const double misfit = std::min(0.5 * last_update_.nis, kMaxMisfit);
  centroid_scale_ = std::clamp(centroid_scale_ * (1.0 + kShare * (misfit - 1.0)), kMinScale, kMaxScale);
}

/// By a tenth of the misfit with each bearing, as the noise of the centroid; never below that of the settings.
void BearingAiding::adapt_scatter() {
  constexpr double kShare = 0.1;
  if (scatter_ > 1.0)
    scatter_ = std::clamp(scatter_ * (1.0 + kShare * (std::min(0.5 * last_update_.nis, 2.0) - 1.0)), 1.0, kMaxScatter);
}

void BearingAiding::note_correlation(const target_tracking::BearingMeasurement& bearing,
                                     const filter::MeasurementBatch& batch) {
  constexpr double kShare = 1.0 / Consistency::kMemory;
  const Vector2 now(batch.residual(0) / math::sqrt(batch.innovation(0, 0)),
                    batch.residual(1) / math::sqrt(batch.innovation(1, 1)));
  if (!math::is_finite(now.sum())) return;
  if (bearing.time - last_processed_ <= kNeighbours)
    correlation_ += kShare * (0.5 * now.dot(last_normalised_) - correlation_);
  mean_square_ += kShare * (0.5 * now.squaredNorm() - mean_square_);
  last_normalised_ = now;
  last_processed_ = bearing.time;
}

void BearingAiding::explain_excess(double mean_nis, filter::RelativeNavigationFilter& filter) {
  if (correlation_ < kLagging * mean_square_) {
    scatter_ = std::min(scatter_ * mean_nis, kMaxScatter);
    return;
  }
  filter::MeasurementBatch& batch = filter.workspace();
  if (!last_bearing_ || bearing_rows(filter, *last_bearing_, last_sun_eci_, model_now(), batch) != Status::kOk) return;
  const filter::Estimate& estimate = filter.estimate();
  estimation::predict_innovations(estimate, batch);
  Eigen::Matrix<double, 6, 2> gain;
  for (int axis = 0; axis < 2; ++axis)
    gain.col(axis) = estimate.covariance_times(batch.sensitivity.col(axis)).head<6>();
  // Rank two, P H' (H P H')^-1 (f - 1) S (H P H')^-1 H P: the predicted innovations get the covariance f S.
  const Matrix2 innovation = batch.innovation.topLeftCorner<2, 2>();
  const Matrix2 of_orbit = innovation - batch.noise.topLeftCorner<2, 2>();
  const math::Cholesky<2> factor(of_orbit);
  if (!factor.ok()) return;
  const Matrix2 inverse = factor.inverse();
  const Matrix2 wanted = (mean_nis - 1.0) * inverse.lazyProduct(innovation).lazyProduct(inverse);
  const Eigen::Matrix<double, 6, 2> weighted = gain.lazyProduct(wanted);
  const Matrix6 excess = weighted.lazyProduct(gain.transpose());
  filter.estimate().transform_head<6>(filter.roe(), Matrix6::Identity(), excess);
  filter.finish_update();
}

void BearingAiding::count_rejection(const target_tracking::BearingMeasurement& bearing, const Vector3& sun_eci,
                                    filter::RelativeNavigationFilter& filter) {
  ++counters_.rejected;
  agreeing_in_a_row_ = 0;
  if (filter.is_confirmed_by_others(kSource)) {
    close_window();
    if (++rejected_in_excess_ < kRejectedBeforeSuspension) return;
    aid_.set_contradicting(true);
    aid_.go_to(AidState::kSuspended, bearing.time);
    return;
  }
  aid_.set_contradicting(false);
  rejected_in_excess_ = 0;
  agreeing_in_window_ = 0;
  add_to_window(bearing, sun_eci, filter);
  if (++rejected_in_window_ >= kRejectedBeforeWeighing) aid_.go_to(AidState::kSuspended, bearing.time);
  weigh_window(bearing.time, sun_eci, filter);
}

/// The bearing as it would be of the centre of mass, with the scatter of the centroid in its standard deviation.
void BearingAiding::add_to_window(const target_tracking::BearingMeasurement& bearing, const Vector3& sun_eci,
                                  const filter::RelativeNavigationFilter& filter) {
  const auto target = filter.target();
  if (!target.ok()) return;
  const orbit::CartesianState servicer = filter.servicer();
  const Vector3 sight = target.value().position_eci - servicer.position_eci - bearing.origin_eci;
  const double range = math::sqrt(sight.squaredNorm());
  // Neither one that is not finite, nor one of something behind the camera.
  if (!(bearing.direction_eci.dot(sight) > 0.5 * range)) return;
  const filter::Estimate& estimate = filter.estimate();
  const double growth = target_tracking::centroid_scatter_growth(target_tracking::cos_phase_of(sight, sun_eci));
  const Matrix3 axes = target_tracking::bearing_axes(bearing.direction_eci, servicer);
  const Vector3 target_eci = target.value().position_eci;
  const Vector3 camera = target_eci - sight;
  Vector3 offset =
      (target_tracking::centre_of_brightness(target_eci, camera, sun_eci, offsets_of(estimate)) - target_eci) / range;
  for (int axis = 0; axis < 2; ++axis) {
    offset += (estimate.mean(kAt<BearingBias> + axis) + growth / range * estimate.mean(kAt<CentroidWander> + axis)) *
              axes.row(axis).transpose();
  }
  target_tracking::BearingMeasurement corrected = bearing;
  corrected.direction_eci = (bearing.direction_eci - offset).normalized();
  corrected.sigma = math::hypot(bearing.sigma, growth * settings_.model.centroid_noise_m / range);
  if (batch_.size() == 0) before_window_ = last_accepted_;
  batch_.add(corrected);
}

void BearingAiding::close_window() {
  batch_.clear();
  rejected_in_window_ = 0;
  agreeing_in_window_ = 0;
}

/// Errors that the bearings of a window have in common: their bias, and the lasting part of the centroid.
EstimatedOrbit BearingAiding::estimated_orbit(const filter::RelativeNavigationFilter& filter,
                                              const Vector3& sun_eci) const {
  const filter::Estimate& estimate = filter.estimate();
  EstimatedOrbit orbit;
  orbit.servicer = filter.servicer();
  orbit.roe = filter.roe();
  orbit.covariance = filter.roe_covariance();
  orbit.earth = filter.settings().earth;
  orbit.sun_eci = sun_eci;
  orbit.unseen_s = std::clamp(seconds(filter.epoch() - before_window_), 0.0, kLongestUnseen_s);
  const auto target = filter.target();
  if (!target.ok()) return orbit;
  const Vector3 sight = target.value().position_eci - orbit.servicer.position_eci;
  orbit.distance_m = math::sqrt(sight.squaredNorm());
  const double growth = target_tracking::centroid_scatter_growth(target_tracking::cos_phase_of(sight, sun_eci));
  const auto& processes = filter.settings().processes;
  const auto sigma_of = [&]<class Block>() {
    return filter::is_active<Block>(estimate) ? math::sqrt(estimate.variance(kAt<Block>)) : processes.of<Block>().sigma;
  };
  const double offset_sigma =
      math::hypot(sigma_of.template operator()<BrightnessOffset>(), sigma_of.template operator()<EarthlightOffset>());
  const double lasting_m = math::hypot(growth * processes.of<CentroidWander>().sigma, offset_sigma);
  orbit.common_sigma = math::hypot(processes.of<BearingBias>().sigma, lasting_m / orbit.distance_m);
  return orbit;
}

void BearingAiding::weigh_window(GpsTime time, const Vector3& sun_eci, filter::RelativeNavigationFilter& filter) {
  if (rejected_in_window_ < kRejectedBeforeWeighing) return;
  const EstimatedOrbit estimated = estimated_orbit(filter, sun_eci);
  const auto verdict = weigh_orbits(batch_, estimated);
  if (verdict.ok() && verdict.value().log_odds > kDecisive) {
    const auto revised = revised_orbit(batch_, estimated, verdict.value());
    if (revised.ok()) {
      kept_.keep(filter);
      filter.initialize_relative(revised.value().roe, revised.value().covariance, SolutionStatus::kEstimated);
      ++counters_.revisions;
      scatter_ = std::clamp(verdict.value().best_scatter, 1.0, kMaxScatter);
      return close_window();
    }
  } else if (verdict.ok() && verdict.value().log_odds < kIsScatter) {
    scatter_ = std::clamp(verdict.value().scatter, scatter_, kMaxScatter);
  }
  if (batch_.size() < kLargestWindow) return;
  const bool is_explained = 2 * rejected_in_window_ < static_cast<int>(batch_.size());
  is_explained ? close_window() : restart_batch(time, filter);
}

/// No hypothesis explains the bearings: another batch begins, with the orbit as prior.
void BearingAiding::restart_batch(GpsTime time, filter::RelativeNavigationFilter& filter) {
  ++counters_.restarts;
  kept_.keep(filter);
  filter.mark_inconsistent();
  deactivate_blocks(filter);
  close_window();
  aid_.go_to(AidState::kFailed, time);
}

}  // namespace vbar::fsw::measurements
