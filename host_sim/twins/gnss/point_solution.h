#pragma once
// The receiver's clock: a two-state crystal oscillator, reset by integer milliseconds when its offset grows.

#include <optional>
#include <string_view>
#include <vector>

#include "fsw/core/types.h"
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

// The receiver's own position, velocity and time, as in BESTXYZ and TIME: least squares of the GPS L1 code and
// Doppler with the broadcast satellites. Instead of an iteration it is solved once, linearised about the truth, which
// is the same to second order (errors of metres over ranges of 20,000 km).

/// One satellite: observed minus predicted at the true antenna, receiver clock included.
struct PointResidual {
  fsw::Vector3 line_of_sight = fsw::Vector3::Zero();  ///< antenna to satellite
  double code_m = 0.0;
  double range_rate_mps = 0.0;
  double code_sigma_m = 1.0;
};

struct PointSolution {
  std::size_t satellites = 0;
  fsw::Vector3 position_error_ecef = fsw::Vector3::Zero();  ///< solution minus truth, m
  fsw::Vector3 velocity_error_ecef = fsw::Vector3::Zero();  ///< m/s
  fsw::Vector3 position_sigma = fsw::Vector3::Zero();       ///< as the receiver states them
  fsw::Vector3 velocity_sigma = fsw::Vector3::Zero();
  double clock_offset_s = 0.0;  ///< estimated
  double clock_sigma_s = 0.0;
  double clock_drift = 0.0;  ///< estimated, s/s
};

/// Solves for position, velocity and clock; none with fewer than four satellites or a singular geometry.
std::optional<PointSolution> solve_point(const std::vector<PointResidual>& residuals);

}  // namespace vbar::twins::gnss
