#include "fsw/guidance/lit_windows.h"

#include "fsw/filter/propagation.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/sun.h"

namespace vbar::fsw::guidance {

LitWindows::LitWindows(GpsTime epoch, const orbit::QnsElements& servicer_mean)
    : epoch_(epoch), servicer_mean_(servicer_mean), sun_eci_(orbit::sun_position_gcrf(epoch).normalized()) {}

bool LitWindows::is_lit(GpsTime time) const {
  const auto state = orbit::cartesian_from_qns(orbit::propagate_secular(servicer_mean_, seconds(time - epoch_)));
  return !state.ok() || filter::is_sunlit(state.value().position_eci, sun_eci_);
}

bool LitWindows::allows(GpsTime time) const {
  return is_lit(time - kAfterDawn) && is_lit(time) && is_lit(time + kBeforeDusk);
}

control::ThrustWindows LitWindows::thrust_windows() const {
  return {.allowed = [](const void* context,
                        GpsTime time) { return static_cast<const LitWindows*>(context)->allows(time); },
          .context = this};
}

}  // namespace vbar::fsw::guidance
