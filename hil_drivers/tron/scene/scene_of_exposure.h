#pragma once
// Conversion of an exposure in orbit to the scene of the laboratory.

#include <optional>

#include "hil_drivers/tron/placement/scene.h"
#include "host_sim/twins/camera/exposure.h"

namespace vbar::tron {

/// Returns the scene with the target of that CAD model, lengths times `scale`. Nothing if the exposure has no such
/// object.
[[nodiscard]] std::optional<Scene> scene_of(const twins::camera::Exposure& exposure, const std::string& model,
                                            double scale);

}  // namespace vbar::tron
