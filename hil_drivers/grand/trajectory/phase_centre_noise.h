#pragma once
// Noise of the antenna's phase centre (Appendix A of the paper: 1 mm on each axis at each epoch of the receiver) as a
// smooth motion: between the values of two epochs the phase centre moves along a quintic with zero velocity and
// acceleration at both ends. A step would be a step of every carrier phase.

#include <array>
#include <cstdint>
#include <string_view>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::grand {

/// Epochs of a receiver: GPS time `offset` after every multiple of `period` (LOG ... ONTIME 10 9).
struct ReceiverEpochs {
  fsw::Duration period = fsw::duration_of_seconds(10);
  fsw::Duration offset = fsw::duration_of_seconds(9);
};

class PhaseCentreNoise {
 public:
  /// Draws from the stream "gnss/<spacecraft>/antenna_noise" of `seed`; the value of an epoch depends on its time only.
  /// Throws std::invalid_argument for a period that is not positive.
  PhaseCentreNoise(double sigma_m, const ReceiverEpochs& epochs, std::uint64_t seed, std::string_view spacecraft);

  /// Returns the displacement in body axes, m, and its three derivatives with respect to time.
  std::array<fsw::Vector3, 4> at(fsw::GpsTime time);

 private:
  [[nodiscard]] fsw::Vector3 value_of(std::int64_t epoch);

  double sigma_m_;
  ReceiverEpochs epochs_;
  engine::RandomStream stream_;
  // Values at both ends of the interval that begins with epoch_: a cache.
  std::int64_t epoch_ = INT64_MIN;
  std::array<fsw::Vector3, 2> ends_{};
};

}  // namespace vbar::grand
