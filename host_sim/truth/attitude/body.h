#pragma once
// A spacecraft as a rigid body with a surface.

#include <string>
#include <vector>

#include "fsw/core/types.h"

namespace vbar::truth {

/// A flat part of the outer surface. Light that it does not reflect is absorbed.
struct Facet {
  double area_m2 = 0.0;
  fsw::Vector3 centre_m = fsw::Vector3::Zero();  ///< centroid, in body axes, from the centre of mass
  fsw::Vector3 normal = fsw::Vector3::Zero();    ///< unit vector outwards, in body axes
  double specular = 0.0;                         ///< fraction of light reflected specularly
  double diffuse = 0.0;                          ///< fraction of light reflected by Lambert's law
};

/// Returns the facet of a plane convex polygon whose corners (m, body axes, from the centre of mass) go anticlockwise
/// seen from outside. Throws std::invalid_argument for fewer than three corners, corners off their plane by more than
/// 1e-6 of the size, or reflectivities that are negative or add to more than 1.
Facet facet_of_polygon(const std::vector<fsw::Vector3>& corners_m, double specular, double diffuse);

struct Body {
  std::string name;
  fsw::Matrix3 inertia_kgm2 = fsw::Matrix3::Zero();      ///< about the centre of mass, in body axes
  fsw::Vector3 centre_of_mass_m = fsw::Vector3::Zero();  ///< from the origin of the body frame
  std::vector<Facet> facets;                             ///< facets of a convex body; empty: its shape is unknown
};

}  // namespace vbar::truth
