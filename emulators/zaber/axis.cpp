#include "emulators/zaber/axis.h"

#include <algorithm>
#include <cmath>

namespace vbar::zaber {

Axis::Axis(const AxisSettings& settings, engine::RandomStream places)
    : settings_(settings),
      places_(places),
      count_to_carriage_um_(settings.start_um),
      speed_um_s_(settings.speed_um_s),
      limit_max_(static_cast<std::int64_t>(settings.travel_um / settings.microstep_um)) {}

void Axis::begin(std::int64_t target, double speed_um_s, bool is_homing, double now_s) {
  advance(now_s);
  was_interrupted_ = was_interrupted_ || move_.has_value();
  const double distance_um = settings_.microstep_um * static_cast<double>(std::abs(target - count_));
  const double duration_s = settings_.moves_at_once ? 0.0 : distance_um / std::max(1.0, std::abs(speed_um_s));
  move_ = Move{target, now_s, now_s + duration_s, count_, is_homing, is_blocked_};
}

void Axis::home(double now_s) {
  const double to_sensor =
      (count_to_carriage_um_ + settings_.microstep_um * static_cast<double>(count_)) / settings_.microstep_um;
  begin(count_ - static_cast<std::int64_t>(std::lround(to_sensor)), speed_um_s_, true, now_s);
}

bool Axis::move_to(std::int64_t microsteps, double now_s) {
  if (microsteps < limit_min_ || microsteps > limit_max_) return false;
  begin(microsteps, speed_um_s_, false, now_s);
  return true;
}

void Axis::move_at(double microsteps_per_s, double now_s) {
  if (microsteps_per_s == 0.0) return stop(now_s);
  begin(microsteps_per_s > 0.0 ? limit_max_ : limit_min_, microsteps_per_s * settings_.microstep_um, false, now_s);
}

void Axis::stop(double now_s) {
  advance(now_s);
  if (!move_) return;
  const std::int64_t from = move_->begin_count;
  move_.reset();
  settle(from, count_);
  was_interrupted_ = true;
}

void Axis::advance(double now_s) {
  if (!move_) return;
  if (now_s >= move_->end_s) {
    const Move done = *move_;
    move_.reset();
    return arrive(done);
  }
  const double share = (now_s - move_->begin_s) / (move_->end_s - move_->begin_s);
  const auto way = static_cast<double>(move_->target - move_->begin_count);
  if (move_->stalls && share > 0.5) {
    const Move done = *move_;
    move_.reset();
    return arrive(done);
  }
  count_ = move_->begin_count + static_cast<std::int64_t>(std::lround(share * way));
}

void Axis::arrive(const Move& move) {
  if (move.stalls) {
    const std::int64_t reached = move.begin_count + (move.target - move.begin_count) / 2;
    settle(move.begin_count, reached);
    count_ = reached;
    has_stalled_ = true;
    ++stalls_;
    return;
  }
  settle(move.begin_count, move.target);
  count_ = move.target;
  if (!move.is_homing) return;
  // The sensor is the origin of the count, within the repeatability; the last approach is from above and then from
  // below.
  count_ = 0;
  count_to_carriage_um_ = 0.0;
  lag_um_ = 0.0;
  is_homed_ = true;
  was_interrupted_ = false;
}

/// Where the carriage comes to stand after a motion of the screw.
void Axis::settle(std::int64_t from, std::int64_t to) {
  if (from == to) return;
  lag_um_ = to < from ? settings_.backlash_um : 0.0;
  scatter_um_ = settings_.repeatability_um * places_.normal();
}

void Axis::set_count(std::int64_t microsteps) {
  count_to_carriage_um_ += settings_.microstep_um * static_cast<double>(count_ - microsteps);
  count_ = microsteps;
}

void Axis::set_limits(std::int64_t min, std::int64_t max) {
  limit_min_ = min;
  limit_max_ = max;
}

std::string Axis::warning() const {
  if (has_stalled_) return "FS";
  if (!is_homed_) return "WR";
  if (was_displaced_) return "WM";
  if (was_interrupted_) return "NI";
  return "--";
}

void Axis::clear_warnings() {
  has_stalled_ = false;
  was_displaced_ = false;
  was_interrupted_ = false;
}

double Axis::carriage_um() const {
  return count_to_carriage_um_ + settings_.microstep_um * static_cast<double>(count_) + lag_um_ + scatter_um_;
}

void Axis::displace(double um) {
  count_ += static_cast<std::int64_t>(std::lround(um / settings_.microstep_um));
  was_displaced_ = true;
}

}  // namespace vbar::zaber
