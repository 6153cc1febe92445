#pragma once
// The orbit and clock model of the broadcast ephemerides: the motion that a satellite broadcasts, and, here, its true
// motion up to the errors of constellation.h.
// IS-GPS-200N 20.3.3.4.3 and 20.3.3.3.3.1; Galileo OS SIS ICD 2.1, 5.1; BDS-SIS-ICD-B1I-3.0, 5.2.4.9 to 5.2.4.12.

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/twins/gnss/satellite.h"

namespace vbar::twins::gnss {

/// Set of elements. Unlike the broadcast one it names the node by its Earth-fixed longitude at toe, so that
/// it depends on no week and can be moved to another day; omega0 = node_at_toe + Earth rate * (seconds of week of toe).
/// The clock's reference time is toe.
struct Ephemeris {
  SatelliteId satellite;
  fsw::GpsTime toe;     ///< GPS time for every system
  double sqrt_a = 0.0;  ///< m^(1/2)
  double e = 0.0;
  double m0 = 0.0;           ///< rad, as all angles
  double delta_n = 0.0;      ///< rad/s
  double node_at_toe = 0.0;  ///< rad; that of geostationary BeiDou satellites is in the frame of their model
  double omega_dot = 0.0;    ///< rad/s
  double i0 = 0.0;
  double i_dot = 0.0;  ///< rad/s
  double omega = 0.0;  ///< argument of perigee
  double cuc = 0.0, cus = 0.0, cic = 0.0, cis = 0.0;
  double crc = 0.0, crs = 0.0;             ///< m
  double af0 = 0.0, af1 = 0.0, af2 = 0.0;  ///< s, s/s, s/s^2
  double group_delay_s = 0.0;              ///< GPS TGD, Galileo BGD(E1,E5b), BeiDou TGD1
};

struct SatelliteState {
  fsw::Vector3 position_ecef = fsw::Vector3::Zero();  ///< in the Earth-fixed frame of the same instant
  fsw::Vector3 velocity_ecef = fsw::Vector3::Zero();  ///< relative to that frame
  double clock_s = 0.0;      ///< satellite clock minus system time, relativity of the eccentric orbit included
  double clock_drift = 0.0;  ///< s/s, the same
};

/// Return the gravitational parameter (m^3/s^2) and Earth rate (rad/s) of a system's model.
double gravitational_parameter(System system);
double earth_rate(System system);

/// Returns the mean motion, delta_n included, rad/s.
double mean_motion(const Ephemeris& ephemeris);

/// Returns the state `offset_s` after `time`. The model is evaluated at any distance from toe.
SatelliteState satellite_state(const Ephemeris& ephemeris, fsw::GpsTime time, double offset_s = 0.0);

/// Returns the set of elements with reference time `toe` that describes the same motion. Exact: every term of the model
/// is constant or linear in time. (Sets of geostationary BeiDou satellites must have no harmonic terms or rates, as
/// constellation.h makes them: their tilted frame rotates with toe.)
Ephemeris with_reference_time(const Ephemeris& ephemeris, fsw::GpsTime toe);

}  // namespace vbar::twins::gnss
