#pragma once
// The spacecraft before a camera, each drawn from its CAD file.

#include <filesystem>
#include <set>
#include <string>

#include "host_sim/twins/camera/object_view.h"

namespace vbar::twins::camera {

/// Draws the models of these names, data_directory/models/<name>.obj. Files are read here: throws std::runtime_error as
/// load_cad_model does, and if there is no OpenGL. A view of another model throws std::invalid_argument.
ObjectRenderer cad_objects(const std::filesystem::path& data_directory, const std::set<std::string>& models);

}  // namespace vbar::twins::camera
