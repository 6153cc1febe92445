#include "fsw/sources/range_finder/range_aiding.h"

#include <array>

#include "fsw/estimation/unscented.h"
#include "fsw/math/math.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::sources {
namespace {

constexpr int kBias = trunk::kAt<RangeBias>;

// Refusals in excess of acceptances that suspend the source, and consecutive agreeing measurements that resume it.
constexpr int kRefusedBeforeSuspension = 3;
constexpr int kAgreeingBeforeAiding = 3;

constexpr Duration kSilence = duration_of_seconds(60);

}  // namespace

Status range_rows(const trunk::Trunk& trunk, double range_m, double noise_sigma_m, trunk::MeasurementBatch& batch) {
  using Transform = estimation::UnscentedTransform<trunk::Roe::kSize>;
  const orbit::CartesianState servicer = trunk.servicer();
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok()) return chief.status();
  Transform transform;
  if (const Status status = transform.start(trunk.roe(), trunk.roe_covariance()); status != Status::kOk) return status;
  std::array<Eigen::Matrix<double, 1, 1>, Transform::kPoints> values;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    const auto target = orbit::target_from_roe(chief.value(), transform.point(k));
    if (!target.ok()) return target.status();
    values[k](0) = math::sqrt((target.value().position_eci - servicer.position_eci).squaredNorm());
  }
  const auto regression = transform.regress<1>(values);
  batch.clear(1);
  batch.sensitivity.col(0).head<6>() = regression.jacobian.transpose();
  batch.sensitivity(kBias, 0) = 1.0;
  batch.residual(0) = range_m - regression.mean(0) - trunk.estimate().mean(kBias);
  batch.noise(0, 0) = noise_sigma_m * noise_sigma_m + regression.nonlinearity(0, 0);
  return Status::kOk;
}

RangeEditStatus RangeAiding::process(double range_m, trunk::Trunk& trunk) {
  const GpsTime time = trunk.epoch();
  if (trunk.knowledge() != trunk::RelativeKnowledge::kEstimated) return RangeEditStatus::kNone;
  if (!trunk::is_active<RangeBias>(trunk.estimate())) {
    trunk::begin_block<RangeBias>(trunk.estimate(), {.sigma = settings_.bias_sigma_m});
  }
  trunk::MeasurementBatch& batch = trunk.workspace();
  if (range_rows(trunk, range_m, settings_.noise_sigma_m, batch) != Status::kOk) return refuse(time);
  estimation::predict_innovations(trunk.estimate(), batch);
  prefit_m_ = batch.residual(0);
  nis_ = estimation::group_nis(batch, 0, 1);
  aid_.consistency().add(nis_, 1);
  if (!(nis_ <= settings_.gate)) return refuse(time);
  const bool is_suspended = refused_in_excess_ >= kRefusedBeforeSuspension;
  if (is_suspended && ++agreeing_in_a_row_ < kAgreeingBeforeAiding) return RangeEditStatus::kRefused;
  if (!trunk.update(kSource, batch)) return refuse(time);
  refused_in_excess_ = is_suspended || refused_in_excess_ == 0 ? 0 : refused_in_excess_ - 1;
  agreeing_in_a_row_ = 0;
  aid_.set_contradicting(false);
  ++counters_.used;
  last_accepted_ = time;
  aid_.go_to(AidState::kAiding, time);
  return RangeEditStatus::kUsed;
}

RangeEditStatus RangeAiding::refuse(GpsTime time) {
  ++counters_.refused;
  agreeing_in_a_row_ = 0;
  if (refused_in_excess_ < kRefusedBeforeSuspension && ++refused_in_excess_ == kRefusedBeforeSuspension) {
    aid_.set_contradicting(true);
    aid_.go_to(AidState::kSuspended, time);
  }
  return RangeEditStatus::kRefused;
}

void RangeAiding::check_age(GpsTime now) {
  if (aid_.state() == AidState::kAiding && now - last_accepted_ > kSilence) aid_.go_to(AidState::kSuspended, now);
}

void RangeAiding::stop(GpsTime now, trunk::Trunk& trunk) {
  trunk::rest_block<RangeBias>(trunk.estimate());
  refused_in_excess_ = 0;
  agreeing_in_a_row_ = 0;
  aid_.go_to(AidState::kOff, now);
}

}  // namespace vbar::fsw::sources
