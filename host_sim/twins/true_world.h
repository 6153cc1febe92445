#pragma once
// The true world as a run moves it: time goes on, one spacecraft flies.

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins {

class TrueWorld {
 public:
  TrueWorld() = default;
  TrueWorld(const TrueWorld&) = delete;
  TrueWorld& operator=(const TrueWorld&) = delete;
  virtual ~TrueWorld() = default;

  /// Advances the world, not back in time.
  virtual void advance_to(fsw::GpsTime time) = 0;
  /// Returns the truth at the current time.
  [[nodiscard]] virtual TruthSnapshot snapshot(TruthDetail detail) = 0;

  // The spacecraft that flies.
  /// Adds a velocity, m/s in its own RTN, at the current time.
  virtual void apply_impulse_rtn(const fsw::Vector3& dv_rtn) = 0;
  /// Points it to a direction in its own RTN, a unit vector and its rate (1/s) at `time`, if its attitude is commanded.
  virtual void point(fsw::GpsTime time, const fsw::Vector3& boresight_rtn, const fsw::Vector3& boresight_rate_rtn) = 0;

  /// Returns the wall-clock time spent in it so far, s.
  [[nodiscard]] virtual double wall_s() const = 0;
};

}  // namespace vbar::twins
