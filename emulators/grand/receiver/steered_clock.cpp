#include "emulators/grand/receiver/steered_clock.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace vbar::grand::bench {
namespace {

using fsw::gnss::kSpeedOfLight;

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr std::int64_t kUpdate_ns = 10'000'000;
constexpr double kSettingFrequency_hz = 2.046e6;
constexpr double kMaxSlew_per_s = 10e-9;  ///< rate of the steered frequency: 3 m/s^2 to the carrier loops
constexpr double kMaxSteering = 10e-6;
constexpr double kDriftToSet = 2e-9;        ///< the frequency is steered to this before the fine setting
constexpr int kSecondsToSet = 60;           ///< or this time is waited
constexpr double kApproachTime_s = 10.0;    ///< the offset left by the setting is brought in with this time constant
constexpr double kMaxApproach = 30e-9;      ///< and at most at this rate
constexpr double kSteeringBound_s = 30e-9;  ///< within it the loop is closed
constexpr double kFrequencyGain = 0.3;      ///< gain of the measured drift, per second
constexpr double kLostBound_s = 100e-9;     ///< beyond it, it is opened again
constexpr double kResetBound_s = 1e-6;      ///< beyond it the reading is set again
constexpr int kSecondsToFineSteering = 5;
constexpr int kSecondsToFreewheeling = 5;

}  // namespace

SteeredClock::SteeredClock(const twins::gnss::ClockSettings& settings, double steering_bandwidth_hz, std::uint64_t seed,
                           std::string_view vehicle)
    : oscillator_(settings, seed, "grand/receiver/" + std::string(vehicle) + "/clock"),
      jump_threshold_s_(settings.jump_threshold_ms * 1e-3) {
  // Noise bandwidth of a second-order loop with damping 0.707: 0.53 w (Kaplan, Hegarty 2017, table 8.23).
  const double w = steering_bandwidth_hz / 0.53;
  proportional_gain_ = std::numbers::sqrt2 * w;
}

void SteeredClock::restart() {
  status_ = TimeStatus::kUnknown;
  reading_pending_ = true;
  pending_reading_ = {};
  steering_target_ = frequency_ = 0.0;
  loop_closed_ = false;
  seconds_within_ = seconds_without_solution_ = seconds_to_set_ = 0;
}

void SteeredClock::set_approximate(fsw::GpsTime reading) {
  if (is_set()) return;
  status_ = TimeStatus::kApproximate;
  reading_pending_ = true;
  pending_reading_ = reading;
}

void SteeredClock::advance(fsw::GpsTime begin) {
  begin_ = begin;
  if (reading_pending_) {
    setting_ms_ = (pending_reading_ - begin).ns / kMillisecond_ns;
    setting_steps_ = 0;
    reading_pending_ = false;
  }
  for (double& offset_m : oscillator_m_) {
    offset_m = kSpeedOfLight * (oscillator_.offset_s() + steered_s_);
    oscillator_.advance(kUpdate_s);
    const double step =
        std::clamp(steering_target_ - steering_rate_, -kMaxSlew_per_s * kUpdate_s, kMaxSlew_per_s * kUpdate_s);
    steering_rate_ += step;
    steered_s_ += (steering_rate_ - step / 2.0) * kUpdate_s;
  }
  find_epochs();
}

double SteeredClock::oscillator_rate_mps() const {
  return kSpeedOfLight * (oscillator_.drift() + steering_rate_);
}

void SteeredClock::find_epochs() {
  const double fine_s = static_cast<double>(setting_steps_) / kSettingFrequency_hz;
  for (std::size_t k = 0; k < kUpdatesPerBlock; ++k) {
    // Whole nanoseconds apart from the small rest: a reading as one double would lose its last digits.
    const double rest_s = fine_s + oscillator_m_[k] / kSpeedOfLight;
    const std::int64_t whole_ns =
        (begin_ + fsw::Duration{static_cast<std::int64_t>(k) * kUpdate_ns}).ns + setting_ms_ * kMillisecond_ns;
    const double reading_updates = rest_s / kUpdate_s + static_cast<double>(whole_ns % kUpdate_ns) / kUpdate_ns;
    const double nearest = std::nearbyint(reading_updates);
    epochs_[k] = {whole_ns / kUpdate_ns + static_cast<std::int64_t>(nearest), (nearest - reading_updates) * kUpdate_s};
  }
}

