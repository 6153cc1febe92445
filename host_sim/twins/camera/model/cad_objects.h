#pragma once
// Spacecraft rendered from their CAD files, for the scene renderer.

#include <filesystem>
#include <span>
#include <string>

#include "host_sim/twins/camera/object_view.h"

namespace vbar::twins::camera {

/// Loads data_directory/models/<model>.obj of every model; throws std::runtime_error as load_cad_model and
/// TargetRenderer do. The returned renderer throws std::invalid_argument for an unknown model, and
/// for a camera inside the sphere around a body. Copies of it share the models; one call at a time among them all.
ObjectRenderer cad_objects(const std::filesystem::path& data_directory, std::span<const std::string> models);

/// Their outlines; likewise.
ObjectCover cad_covers(const std::filesystem::path& data_directory, std::span<const std::string> models);

}  // namespace vbar::twins::camera
