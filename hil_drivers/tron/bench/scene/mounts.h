#pragma once
// Bodies that hold the target, and those of the camera's own arm in its view.

#include <vector>

#include "hil_drivers/tron/bench/scene/lab_view.h"

namespace vbar::tron::bench {

/// Returns the arms' limbs, the rod between flange and target (or board) and the pedestal, without those that surround
/// the camera, such as its own housing.
[[nodiscard]] std::vector<Limb> limbs_in_view(const BenchFile& bench, const LabView& view);

}  // namespace vbar::tron::bench
