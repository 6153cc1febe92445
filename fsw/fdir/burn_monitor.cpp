#include "fsw/fdir/burn_monitor.h"

#include "fsw/math/math.h"
#include "fsw/messaging/message_fields.h"

namespace vbar::fsw::fdir {
namespace {

// A burn differs from its command if the difference exceeds this share of its size (five sigma of a thruster) and five
// sigma of the constant error of an impulse, which dominates burns of micrometres per second. Both errors are
// independent, so that one burn decides.
constexpr double kUsualShare = 0.05;
constexpr double kImpulseSigma = 2e-6;  // m/s
constexpr double kUsualImpulse = 5.0 * kImpulseSigma;
// Where single burns are too small, the scale decides: it differs if it errs by the same share and by this multiple of
// its sigma.
constexpr double kScaleSigmas = 4.0;
constexpr double kJumpSigmas = 5.0;    // difference of a ratio from the estimate beyond which the scale has jumped
constexpr double kNothing = 0.1;       // share of the size below which a burn counts as missed
constexpr double kImplausible = 10.0;  // share of the size beyond which a report does not measure the thruster
constexpr Duration kOnTime = duration_of_seconds(1);
constexpr Duration kLatestReport = duration_of_seconds(300);

// Errors in the estimate of the scale: 1 sigma of one report, and of the drift from burn to burn.
constexpr double kRatioSigma = 0.01;
constexpr double kScaleDrift = 0.002;

double square(double x) {
  return x * x;
}

/// Returns the variance of the ratio of a burn of `dv` m/s.
double ratio_variance(double dv) {
  return square(kRatioSigma) + square(kImpulseSigma / dv);
}

/// Returns whether a burn of this size shows a scale that errs by twice the default share.
bool shows_scale(double dv) {
  return square(kScaleSigmas) * ratio_variance(dv) < square(2.0 * kUsualShare);
}

}  // namespace

void BurnScale::update(double ratio, double dv) {
  const double noise = ratio_variance(dv);
  const double drifted = square(sigma_) + square(kScaleDrift);
  const bool has_jumped = square(ratio - scale_) > square(kJumpSigmas) * (drifted + noise);
  const double prior = has_jumped ? square(kInitialSigma) : drifted;
  const double gain = prior / (prior + noise);
  scale_ += gain * (ratio - scale_);
  sigma_ = math::sqrt((1.0 - gain) * prior);
}

bool BurnScale::differs(double share, double sigmas) const {
  const double off = math::abs(scale_ - 1.0);
  return off > share && off > sigmas * sigma_;
}

void BurnMonitor::expect(std::int32_t maneuver_id, GpsTime time, const Vector3& dv_rtn, GpsTime end) {
  if (count_ == kMaxCommanded) forget(0);
  commanded_[count_++] = {maneuver_id, time, dv_rtn, end};
}

void BurnMonitor::forget(std::size_t k) {
  for (std::size_t j = k + 1; j < count_; ++j) commanded_[j - 1] = commanded_[j];
  --count_;
}

void BurnMonitor::update(GpsTime now, const messaging::Inbox& inbox, faults::FaultMonitor& faults) {
  const auto& reports = inbox.queue<executed_maneuver>();
  bool is_any_uncommanded = false;
  double uncommanded = 0.0;
  for (std::size_t r = 0; r < reports.size(); ++r) {
    const executed_maneuver& report = reports[r].value;
    std::size_t k = 0;
    while (k < count_ && commanded_[k].id != report.maneuver_id) ++k;
    if (k < count_) {
      judge(commanded_[k], reports[r].tag.time, report, now, faults);
      forget(k);
    } else if (report.accepted != 0 && report.maneuver_id >= 0) {
      is_any_uncommanded = true;
      uncommanded += math::sqrt(messaging::vector(report.dv_rtn).squaredNorm());
    }
  }
  faults.check(
      now,
      {.fault = telemetry_health::kFaultBurnUncommanded, .is_detected = is_any_uncommanded, .argument = uncommanded});
  for (std::size_t k = count_; k-- > 0;) {
    if (now - commanded_[k].end <= kLatestReport) continue;
    faults.check(now, {.fault = telemetry_health::kFaultBurnMissed,
                       .is_detected = true,
                       .argument = static_cast<double>(commanded_[k].id)});
    faults.check(now, {.fault = telemetry_health::kFaultThruster, .is_detected = true, .argument = scale_.scale()});
    forget(k);
  }
}

void BurnMonitor::judge(const Commanded& commanded, GpsTime time, const executed_maneuver& report, GpsTime now,
                        faults::FaultMonitor& faults) {
  const double size = math::sqrt(commanded.dv_rtn.squaredNorm());
  const Vector3 executed = messaging::vector(report.dv_rtn);
  const double ratio = size > 0.0 ? executed.dot(commanded.dv_rtn) / (size * size) : 1.0;
  const double difference = math::sqrt((executed - commanded.dv_rtn).squaredNorm());
  const double delay_s = seconds(time - commanded.time);
  const auto id = static_cast<double>(commanded.id);

  const bool is_refused = report.accepted == 0;
  const bool is_missed = !is_refused && ratio < kNothing;
  const bool is_executed = !is_refused && !is_missed;
  const bool is_late = is_executed && math::abs(delay_s) > seconds(kOnTime);
  // A report of another order of magnitude is a fault, not a scale.
  if (is_executed && size > kUsualImpulse && ratio < kImplausible) scale_.update(ratio, size);
  const bool is_of_other_size = is_executed && (difference > math::hypot(kUsualShare * size, kUsualImpulse) ||
                                                scale_.differs(kUsualShare, kScaleSigmas));
  faults.check(now, {.fault = telemetry_health::kFaultBurnRefused, .is_detected = is_refused, .argument = id});
  faults.check(now, {.fault = telemetry_health::kFaultBurnMissed, .is_detected = is_missed, .argument = id});
  faults.check(now, {.fault = telemetry_health::kFaultBurnLate, .is_detected = is_late, .argument = delay_s});
  if (is_of_other_size || shows_scale(size)) {
    faults.check(now, {.fault = telemetry_health::kFaultBurnSize, .is_detected = is_of_other_size, .argument = ratio});
  }
  // A rejection shows that the command was late, not that the thruster failed.
  if (!is_refused) {
    faults.check(now, {.fault = telemetry_health::kFaultThruster, .is_detected = is_missed, .argument = ratio});
  }
  if (is_executed) ++executed_;
}

}  // namespace vbar::fsw::fdir
