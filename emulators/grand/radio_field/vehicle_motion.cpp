#include "emulators/grand/radio_field/vehicle_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "hil_drivers/grand/trajectory/antenna_attitude.h"

namespace vbar::grand::bench {
namespace {

using fsw::Duration;
using fsw::Vector3;

/// Returns the span between two times since the start.
constexpr Duration span(Duration from, Duration to) {
  return {to.ns - from.ns};
}

constexpr double kMinRadius_m = 6.2e6;
constexpr double kMaxRadius_m = 5.0e7;
// More samples than a lead of 10 s at 1 kHz has are a flood.
constexpr std::size_t kMaxPending = 10'000;
constexpr std::size_t kArrivals = 256;

bool is_usable(const TrajectorySample& sample) {
  const bool finite = sample.position_ecef_m.allFinite() && sample.velocity_ecef_mps.allFinite() &&
                      sample.acceleration_ecef_mps2.allFinite() && sample.jerk_ecef_mps3.allFinite() &&
                      sample.yaw_pitch_roll.allFinite() && sample.angular_rate.allFinite() &&
                      sample.angular_acceleration.allFinite();
  const double radius_m = sample.position_ecef_m.norm();
  return finite && sample.time.ns >= 0 && radius_m >= kMinRadius_m && radius_m <= kMaxRadius_m;
}

}  // namespace

Reception VehicleMotion::receive(const TrajectorySample& sample) {
  ++counters_.samples;
  const Duration lead = span(now_, sample.time);
  if (!is_usable(sample) || lead > kMaxLead || pending_.size() >= kMaxPending) {
    ++counters_.rejected;
    return Reception::kRejected;
  }
  if (std::ranges::find(arrived_, sample.time) != arrived_.end()) {
    ++counters_.doubled;
    return Reception::kDoubled;
  }
  count_arrival(sample.time);
  const Duration from = std::max(sample.time, computed());
  const auto replaces = [&](const Pending& pending) {
    return pending.from <= from && pending.sample.time > sample.time;
  };
  if ((current_ && sample.time < current_->time) || std::ranges::any_of(pending_, replaces)) {
    ++counters_.out_of_order;
    return Reception::kOutOfOrder;
  }
  const bool late = is_late(sample);
  if (late) ++counters_.late;
  newest_ = std::max(newest_, sample.time);
  if (from > now_) {
    const auto place = std::ranges::upper_bound(pending_, from, {}, &Pending::from);
    pending_.insert(place, {sample, from});
    if (!current_) use(sample);  // nothing older exists: the first sample holds backwards too
  } else {
    use(sample);
  }
  return late ? Reception::kLate : Reception::kAccepted;
}

void VehicleMotion::count_arrival(Duration time) {
  const double lead_s = seconds(span(now_, time));
  counters_.lead_min_s = arrived_.empty() ? lead_s : std::min(counters_.lead_min_s, lead_s);
  counters_.lead_sum_s += lead_s;
  if (!arrived_.empty() && time > newest_) {
    const Duration gap = span(newest_, time);
    if (period_) counters_.missing += static_cast<std::uint64_t>((gap.ns + period_->ns / 2) / period_->ns - 1);
    period_ = std::min(period_.value_or(gap), gap);
  } else if (counters_.missing > 0) {
    --counters_.missing;
  }
  arrived_.push_back(time);
  if (arrived_.size() > kArrivals) arrived_.pop_front();
}

bool VehicleMotion::is_late(const TrajectorySample& sample) const {
  return current_ && span(sample.time, computed()) > span(period_.value_or(Duration{}), join_);
}

void VehicleMotion::advance(Duration time) {
  std::size_t used = 0;
  while (used < pending_.size() && pending_[used].from < time) {
    now_ = std::max(now_, pending_[used].from);
    use(pending_[used++].sample);
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(used));
  now_ = std::max(now_, time);
}

Duration VehicleMotion::age() const {
  const Duration age = span(newest_, now_);
  return std::max(age, Duration{});
}

MotionState VehicleMotion::at(Duration time) const {
  MotionState state = extrapolated(*current_, time);
  if (time < joined_.begin || time >= joined_.end) return state;
  const double s = seconds(span(joined_.begin, time));
  const auto& c = joined_.coefficients;
  state.position += c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))));
  state.velocity += c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * (4.0 * c[4] + s * 5.0 * c[5])));
  state.acceleration += 2.0 * c[2] + s * (6.0 * c[3] + s * (12.0 * c[4] + s * 20.0 * c[5]));
  return state;
}

TrajectorySample VehicleMotion::flown(Duration time) const {
  TrajectorySample sample;
  sample.time = time;
  if (!current_) return sample;
  const MotionState state = at(time);
  sample = *current_;
  sample.time = time;
  sample.position_ecef_m = state.position;
  sample.velocity_ecef_mps = state.velocity;
  sample.acceleration_ecef_mps2 = state.acceleration;
  return sample;
}

Vector3 VehicleMotion::boresight_ecef(Duration time) const {
  const double s = seconds(span(current_->time, time));
  const Vector3 rotation = s * (current_->angular_rate + 0.5 * s * current_->angular_acceleration);
  const double angle = rotation.norm();
  Vector3 boresight = -Vector3::UnitZ();
  if (angle > 0.0) boresight = Eigen::AngleAxisd(angle, rotation / angle) * boresight;
  const LocalFrame local = local_frame(at(time).position, Vector3::Zero(), Vector3::Zero());
  return local.R_ned_ecef.transpose() * (R_ned_antenna(current_->yaw_pitch_roll) * boresight);
}

bool VehicleMotion::take_snap() {
  return std::exchange(snapped_, false);
}

void VehicleMotion::use(const TrajectorySample& sample) {
  if (current_ && current_->time >= sample.time) return;
  if (!current_) {
    joined_ = {};
  } else {
    const MotionState old_state = at(now_);
    const MotionState new_state = extrapolated(sample, now_);
    const MotionState difference{old_state.position - new_state.position, old_state.velocity - new_state.velocity,
                                 old_state.acceleration - new_state.acceleration};
    if (difference.position.norm() > kSnapDistance_m) {
      joined_ = {};
      snapped_ = true;
      ++counters_.snaps;
    } else {
      joined_ = join_of(difference, now_, join_);
    }
  }
  current_ = sample;
}

MotionState VehicleMotion::extrapolated(const TrajectorySample& sample, Duration time) {
  const double s = seconds(span(sample.time, time));
  const Vector3& v = sample.velocity_ecef_mps;
  const Vector3& a = sample.acceleration_ecef_mps2;
  const Vector3& j = sample.jerk_ecef_mps3;
  return {sample.position_ecef_m + s * (v + s * (0.5 * a + s / 6.0 * j)), v + s * (a + 0.5 * s * j), a + s * j};
}

VehicleMotion::Join VehicleMotion::join_of(const MotionState& difference, Duration begin, Duration length) {
  Join join{begin, begin + length, {}};
  const double h = seconds(length);
  if (!(h > 0.0)) return join;
  // p(0), p'(0), p''(0) given; p, p', p'' zero at h.
  const Vector3& p = difference.position;
  const Vector3 v = h * difference.velocity;
  const Vector3 a = h * h * difference.acceleration;
  join.coefficients = {p,
                       v / h,
                       0.5 * a / (h * h),
                       (-10.0 * p - 6.0 * v - 1.5 * a) / (h * h * h),
                       (15.0 * p + 8.0 * v + 1.5 * a) / (h * h * h * h),
                       (-6.0 * p - 3.0 * v - 0.5 * a) / (h * h * h * h * h)};
  return join;
}

}  // namespace vbar::grand::bench
