#pragma once
// An attitude that follows one motion after another: at a given time the spacecraft leaves its motion and slews to the
// next one.
//
// During a slew of duration T the attitude is that of the next motion times the rotation of a vector p(s), s = 0 to 1:
// the cubic Hermite polynomial that begins with attitude and rate of the motion that is left and ends at p = 0, p' = 0.
// Attitude and rate are therefore continuous; the angular acceleration is bounded, but jumps at both ends.

#include <memory>
#include <optional>
#include <vector>

#include "host_sim/truth/attitude/attitude_motion.h"

namespace vbar::truth {

/// Beginning of a slew: the motion that is left and the next one, at that instant.
struct SlewStart {
  AttitudeState from;
  AttitudeState to;
};

/// Returns the attitude `elapsed_s` (0 to `slew_s`) after the beginning of a slew. `to`: the next motion at that time.
[[nodiscard]] AttitudeState slewed_attitude(const SlewStart& start, const AttitudeState& to, double elapsed_s,
                                            double slew_s);

class AttitudeSequence final : public AttitudeMotion {
 public:
  /// A motion for which the one before is left at `from_s` (s after the model's epoch), and which is reached after a
  /// slew of `slew_s`. It must be a function of the spacecraft's own orbit alone.
  struct Later {
    double from_s = 0.0;
    double slew_s = 0.0;
    std::unique_ptr<AttitudeMotion> motion;
  };

  /// Throws std::invalid_argument for a missing motion, a slew that does not take time, or one that has not ended when
  /// the next one begins.
  AttitudeSequence(std::unique_ptr<AttitudeMotion> first, std::vector<Later> later);

  void advance_to(double seconds, double orbit_step_end) override;
  void orbit_changed(double seconds) override;
  [[nodiscard]] AttitudeState state_at(double seconds) const override;

 private:
  [[nodiscard]] SlewStart start_of(std::size_t k) const;

  std::unique_ptr<AttitudeMotion> first_;
  std::vector<Later> later_;
  std::vector<std::optional<SlewStart>>
      starts_;  ///< beginnings of the slews of `later_`, once reached: neither motion keeps its past
};

}  // namespace vbar::truth
