#include "host_sim/twins/gnss/receiver_clock.h"

#include <cmath>
#include <numbers>
#include <string>

namespace vbar::twins::gnss {

CrystalOscillator::CrystalOscillator(const ClockSettings& settings, std::uint64_t seed, std::string_view stream)
    : white_variance_rate_(settings.h0_s / 2.0),
      random_walk_variance_rate_(2.0 * std::numbers::pi * std::numbers::pi * settings.h_minus2_per_s),
      stream_(seed, stream),
      offset_s_(stream_.uniform(-1.0, 1.0) * settings.initial_offset_ms * 1e-3),
      drift_(stream_.normal() * settings.initial_drift_sigma_ns_per_s * 1e-9) {}

void CrystalOscillator::advance(double elapsed_s) {
  const double s_f = white_variance_rate_;
  const double s_g = random_walk_variance_rate_;
  // The offset's S_g t^3/3 consists of t^3/4, which goes along with the drift's step (half of that step times t), and
  // of its own t^3/12.
  const double drift_step = stream_.normal() * std::sqrt(s_g * elapsed_s);
  const double rest_variance = s_f * elapsed_s + s_g * elapsed_s * elapsed_s * elapsed_s / 12.0;
  offset_s_ += (drift_ + drift_step / 2.0) * elapsed_s + stream_.normal() * std::sqrt(rest_variance);
  drift_ += drift_step;
}

ReceiverClock::ReceiverClock(const ClockSettings& settings, std::uint64_t seed, std::string_view receiver)
    : jump_threshold_s_(settings.jump_threshold_ms * 1e-3),
      oscillator_(settings, seed, "gnss/" + std::string(receiver) + "/clock") {}

void ReceiverClock::advance(double elapsed_s) {
  oscillator_.advance(elapsed_s);
  const double offset_s = oscillator_.offset_s();
  if (std::abs(offset_s) <= jump_threshold_s_) return;
  oscillator_.shift(-std::round(offset_s * 1e3) * 1e-3);
  ++jumps_;
}

}  // namespace vbar::twins::gnss
