#pragma once
// assess: where the present drift leads if nothing more is done, and if the retreat is flown. The assessment needs a
// safety_configuration in force.

#include "fsw/guidance/guidance.h"
#include "fsw/guidance/management.h"
#include "fsw/guidance/retreat_sequence.h"
#include "fsw/safety/retreat.h"

namespace vbar::fsw::guidance {

/// Returns the settings of the retreat; `margin_m` is the uncertainty of the position.
[[nodiscard]] safety::RetreatSettings retreat_settings(const safety_configuration& configuration, double margin_m);

/// Holds the assessment of the last step whose situation was known.
struct Assessment {
  bool is_known = false;
  double passive_distance = 0.0;       ///< m, minimum over the horizon without another burn, less three sigma
  double retreat_distance = 0.0;       ///< m, minimum with a retreat at the end of the delay, errors included
  double position_bound_m = 0.0;       ///< 3 sigma of the position a revolution later
  double collision_probability = 0.0;  ///< maximum over the horizon if the retreat is flown now
  double collision_probability_in_plane = 0.0;
};

/// Assesses the drift after the burns already commanded, and prepares the retreat from it. `unmeasured_s`, the time
/// since the last measurement of the target, counts up to the silence after which the safety monitor demands a retreat.
Assessment assess_drift_now(const DriftSituation& situation, double unmeasured_s,
                            const safety_configuration& configuration, RetreatSequence& retreat);

}  // namespace vbar::fsw::guidance
