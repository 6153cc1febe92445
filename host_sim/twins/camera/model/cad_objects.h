#pragma once
// Spacecraft rendered from their CAD files, for the scene renderer.

#include <map>
#include <string>

#include "host_sim/twins/camera/model/cad_source.h"
#include "host_sim/twins/camera/object_view.h"

namespace vbar::twins::camera {

/// Models by the names that views refer to.
using CadSources = std::map<std::string, CadSource>;

/// Loads the CAD file of every model; throws std::runtime_error as load_cad_model and TargetRenderer do. The returned
/// renderer throws std::invalid_argument for an unknown model, and for a camera inside the sphere around a body. Copies
/// of the renderer share the models; one call at a time among all copies.
ObjectRenderer cad_objects(const CadSources& models);

/// Loads the outlines of the models; throws as cad_objects().
ObjectCover cad_covers(const CadSources& models);

}  // namespace vbar::twins::camera
