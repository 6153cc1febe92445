#include "fsw/sources/bearings/bearing_aiding.h"

#include <algorithm>

#include "fsw/math/math.h"

namespace vbar::fsw::sources {
namespace {

using trunk::RelativeKnowledge;

// This number of consecutive refused bearings inflates the covariance, the second time more than the first; the third
// time a batch begins. The bearings accepted before the first refusal have by then corrupted the range, so that its
// uncertainty is inflated as well.
constexpr int kRefusedBeforeInflation = 5;
// A source that contradicts an orbit confirmed by others is suspended in place of all this, after this number of
// refused bearings in excess of accepted ones, and until this number of consecutive bearings agrees.
constexpr int kRefusedBeforeSuspension = 3;
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

BearingEditStatus BearingAiding::process(GpsTime time, const std::optional<navigation::BearingMeasurement>& bearing,
                                         const Vector3& sun_eci, trunk::Trunk& trunk) {
  last_update_ = {};
  if (aid_.state() == AidState::kOff) aid_.go_to(AidState::kWaiting, time);
  follow_burns(trunk);
  check_age(time);
  if (!bearing || !trunk.has_relative()) return BearingEditStatus::kNone;
  if (trunk.knowledge() != RelativeKnowledge::kEstimated) return collect(*bearing, sun_eci, trunk);
  batch_.clear();
  activate_blocks(trunk);
  return process_measurement(*bearing, sun_eci, trunk);
}

void BearingAiding::check_age(GpsTime now) {
  if (aid_.state() == AidState::kAiding && now - last_accepted_ > kSilence) aid_.go_to(AidState::kSuspended, now);
}

void BearingAiding::follow_burns(const trunk::Trunk& trunk) {
  for (const trunk::Impulse& impulse : trunk.impulses()) {
    if (impulse.time >= burns_until_) batch_.add_burn(impulse.time, impulse.dv_eci);
  }
  burns_until_ = trunk.epoch();
}

void BearingAiding::activate_blocks(trunk::Trunk& trunk) const {
  trunk::Estimate& estimate = trunk.estimate();
  const auto& processes = trunk.settings().processes;
  if (!trunk::is_active<BrightnessOffset>(estimate)) {
    trunk::begin_block<BrightnessOffset>(estimate, processes.of<BrightnessOffset>());
  }
  if (!trunk::is_active<CentroidWander>(estimate)) {
    trunk::begin_block<CentroidWander>(estimate, processes.of<CentroidWander>());
  }
  if (!trunk::is_active<BearingBias>(estimate)) {
    trunk::begin_block<BearingBias>(estimate, processes.of<BearingBias>());
  }
}

void BearingAiding::rest_blocks(trunk::Trunk& trunk) const {
  trunk::Estimate& estimate = trunk.estimate();
  trunk::rest_block<BrightnessOffset>(estimate);
  trunk::rest_block<CentroidWander>(estimate);
  trunk::rest_block<BearingBias>(estimate);
}

void BearingAiding::stop(GpsTime now, trunk::Trunk& trunk) {
  if (aid_.is_on()) rest_blocks(trunk);
  batch_.clear();
  aid_.go_to(AidState::kOff, now);
}

/// A batch that does not converge is solved again with every further bearing.
BearingEditStatus BearingAiding::collect(const navigation::BearingMeasurement& bearing, const Vector3& sun_eci,
                                         trunk::Trunk& trunk) {
  aid_.go_to(AidState::kStarting, bearing.time);
  batch_.add(bearing);
  if (static_cast<int>(batch_.size()) < settings_.batch.bearings) return BearingEditStatus::kBatch;
  const auto solved = batch_.solve(trunk.servicer(), trunk.roe(), trunk.roe_covariance(), trunk.settings().earth,
                                   sun_eci, settings_.batch);
  if (!solved.ok()) {
    ++counters_.batches_failed;
    return BearingEditStatus::kBatch;
  }
  const navigation::BatchSolution& solution = solved.value();
  trunk::Estimate& estimate = trunk.estimate();
  rest_blocks(trunk);
  trunk.begin_relative(solution.roe, solution.covariance.topLeftCorner<6, 6>(), RelativeKnowledge::kEstimated);
  activate_blocks(trunk);
  constexpr int kBias = trunk::kAt<BearingBias>;
  for (int axis = 0; axis < 2; ++axis) {
    estimate.reset(kBias + axis, solution.bias(axis), solution.covariance(6 + axis, 6 + axis));
    for (int k = 0; k < 6; ++k) estimate.correlate(k, kBias + axis, solution.covariance(k, 6 + axis));
  }
  estimate.correlate(kBias, kBias + 1, solution.covariance(6, 7));
  trunk.finish_update();
  trunk.confirm_relative(kSource);
  counters_.used += solution.used;
  last_accepted_ = batch_.last_time();
  batch_.clear();
  if (trunk.has_relative()) aid_.go_to(AidState::kAiding, bearing.time);
  return BearingEditStatus::kBatch;
}

BearingEditStatus BearingAiding::process_measurement(const navigation::BearingMeasurement& bearing,
                                                     const Vector3& sun_eci, trunk::Trunk& trunk) {
  if (!trunk.is_precisely_determined()) centroid_scale_ = 1.0;
  BearingModel model = settings_.model;
  model.centroid_noise_m *= math::sqrt(centroid_scale_);
  trunk.adaptation<CentroidWander>().variance_factor = centroid_scale_;
  trunk::MeasurementBatch& batch = trunk.workspace();
  if (bearing_rows(trunk, bearing, sun_eci, model, batch) != Status::kOk) return BearingEditStatus::kRefused;
  estimation::predict_innovations(trunk.estimate(), batch);
  last_update_.prefit = batch.residual.head<2>();
  last_update_.postfit = last_update_.prefit;
  last_update_.nis = estimation::group_nis(batch, 0, 2);
  aid_.consistency().add(last_update_.nis, 2);
  adapt_centroid_noise(trunk);
  if (!(last_update_.nis <= settings_.gate)) {
    count_refusal(bearing.time, trunk);
    return BearingEditStatus::kRefused;
  }
  if (aid_.is_contradicting() && ++agreeing_in_a_row_ < kAgreeingBeforeAiding) return BearingEditStatus::kRefused;
  adapt_noise(bearing, batch, trunk);
  if (!trunk.update(kSource, batch)) return BearingEditStatus::kRefused;
  last_update_.postfit = batch.residual.head<2>();
  ++counters_.used;
  aid_.set_contradicting(false);
  refused_in_excess_ = refused_in_excess_ > 0 ? refused_in_excess_ - 1 : 0;
  refused_in_a_row_ = 0;
  inflations_in_a_row_ = 0;
  last_accepted_ = bearing.time;
  aid_.go_to(AidState::kAiding, bearing.time);
  return BearingEditStatus::kFilter;
}

void BearingAiding::adapt_noise(const navigation::BearingMeasurement& bearing, const trunk::MeasurementBatch& batch,
                                trunk::Trunk& trunk) {
  navigation::AdaptiveNoise& noise = trunk.relative_orbit().noise();
  if (bearing.time - last_folded_ > kNeighbours) noise.interrupt();
  last_folded_ = bearing.time;
  // An empirical acceleration stands for the process noise.
  if (trunk.is_precisely_determined()) return noise.interrupt();
  // Near the target the centroid dominates, whose errors follow its tumbling: the same sign from image to image.
  const bool is_of_centroid = batch.noise(0, 0) > 2.0 * bearing.sigma * bearing.sigma;
  using Correlation = navigation::AdaptiveNoise::Correlation;
  noise.take(
      {batch.residual(0) / math::sqrt(batch.innovation(0, 0)), batch.residual(1) / math::sqrt(batch.innovation(1, 1))},
      is_of_centroid ? Correlation::kOfEither : Correlation::kOfLag);
}

/// Where receivers determine the orbit, the innovations measure the errors of the centroid, which the attitude of the
/// target changes: that of a target that follows the orbit varies less than that of a tumbling one, and once an orbit,
/// as the Sun moves about it, by a factor of ten. By a tenth of the misfit with each bearing, so that an hour suffices
/// for a decrease; an outlying bearing at once, before the gate refuses several in a row.
void BearingAiding::adapt_centroid_noise(const trunk::Trunk& trunk) {
  constexpr double kShare = 0.1;
  constexpr double kMaxMisfit = 15.0;
  constexpr double kMinScale = 0.03, kMaxScale = 9.0;
  if (!trunk.is_precisely_determined()) return;
  const double misfit = std::min(0.5 * last_update_.nis, kMaxMisfit);
  centroid_scale_ = std::clamp(centroid_scale_ * (1.0 + kShare * (misfit - 1.0)), kMinScale, kMaxScale);
}

void BearingAiding::count_refusal(GpsTime time, trunk::Trunk& trunk) {
  ++counters_.refused;
  agreeing_in_a_row_ = 0;
  if (trunk.is_confirmed_by_others(kSource)) {
    refused_in_a_row_ = 0;
    if (++refused_in_excess_ < kRefusedBeforeSuspension) return;
    aid_.set_contradicting(true);
    aid_.go_to(AidState::kSuspended, time);
    return;
  }
  aid_.set_contradicting(false);
  refused_in_excess_ = 0;
  if (++refused_in_a_row_ < kRefusedBeforeInflation) return;
  refused_in_a_row_ = 0;
  const double distance_m = math::abs(trunk.a_roe_m()(1));
  trunk.inflate_relative(kInflatedVelocity[inflations_in_a_row_], kInflatedDistance[inflations_in_a_row_] * distance_m);
  ++counters_.inflations;
  aid_.go_to(AidState::kSuspended, time);
  if (++inflations_in_a_row_ < kInflatedVelocity.size()) return;
  inflations_in_a_row_ = 0;
  ++counters_.restarts;
  trunk.distrust_relative();
  batch_.clear();
  aid_.go_to(AidState::kFailed, time);
}

}  // namespace vbar::fsw::sources
