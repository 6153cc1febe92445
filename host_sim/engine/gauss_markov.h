#pragma once
// A stationary first-order Gauss-Markov process, sampled at arbitrary increasing times by its exact transition:
//   x(t + dt) = e x(t) + sigma sqrt(1 - e^2) n,  e = exp(-dt / T)
// with standard normal n; its autocorrelation is sigma^2 exp(-|dt| / T) (Gelb 1974, Applied Optimal Estimation, 3.8).

#include <optional>

#include "fsw/core/gps_time.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::engine {

class GaussMarkov {
 public:
  /// `sigma`: standard deviation, in the unit of the value, 0: the value is always 0; `time_s`: correlation time, above
  /// 0; `stream`: each new time draws one number of it.
  GaussMarkov(double sigma, double time_s, const RandomStream& stream)
      : sigma_(sigma), time_s_(time_s), stream_(stream) {}

  /// The value at `time`; the first one is drawn from the stationary distribution. A time that is not later than the
  /// last repeats its value.
  double at(fsw::GpsTime time);

 private:
  double sigma_;
  double time_s_;
  RandomStream stream_;
  std::optional<fsw::GpsTime> last_;
  double value_ = 0.0;
};

}  // namespace vbar::engine
