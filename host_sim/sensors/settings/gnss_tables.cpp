#include "host_sim/sensors/settings/gnss_tables.h"

#include <stdexcept>

#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::sensors {
namespace {

using mission::above_to;
using mission::from_to;
using mission::Names;
using mission::Range;
using mission::TableReader;
using twins::gnss::SatelliteSet;

constexpr Names<SatelliteSet, 3> kSatelliteSets{
    {{"none", SatelliteSet::kNone}, {"broadcast", SatelliteSet::kBroadcast}, {"nominal", SatelliteSet::kNominal}}};

}  // namespace

void read_visibility(const TableReader& section, twins::gnss::VisibilitySettings& settings) {
  read(section, "transmit_aperture_deg", above_to(0.0, 360.0), settings.transmit_aperture_deg);
  read(section, "receiver_mask_deg", above_to(0.0, 360.0), settings.receiver_mask_deg);
  read(section, "horizon_mask_deg", from_to(-90.0, 90.0), settings.horizon_mask_deg);
  read(section, "occultation_altitude_km", from_to(0.0, 1000.0), settings.occultation_altitude_km);
}

void read_link_budget(const TableReader& section, twins::gnss::LinkBudgetSettings& settings) {
  read(section, "boresight_gain_dbi", from_to(-20.0, 40.0), settings.boresight_gain_dbi);
  read(section, "antenna_temperature_k", above_to(0.0, 1e4), settings.antenna_temperature_k);
  read(section, "lna_gain_db", from_to(0.0, 80.0), settings.lna_gain_db);
  read(section, "lna_noise_figure_db", from_to(0.0, 30.0), settings.lna_noise_figure_db);
  read(section, "receiver_noise_figure_db", from_to(0.0, 30.0), settings.receiver_noise_figure_db);
  read(section, "losses_db", from_to(0.0, 40.0), settings.losses_db);
}

void read_constellation(const TableReader& section, twins::gnss::ConstellationSettings& settings) {
  settings.gps = section.choice<SatelliteSet>("gps", kSatelliteSets, settings.gps);
  settings.galileo = section.choice<SatelliteSet>("galileo", kSatelliteSets, settings.galileo);
  settings.beidou = section.choice<SatelliteSet>("beidou", kSatelliteSets, settings.beidou);
  constexpr Range kError = from_to(0.0, 1e4);
  read(section, "orbit_error_radial_m", kError, settings.orbit_error_radial_m);
  read(section, "orbit_error_transverse_m", kError, settings.orbit_error_transverse_m);
  read(section, "orbit_error_normal_m", kError, settings.orbit_error_normal_m);
  read(section, "clock_error_ns", kError, settings.clock_error_ns);
  section.finish();
  try {
    twins::gnss::check(settings);
  } catch (const std::invalid_argument& error) {
    section.refuse("", error.what(), "settings that fit together");
  }
}

}  // namespace vbar::sensors
