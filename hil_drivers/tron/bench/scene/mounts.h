#pragma once
// What holds the target, and where the camera is in its own way.

#include <vector>

#include "hil_drivers/tron/bench/scene/lab_view.h"

namespace vbar::tron::bench {

/// The arms' limbs, the rod between flange and target (or board) and the pedestal. Without those that surround the
/// camera, such as its own housing.
[[nodiscard]] std::vector<Limb> limbs_in_view(const BenchFile& bench, const LabView& view);

}  // namespace vbar::tron::bench
