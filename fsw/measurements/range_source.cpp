#include "fsw/measurements/range_source.h"

#include <array>

#include "fsw/estimation/unscented.h"
#include "fsw/math/math.h"
#include "fsw/messaging/message_fields.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::measurements {

namespace {

constexpr int kBias = filter::kAt<RangeBias>;

// Refusals in excess of acceptances that suspend the source, and consecutive agreeing measurements that resume it.
constexpr int kRejectedBeforeSuspension = 3;
constexpr int kAgreeingBeforeAiding = 3;

constexpr Duration kSilence = duration_of_seconds(60);

}  // namespace

Status range_rows(const filter::RelativeNavigationFilter& filter, double range_m, double noise_sigma_m,
                  filter::MeasurementBatch& batch) {
  using Transform = estimation::UnscentedTransform<filter::Roe::kSize>;
  const orbit::CartesianState servicer = filter.servicer();
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok()) return chief.status();
  Transform transform;
  if (const Status status = transform.start(filter.roe(), filter.roe_covariance()); status != Status::kOk)
    return status;
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
  batch.residual(0) = range_m - regression.mean(0) - filter.estimate().mean(kBias);
  batch.noise(0, 0) = noise_sigma_m * noise_sigma_m + regression.nonlinearity(0, 0);
  return Status::kOk;
}

RangeEditStatus RangeAiding::process(double range_m, filter::RelativeNavigationFilter& filter) {
  const GpsTime time = filter.epoch();
  if (filter.solution_status() != filter::SolutionStatus::kEstimated) return RangeEditStatus::kNone;
  if (!filter::is_active<RangeBias>(filter.estimate())) {
    filter::initialize_block<RangeBias>(filter.estimate(), {.sigma = settings_.bias_sigma_m});
  }
  filter::MeasurementBatch& batch = filter.workspace();
  if (range_rows(filter, range_m, settings_.noise_sigma_m, batch) != Status::kOk) return reject(time);
  estimation::predict_innovations(filter.estimate(), batch);
  prefit_m_ = batch.residual(0);
  nis_ = estimation::group_nis(batch, 0, 1);
  aid_.consistency().add(nis_, 1);
  if (!(nis_ <= settings_.gate)) return reject(time);
  const bool is_suspended = rejected_in_excess_ >= kRejectedBeforeSuspension;
  if (is_suspended && ++agreeing_in_a_row_ < kAgreeingBeforeAiding) return RangeEditStatus::kRejected;
  if (!filter.update(kSource, batch)) return reject(time);
  rejected_in_excess_ = is_suspended || rejected_in_excess_ == 0 ? 0 : rejected_in_excess_ - 1;
  agreeing_in_a_row_ = 0;
  aid_.set_contradicting(false);
  ++counters_.used;
  last_accepted_ = time;
  aid_.go_to(AidState::kAiding, time);
  return RangeEditStatus::kUsed;
}

RangeEditStatus RangeAiding::reject(GpsTime time) {
  ++counters_.rejected;
  agreeing_in_a_row_ = 0;
  if (rejected_in_excess_ < kRejectedBeforeSuspension && ++rejected_in_excess_ == kRejectedBeforeSuspension) {
    aid_.set_contradicting(true);
    aid_.go_to(AidState::kSuspended, time);
  }
  return RangeEditStatus::kRejected;
}

void RangeAiding::check_age(GpsTime now) {
  if (aid_.state() == AidState::kAiding && now - last_accepted_ > kSilence) aid_.go_to(AidState::kSuspended, now);
}

void RangeAiding::stop(GpsTime now, filter::RelativeNavigationFilter& filter) {
  filter::deactivate_block<RangeBias>(filter.estimate());
  rejected_in_excess_ = 0;
  agreeing_in_a_row_ = 0;
  aid_.go_to(AidState::kOff, now);
}

static_assert(static_cast<int>(RangeEditStatus::kUsed) == telemetry_range::kEditUsed);

bool is_valid(const range_configuration& c) {
  return messaging::is_positive(c.noise_sigma_m, 1e3) && messaging::is_between(c.bias_sigma_m, 0.0, 1e3);
}

bool RangeSource::configure(const Configuration& configuration) {
  const auto* ranges = configuration.telecommands.in_force<range_configuration>();
  if (ranges == nullptr) return false;
  aiding_.configure({.noise_sigma_m = ranges->noise_sigma_m, .bias_sigma_m = ranges->bias_sigma_m});
  return true;
}

void RangeSource::collect(Context& context, RecordFiler records) {
  processed_.reset();
  const auto& packets = context.inbox.queue<range_measurement>();
  for (std::size_t k = 0; k < packets.size(); ++k) {
    const GpsTime time = packets[k].tag.time;
    const double range_m = packets[k].value.range_m;
    if (!(range_m > 0.0)) {
      context.inbox.count_bad_content();
    } else if (time > context.now || context.now - time > kLongestDelay ||
               records.file(time, next_number_) != Status::kOk) {
      context.inbox.count_unusable_time();
    } else {
      ranges_m_[next_number_ % kMaxWaiting] = range_m;
      ++next_number_;
    }
  }
}

void RangeSource::process_record(const Record& record, Context& /*context*/, filter::RelativeNavigationFilter& filter) {
  processed_ = record.time;
  range_m_ = ranges_m_[record.number % kMaxWaiting];
  edit_status_ = aiding_.process(range_m_, filter);
}

void RangeSource::report(const Telemetry& telemetry) const {
  if (!processed_) return;
  telemetry_range message{};
  message.step = telemetry.step;
  message.range_m = range_m_;
  message.fate = static_cast<std::int8_t>(edit_status_);
  message.prefit_m = aiding_.prefit_m();
  message.nis = aiding_.nis();
  message.bias_m = telemetry.filter.estimate().mean(kBias);
  message.bias_sigma_m = math::sqrt(telemetry.filter.estimate().variance(kBias));
  message.used = aiding_.counters().used;
  message.refused = aiding_.counters().rejected;
  telemetry.outbox.send(*processed_, message);
}

}  // namespace vbar::fsw::measurements
