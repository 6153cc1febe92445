#pragma once
// The constituents of the air that NRLMSISE-00 tells apart.

namespace vbar::truth {

/// Number densities, in a unit that the user's name says.
struct SpeciesDensities {
  double he = 0.0;
  double o = 0.0;
  double n2 = 0.0;
  double o2 = 0.0;
  double ar = 0.0;
  double h = 0.0;
  double n = 0.0;
  double anomalous_o = 0.0;  ///< hot and ionised oxygen, which drags at night above 500 km
};

}  // namespace vbar::truth
