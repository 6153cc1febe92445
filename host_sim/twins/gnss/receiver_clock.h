#pragma once
// The receiver's clock: a two-state crystal oscillator, reset by integer milliseconds when its offset grows.

#include <string_view>

#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/gnss/gnss_settings.h"

namespace vbar::twins::gnss {

/// Time by the oscillator alone.
class CrystalOscillator {
 public:
  /// Draws from the stream `stream` of `seed`, initial offset and drift too.
  CrystalOscillator(const ClockSettings& settings, std::uint64_t seed, std::string_view stream);

  /// Lets `elapsed_s` >= 0 pass: white and random-walk frequency noise with the covariance of the two-state model
  /// (van Dierendonck, McGraw, Brown 1984): S_f t + S_g t^3/3, S_g t^2/2, S_g t; S_f = h0/2, S_g = 2 pi^2 h_-2.
  void advance(double elapsed_s);
  /// Sets the time by `step_s`.
  void shift(double step_s) { offset_s_ += step_s; }

  [[nodiscard]] double offset_s() const { return offset_s_; }  ///< clock minus GPS time
  [[nodiscard]] double drift() const { return drift_; }        ///< s/s

 private:
  double white_variance_rate_;        ///< S_f
  double random_walk_variance_rate_;  ///< S_g
  engine::RandomStream stream_;
  double offset_s_;
  double drift_;
};

class ReceiverClock {
 public:
  /// Draws from the stream "gnss/<receiver>/clock" of `seed`.
  ReceiverClock(const ClockSettings& settings, std::uint64_t seed, std::string_view receiver);

  /// Lets `elapsed_s` >= 0 pass for the oscillator, then resets the clock where its offset is beyond the threshold.
  void advance(double elapsed_s);
  /// Sets the clock by `step_s`, which does not count as a reset.
  void shift(double step_s) { oscillator_.shift(step_s); }

  [[nodiscard]] double offset_s() const { return oscillator_.offset_s(); }  ///< clock minus GPS time
  [[nodiscard]] double drift() const { return oscillator_.drift(); }        ///< s/s
  [[nodiscard]] int jumps() const { return jumps_; }                        ///< number of resets

 private:
  double jump_threshold_s_;
  CrystalOscillator oscillator_;
  int jumps_ = 0;
};

}  // namespace vbar::twins::gnss
