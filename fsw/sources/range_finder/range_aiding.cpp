#include "fsw/sources/range_finder/range_aiding.h"

#include <array>

#include "fsw/estimation/unscented.h"
#include "fsw/math/math.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::sources {
namespace {

constexpr int kBias = trunk::kAt<trunk::RangeBias>;

// Refusals in excess of acceptances that suspend the source, and consecutive agreeing measurements that resume it.
constexpr int kRefusedBeforeSuspension = 3;
constexpr int kAgreeingBeforeAiding = 3;

constexpr Duration kSilence = duration_of_seconds(60);

}  // namespace

Status range_rows(trunk::Trunk& trunk, double range_m, double noise_sigma_m) {
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
  trunk::Rows& rows = trunk.rows();
  rows.clear(1);
  rows.sensitivity.col(0).head<6>() = regression.jacobian.transpose();
  rows.sensitivity(kBias, 0) = 1.0;
  rows.residual(0) = range_m - regression.mean(0) - trunk.estimate().mean(kBias);
  rows.noise(0, 0) = noise_sigma_m * noise_sigma_m + regression.nonlinearity(0, 0);
  return Status::kOk;
}

RangeEditStatus RangeAiding::process(double range_m, trunk::Trunk& trunk) {
  const GpsTime time = trunk.epoch();
  if (trunk.knowledge() != trunk::RelativeKnowledge::kEstimated) return RangeEditStatus::kNone;
  if (!trunk::is_active<trunk::RangeBias>(trunk.estimate())) {
    trunk::begin_block<trunk::RangeBias>(trunk.estimate(), {.sigma = settings_.bias_sigma_m});
  }
  if (range_rows(trunk, range_m, settings_.noise_sigma_m) != Status::kOk) return refuse(time);
  estimation::predict_innovations(trunk.estimate(), trunk.rows());
  prefit_m_ = trunk.rows().residual(0);
  nis_ = estimation::group_nis(trunk.rows(), 0, 1);
  aid_.consistency().add(nis_, 1);
  if (!(nis_ <= settings_.gate)) return refuse(time);
  const bool is_suspended = refused_in_excess_ >= kRefusedBeforeSuspension;
  if (is_suspended && ++agreeing_in_a_row_ < kAgreeingBeforeAiding) return RangeEditStatus::kRefused;
  if (!trunk.fold()) return refuse(time);
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
  trunk::rest_block<trunk::RangeBias>(trunk.estimate());
  refused_in_excess_ = 0;
  agreeing_in_a_row_ = 0;
  aid_.go_to(AidState::kOff, now);
}

}  // namespace vbar::fsw::sources
