#pragma once
// A body file (data/bodies, TOML): mass properties and surface of a spacecraft, and, for a target that
// cameras see, its CAD file and its keypoints.

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "host_sim/truth/attitude/torques.h"
#include "host_sim/twins/camera/model/cad_model.h"

namespace vbar::mission {

/// Returns the body in the file: keys inertia_kgm2 and centre_of_mass_m (required), `corners` (an array of tables with
/// at_m) and [[facet]] with `corners`, `specular` and `diffuse`. Lengths in m from the origin of the body frame; the
/// result is relative to the centre of mass, as in Body. The whole file is checked. Throws MissionError.
[[nodiscard]] truth::Body load_body(const std::filesystem::path& file);

/// Returns the `keypoints` in a body file, an array of `count` tables with at_m; m, from the origin of the body frame.
/// Throws MissionError, also if two of them lie within a millimetre.
[[nodiscard]] std::vector<fsw::Vector3> load_keypoints(const std::filesystem::path& file, std::size_t count);

/// Returns the CAD file of a model: that of [cad] in the body file of the same name (keys file, unit_m, axes, origin_m,
/// surface), else models/NAME.obj, in metres and body axes. Throws MissionError.
[[nodiscard]] twins::camera::CadSource cad_source_of(const std::filesystem::path& data_directory,
                                                     const std::string& model);

/// Returns the CAD files of several models, by the names of the models.
[[nodiscard]] std::map<std::string, twins::camera::CadSource> cad_sources_of(
    const std::filesystem::path& data_directory, std::span<const std::string> models);

/// Returns the names of the body files in the data folder, in alphabetical order.
[[nodiscard]] std::vector<std::string> body_names(const std::filesystem::path& data_directory);

/// Returns the body file of a name; an absolute path is the file itself.
[[nodiscard]] std::filesystem::path body_file_of(const std::filesystem::path& data_directory, const std::string& name);

}  // namespace vbar::mission
