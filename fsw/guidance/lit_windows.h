#pragma once
// Times at which a camera observes the effect of a burn: in sunlight, from the first images after dawn until shortly
// before dusk.

#include "fsw/control/plan.h"
#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::guidance {

class LitWindows {
 public:
  /// `servicer_mean` holds at `epoch`. The windows are valid for the horizon of a plan: the direction of the Sun is
  /// that of the epoch.
  LitWindows(GpsTime epoch, const orbit::QnsElements& servicer_mean);

  [[nodiscard]] bool allows(GpsTime time) const;

  /// Returns the windows for a solver. This object must outlive them.
  [[nodiscard]] control::ThrustWindows thrust_windows() const;

  static constexpr Duration kAfterDawn = duration_of_seconds(120);
  static constexpr Duration kBeforeDusk = duration_of_seconds(60);

 private:
  [[nodiscard]] bool is_lit(GpsTime time) const;

  GpsTime epoch_;
  orbit::QnsElements servicer_mean_;
  Vector3 sun_eci_ = Vector3::UnitX();
};

}  // namespace vbar::fsw::guidance
