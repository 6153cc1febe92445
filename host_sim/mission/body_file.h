#pragma once
// A body file (data/bodies, TOML): inertia, centre of mass and surface of a spacecraft.

#include <filesystem>
#include <vector>

#include "host_sim/truth/attitude/body.h"

namespace vbar::mission {

/// The body in the file: keys inertia_kgm2 and centre_of_mass_m (required), `corners` (an array of tables with at_m)
/// and
/// [[facet]] with `corners`, `specular` and `diffuse`. Lengths in m from the origin of the body frame; the result
/// is relative to the centre of mass, as in Body. Throws MissionError.
[[nodiscard]] truth::Body load_body(const std::filesystem::path& file);

/// The keypoints in a file of data/models: `keypoints`, an array of `count` tables with at_m. m, from the origin of the
/// body frame. Throws MissionError.
[[nodiscard]] std::vector<fsw::Vector3> load_keypoints(const std::filesystem::path& file, std::size_t count);

}  // namespace vbar::mission
