#include "host_sim/engine/gauss_markov.h"

#include <cmath>

namespace vbar::engine {

double GaussMarkov::at(fsw::GpsTime time) {
  if (sigma_ == 0.0 || (last_ && time <= *last_)) return value_;
  const double dt_over_time = last_ ? seconds(time - *last_) / time_s_ : INFINITY;
  const double decay = std::exp(-dt_over_time);
  // 1 - e^2 without cancellation where dt is short.
  value_ = decay * value_ + sigma_ * std::sqrt(-std::expm1(-2.0 * dt_over_time)) * stream_.normal();
  last_ = time;
  return value_;
}

}  // namespace vbar::engine
