#pragma once

#include "hil_drivers/tron/bench/scene/lab_view.h"

namespace vbar::tron::bench {

/// Throws std::invalid_argument, naming what is wrong, if a number of the view is not finite or not possible or a pose
/// is not a rigid one.
void check_view(const LabView& view);

}  // namespace vbar::tron::bench
