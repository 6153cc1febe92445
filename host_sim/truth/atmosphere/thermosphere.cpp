#include "host_sim/truth/atmosphere/thermosphere.h"

#include <cmath>
#include <cstddef>

namespace vbar::truth {

/// One altitude of one profile, with the turbopause.
struct Thermosphere::Column {
  double altitude_km = 0.0;
  const LatitudeGravity& gravity;
  const BatesProfile& bates;
  const LowerThermosphereNodes& nodes;
  const ThermosphereTemperature& profile;
  ThermosphereLevel level;  ///< level of the altitude
  double log_n2_at_homopause = 0.0;
};

double Thermosphere::Transition::log_factor(double altitude_km, double amplitude) const {
  const double above_km = altitude_km - height_km;
  double growth = std::exp(above_km / scale_km);
  if (second_scale_km != scale_km) growth = 0.5 * (growth + std::exp(above_km / second_scale_km));
  return amplitude / (1.0 + growth);
}

Thermosphere::Species Thermosphere::species(const Nrlmsise00Tables& tables, std::size_t pdm_row, std::size_t pd_row,
                                            double mass, double thermal_diffusion, double mixing_ceiling_km) {
  const auto& pdm = tables.pdm[pdm_row];
  Species result;
  result.mass = mass;
  result.thermal_diffusion = thermal_diffusion;
  result.mixing_ceiling_km = mixing_ceiling_km;
  result.log_reference = std::log(pdm[0] * tables.pd[pd_row][0]);
  result.homopause_km = pdm[2];
  return result;
}

Thermosphere::Thermosphere(const Nrlmsise00Tables& t)
    : mean_exospheric_(t.ptm[0] * t.pt[0]),
      mean_boundary_(t.ptm[1] * t.pd[3][0]),
      mean_gradient_(t.ptm[3] * t.ps[0]),
      boundary_km_(t.ptm[5]),
      mixed_mass_(t.pdm[2][4]),
      mixing_depth_(t.pdm[2][3] * t.pdl[1][5]),
      turbopause_factor_(t.pdl[1][24]),
      turbopause_variation_(t.pdl[0][24]),
      he_(species(t, 0, 0, 4.0, -0.38, 200.0)),
      o_(species(t, 1, 1, 16.0, 0.0, 300.0)),
      n2_(species(t, 2, 2, 28.0, 0.0, 160.0)),
      o2_(species(t, 3, 4, 32.0, 0.0, 250.0)),
      ar_(species(t, 4, 5, 40.0, 0.17, 240.0)),
      h_(species(t, 5, 6, 1.0, -0.38, 320.0)),
      n_(species(t, 6, 7, 14.0, 0.0, 450.0)),
      anomalous_o_(species(t, 7, 8, 16.0, 0.0, 0.0)),
      oxygen_amplitude_(t.pdm[1][1] * t.pdl[1][16]),
      oxygen_flux_slope_(t.pdl[0][23]),
      molecular_oxygen_chemistry_{t.pdm[3][6] * t.pdl[1][21], t.pdm[3][7] * t.pdl[1][22], t.pdm[3][7] * t.pdl[0][22]},
      molecular_oxygen_amplitude_(t.pdm[3][3] * t.pdl[1][23]),
      anomalous_temperature_(t.pdm[7][9] * t.pdl[0][6]),
      anomalous_km_(t.pdm[7][4]),
      anomalous_scale_km_(t.pdm[7][5]) {
  mean_nodes_.altitude_km = {t.pdl[1][15], 110.0, 100.0, 90.0, kBottomKm};
  mean_nodes_.temperature = {t.ptm[6] * t.ptl[0][0], t.ptm[2] * t.ptl[1][0], t.ptm[7] * t.ptl[2][0],
                             t.ptm[4] * t.ptl[3][0]};
  mean_nodes_.bottom_gradient = t.ptm[8] * t.pma[8][0];

  // Heights and scales are a species' own (pdm) times a factor (pdl, two rows of 25).
  const auto& pdl0 = t.pdl[0];
  const auto& pdl1 = t.pdl[1];
  const auto transition = [](double height_km, double scale_km) { return Transition{height_km, scale_km, scale_km}; };
  he_.to_mixing_ratio = transition(t.pdm[0][4] * pdl1[0], t.pdm[0][5] * pdl1[1]);
  he_.log_mixing_ratio = std::log(t.pdm[0][1]);

  o_.to_mixing_ratio = {t.pdm[1][4] * pdl1[2], t.pdm[1][5] * pdl1[3], t.pdm[1][5] * pdl1[4]};
  o_.chemistry = transition(t.pdm[1][6] * pdl1[12], t.pdm[1][7] * pdl1[13]);
  o_.chemistry_amplitude = t.pdm[1][3] * pdl1[14];

  o2_.to_mixing_ratio = transition(t.pdm[3][4] * pdl1[6], t.pdm[3][5] * pdl1[7]);
  o2_.log_mixing_ratio = std::log(t.pdm[3][1]);

  ar_.to_mixing_ratio = transition(t.pdm[4][4] * pdl1[8], t.pdm[4][5] * pdl1[9]);
  ar_.log_mixing_ratio = std::log(t.pdm[4][1]);

  h_.to_mixing_ratio = transition(t.pdm[5][4] * pdl1[10], t.pdm[5][5] * pdl1[11]);
  h_.log_mixing_ratio = std::log(t.pdm[5][1] * std::abs(pdl1[17]));
  h_.chemistry = transition(t.pdm[5][6] * pdl1[18], t.pdm[5][7] * pdl1[19]);
  h_.chemistry_amplitude = t.pdm[5][3] * pdl1[20];

  n_.to_mixing_ratio = transition(t.pdm[6][4] * pdl0[0], t.pdm[6][5] * pdl0[1]);
  n_.log_mixing_ratio = std::log(t.pdm[6][1] * std::abs(pdl0[2]));
  n_.chemistry = transition(t.pdm[6][6] * pdl0[3], t.pdm[6][7] * pdl0[4]);
  n_.chemistry_amplitude = t.pdm[6][3] * pdl0[5];
}

ThermosphereState Thermosphere::at(double altitude_km, const LatitudeGravity& gravity,
                                   const ThermosphereConditions& conditions) const {
  const UpperVariations& upper = conditions.upper;
  const BatesProfile bates = bates_profile(altitude_km, upper);
  const LowerThermosphereNodes nodes = lower_nodes(conditions.lower);
  const ThermosphereTemperature profile(gravity, bates, nodes);
  Column column{altitude_km, gravity, bates, nodes, profile, profile.at(altitude_km)};

  const double n2_homopause_km =
      n2_.homopause_km * turbopause_factor_ * (1.0 + turbopause_variation_ * conditions.turbopause_season);
  column.log_n2_at_homopause = log_at_homopause(n2_, n2_homopause_km, upper.n2, column);
  const double log_mixed_n2 = log_mixed(column.log_n2_at_homopause, column.level);
  double log_n2 = log_diffusive(n2_, upper.n2, column.level);
  if (altitude_km <= n2_.mixing_ceiling_km) log_n2 = log_net(n2_, log_n2, log_mixed_n2);

  ThermosphereState state;
  state.per_cm3.he = std::exp(log_density(he_, upper.he, column));
  state.per_cm3.o = std::exp(log_oxygen(conditions, column));
  state.per_cm3.n2 = std::exp(log_n2);
  state.per_cm3.o2 = std::exp(log_molecular_oxygen(conditions, column));
  state.per_cm3.ar = std::exp(log_density(ar_, upper.ar, column));
  state.per_cm3.h = std::exp(log_density(h_, upper.h, column));
  state.per_cm3.n = std::exp(log_density(n_, upper.n, column));
  state.per_cm3.anomalous_o = std::exp(log_anomalous_oxygen(upper.anomalous_o, column));
  state.mixed_n2_per_cm3 = std::exp(log_mixed_n2);
  state.exospheric_temperature = bates.exospheric;
  state.temperature = column.level.temperature;
  state.bottom_temperature = nodes.temperature[3];
  state.bottom_gradient = nodes.bottom_gradient;
  return state;
}

LowerThermosphereNodes Thermosphere::lower_nodes(const LowerThermosphereVariations& variations) const {
  LowerThermosphereNodes nodes = mean_nodes_;
  for (std::size_t i = 0; i < nodes.temperature.size(); ++i) nodes.temperature[i] /= 1.0 - variations.temperature[i];
  const double warming = nodes.temperature[3] / mean_nodes_.temperature[3];
  nodes.bottom_gradient *= (1.0 + variations.bottom_gradient) * warming * warming;
  return nodes;
}

BatesProfile Thermosphere::bates_profile(double altitude_km, const UpperVariations& upper) const {
  // The model omits terms that have no effect on density far below.
  BatesProfile bates;
  bates.exospheric = mean_exospheric_;
  if (altitude_km > mean_nodes_.altitude_km[0]) bates.exospheric *= 1.0 + upper.exospheric_temperature;
  bates.boundary = mean_boundary_ * (1.0 + upper.boundary_temperature);
  double gradient = mean_gradient_;
  if (altitude_km > kBottomKm) gradient *= 1.0 + upper.gradient;
  bates.shape = gradient / (bates.exospheric - bates.boundary);
  bates.boundary_km = boundary_km_;
  return bates;
}

double Thermosphere::log_diffusive(const Species& species, double variation, const ThermosphereLevel& level) {
  return species.log_reference + variation + (1.0 + species.thermal_diffusion) * level.log_cooling +
         species.mass * level.weight;
}

double Thermosphere::log_at_homopause(const Species& species, double homopause_km, double variation,
                                      const Column& column) const {
  // The density at 120 km with which a mixed atmosphere has the density of the diffusive one at the homopause.
  const ThermosphereLevel homopause = column.profile.at(homopause_km);
  return species.log_reference + variation + species.thermal_diffusion * homopause.log_cooling +
         (species.mass - mixed_mass_) * homopause.weight;
}

double Thermosphere::log_mixed(double log_at_homopause, const ThermosphereLevel& level) const {
  return log_at_homopause + level.log_cooling + mixed_mass_ * level.weight;
}

double Thermosphere::log_net(const Species& species, double log_diffusive, double log_mixed) const {
  constexpr double kNegligible = 10.0;  // the model's: the smaller part is dropped
  const double sharpness = mixing_depth_ / (mixed_mass_ - species.mass);
  const double excess = sharpness * (log_mixed - log_diffusive);
  if (excess < -kNegligible) return log_diffusive;
  if (excess > kNegligible) return log_mixed;
  return log_diffusive + std::log(1.0 + std::exp(excess)) / sharpness;
}

double Thermosphere::log_density(const Species& species, double variation, const Column& column) const {
  const double diffusive = log_diffusive(species, variation, column.level);
  if (column.altitude_km > species.mixing_ceiling_km) return diffusive;
  const double at_homopause = log_at_homopause(species, species.homopause_km, variation, column);
  const double net = log_net(species, diffusive, log_mixed(at_homopause, column.level));
  const double to_mixing_ratio = column.log_n2_at_homopause + species.log_mixing_ratio - at_homopause;
  double log = net + species.to_mixing_ratio.log_factor(column.altitude_km, to_mixing_ratio);
  if (species.chemistry_amplitude != 0.0) {
    log += species.chemistry.log_factor(column.altitude_km, species.chemistry_amplitude);
  }
  return log;
}

double Thermosphere::log_oxygen(const ThermosphereConditions& conditions, const Column& column) const {
  const double variation = conditions.upper.o;
  const double diffusive = log_diffusive(o_, variation, column.level);
  if (column.altitude_km > o_.mixing_ceiling_km) return diffusive;
  const double at_homopause = log_at_homopause(o_, o_.homopause_km, variation, column);
  const double net = log_net(o_, diffusive, log_mixed(at_homopause, column.level));
  const double amplitude = oxygen_amplitude_ * (1.0 + oxygen_flux_slope_ * conditions.flux_excess);
  return net + o_.to_mixing_ratio.log_factor(column.altitude_km, amplitude) +
         o_.chemistry.log_factor(column.altitude_km, o_.chemistry_amplitude);
}

double Thermosphere::log_molecular_oxygen(const ThermosphereConditions& conditions, const Column& column) const {
  // Unlike the other species, it keeps its chemistry at all altitudes.
  const double amplitude = molecular_oxygen_amplitude_ * (1.0 + oxygen_flux_slope_ * conditions.flux_excess);
  return log_density(o2_, conditions.upper.o2, column) +
         molecular_oxygen_chemistry_.log_factor(column.altitude_km, amplitude);
}

double Thermosphere::log_anomalous_oxygen(double variation, const Column& column) const {
  // Its own constant temperature where it forms, and a scale height that grows below.
  BatesProfile hot = column.bates;
  hot.exospheric = anomalous_temperature_;
  hot.boundary = anomalous_temperature_;
  const bool above_joint = column.altitude_km >= column.nodes.altitude_km[0];
  const ThermosphereLevel level =
      above_joint ? bates_level(column.gravity, hot, column.altitude_km)
                  : ThermosphereTemperature(column.gravity, hot, column.nodes).at(column.altitude_km);
  const double scale_height_km =
      kModelGasConstant * anomalous_temperature_ / (column.gravity.at(anomalous_km_) * anomalous_o_.mass);
  const double above = (column.altitude_km - anomalous_km_) / anomalous_scale_km_;
  return log_diffusive(anomalous_o_, variation, level) -
         anomalous_scale_km_ / scale_height_km * (std::exp(-above) - 1.0);
}

}  // namespace vbar::truth
