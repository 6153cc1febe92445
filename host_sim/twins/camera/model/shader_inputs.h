#pragma once
// What the shaders of surfaces take: materials, and the Earth's light as a table.

#include <array>
#include <vector>

#include "host_sim/twins/camera/model/cad_model.h"

namespace vbar::twins::camera {

/// Returns albedo, reflectivity, the same at grazing incidence, roughness. A reflectivity below 4 %, glass with a
/// coating or plain paint, rises less at grazing incidence; zero stays zero. Roughness from the exponent: Walter et al.
/// (2007), section 5.2.
std::array<float, 4> shader_material(const Material& material);

/// Tabulates earth_light_factor() at even steps of the cosine from -1 to 1.
std::vector<float> earth_table(double sine_earth);

}  // namespace vbar::twins::camera
