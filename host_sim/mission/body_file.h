#pragma once
// A body file (data/bodies, TOML): inertia, centre of mass and surface of a spacecraft.

#include <filesystem>

#include "host_sim/truth/attitude/body.h"

namespace vbar::mission {

/// The body in the file: keys inertia_kgm2 and centre_of_mass_m (required), `corners` (an array of tables with at_m)
/// and
/// [[facet]] with `corners`, `specular` and `diffuse`. Lengths in m from the origin of the body frame; they come back
/// from the centre of mass, as Body has them. Throws MissionError.
[[nodiscard]] truth::Body load_body(const std::filesystem::path& file);

}  // namespace vbar::mission
