#pragma once
// The coefficients of NRLMSISE-00's series in the horizontal functions on one day at one level of solar activity: the
// published expansion evaluated for season and flux, so that only place and time of day remain.

#include "host_sim/truth/atmosphere/horizontal_basis.h"
#include "host_sim/truth/atmosphere/nrlmsise00_tables.h"
#include "host_sim/truth/atmosphere/solar_indices.h"

namespace vbar::truth {

/// Series of a quantity, which is quiet + (effective ap) magnetic.
struct ExpansionOfDay {
  HorizontalSeries quiet{};
  HorizontalSeries magnetic{};
};

/// Expands a quantity of the thermosphere (Hedin 1987, eq. A22 ff.; "globe" expansion).
ExpansionOfDay upper_expansion(const Nrlmsise00Tables::Upper& p, int day_of_year, const SolarIndices& indices);

/// Expands a quantity below 120 km (Hedin 1991, J. Geophys. Res. 96): fewer terms, no universal time.
ExpansionOfDay lower_expansion(const Nrlmsise00Tables::Lower& p, int day_of_year, const SolarIndices& indices);

}  // namespace vbar::truth
