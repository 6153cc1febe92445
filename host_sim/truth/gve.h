#pragma once
// Gauss variational equations in quasi-nonsingular elements: how a perturbing acceleration changes the osculating
// orbit.

#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/orbit_geometry.h"

namespace vbar::truth {

/// Convert elements to the integrator's vector [a, ex, ey, i, raan, u], and back.
fsw::Vector6 vector_from_elements(const fsw::orbit::QnsElements& elements);
fsw::orbit::QnsElements elements_from_vector(const fsw::Vector6& vector);

/// Returns the time derivative of [a, ex, ey, i, raan, u] (SI and radians) under the perturbing acceleration (m/s^2, in
/// the spacecraft's RTN, without the point mass). `geometry` is that of `osculating`. Singular at inclination 0 and pi.
/// Source: Gauss's equations (e.g. Battin 1999, section 10.5) for ex = e cos w, ey = e sin w, u = w + M.
fsw::Vector6 gve_rates(const fsw::orbit::QnsElements& osculating, const OrbitGeometry& geometry,
                       const fsw::Vector3& perturbation_rtn);

}  // namespace vbar::truth