fsw::GpsTime SteeredClock::reading_at_end() const {
  const double rest_s =
      static_cast<double>(setting_steps_) / kSettingFrequency_hz + oscillator_m_.back() / kSpeedOfLight;
  const std::int64_t ns =
      (begin_ + RfBlock::kLength).ns + setting_ms_ * kMillisecond_ns + fsw::nearest_duration(rest_s).ns;
  return fsw::GpsTime{std::max<std::int64_t>(ns, 0) / kMillisecond_ns * kMillisecond_ns};
}

double SteeredClock::setting_m() const {
  return kSpeedOfLight *
         (static_cast<double>(setting_ms_) * 1e-3 + static_cast<double>(setting_steps_) / kSettingFrequency_hz);
}

double SteeredClock::setting_cycles(double frequency_hz) const {
  return static_cast<double>(setting_ms_) * std::nearbyint(frequency_hz * 1e-3) +
         static_cast<double>(setting_steps_) * std::nearbyint(frequency_hz / kSettingFrequency_hz);
}

double SteeredClock::true_offset_s() const {
  return is_set() ? (oscillator_m_.front() + setting_m()) / kSpeedOfLight : 0.0;
}

void SteeredClock::set_coarse(double travel_s, double assumed_travel_s) {
  if (is_set()) return;
  setting_ms_ = static_cast<std::int64_t>(std::nearbyint((assumed_travel_s - travel_s) * 1e3));
  setting_steps_ = 0;
  reading_pending_ = false;
  status_ = steering_enabled_ ? TimeStatus::kCoarseSteering : TimeStatus::kCoarse;
}

void SteeredClock::set_by_milliseconds(double offset_s) {
  setting_ms_ -= static_cast<std::int64_t>(std::nearbyint(offset_s * 1e3));
}

void SteeredClock::set_by_steps(double offset_s) {
  setting_steps_ -= static_cast<std::int64_t>(std::nearbyint(offset_s * kSettingFrequency_hz));
}

void SteeredClock::take_solution(double offset_s, double drift) {
  if (!is_set()) return;
  seconds_without_solution_ = 0;
  if (status_ < TimeStatus::kFreewheeling) {
    take_first_solutions(offset_s, drift);
    return;
  }
  if (steering_enabled_) {
    steer(offset_s, drift);
  } else {
    if (std::abs(offset_s) > jump_threshold_s_) set_by_milliseconds(offset_s);
    loop_closed_ = false;
    seconds_within_ = 0;
  }
  status_ = seconds_within_ >= kSecondsToFineSteering ? TimeStatus::kFineSteering : TimeStatus::kFine;
}

// From coarse to fine: first the frequency, then the setting, which the frequency would carry away.
void SteeredClock::take_first_solutions(double offset_s, double drift) {
  if (steering_enabled_) {
    frequency_ = steering_target_ = std::clamp(steering_rate_ - drift, -kMaxSteering, kMaxSteering);
    if (std::abs(drift) > kDriftToSet && ++seconds_to_set_ < kSecondsToSet) return;
    set_by_steps(offset_s);
  } else {
    set_by_milliseconds(offset_s);
  }
  seconds_to_set_ = 0;
  status_ = TimeStatus::kFine;
}

void SteeredClock::steer(double offset_s, double drift) {
  const double magnitude_s = std::abs(offset_s);
  if (magnitude_s > kResetBound_s) set_by_steps(offset_s);
  if (magnitude_s < kSteeringBound_s) loop_closed_ = true;
  if (magnitude_s > kLostBound_s) loop_closed_ = false;
  const double cancelling = std::clamp(steering_rate_ - drift, -kMaxSteering, kMaxSteering);
  if (loop_closed_) {
    frequency_ += kFrequencyGain * (cancelling - frequency_);
    steering_target_ = frequency_ - proportional_gain_ * offset_s;
    ++seconds_within_;
    return;
  }
  seconds_within_ = 0;
  frequency_ = cancelling;
  steering_target_ = frequency_ - std::clamp(offset_s / kApproachTime_s, -kMaxApproach, kMaxApproach);
}

void SteeredClock::take_no_solution() {
  if (status_ < TimeStatus::kFreewheeling) return;
  steering_target_ = frequency_;
  seconds_within_ = 0;
  if (++seconds_without_solution_ >= kSecondsToFreewheeling) status_ = TimeStatus::kFreewheeling;
}

}  // namespace vbar::grand::bench
