#pragma once
// The constituents of the air in NRLMSISE-00.

namespace vbar::truth {

/// Number densities, in the unit that the name of the variable states.
struct SpeciesDensities {
  double he = 0.0;
  double o = 0.0;
  double n2 = 0.0;
  double o2 = 0.0;
  double ar = 0.0;
  double h = 0.0;
  double n = 0.0;
  double anomalous_o = 0.0;  ///< hot and ionised oxygen, relevant to drag at night above 500 km
};

}  // namespace vbar::truth
