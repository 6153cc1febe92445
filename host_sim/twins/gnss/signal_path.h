#pragma once
// The path of a signal from a satellite to the receiver, without ionosphere, electronics and noise.
//
// All quantities are in the Earth-fixed frame of the instant of reception: the satellite's position at
// transmission is rotated by the Earth rotation during the signal's travel (Sagnac).

#include <optional>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/gnss_settings.h"

namespace vbar::twins::gnss {

/// A receiving antenna at the true instant `time` + `offset_s`.
struct AntennaState {
  fsw::GpsTime time;
  double offset_s = 0.0;
  fsw::Vector3 position_ecef = fsw::Vector3::Zero();
  fsw::Vector3 velocity_ecef = fsw::Vector3::Zero();  ///< relative to the rotating frame
  fsw::Vector3 boresight_ecef = fsw::Vector3::UnitZ();
};

struct SignalPath {
  fsw::Vector3 line_of_sight = fsw::Vector3::Zero();  ///< unit vector from the antenna to the satellite
  double range_m = 0.0;                               ///< geometric, transmission to reception
  double range_rate_mps = 0.0;
  double shapiro_m = 0.0;          ///< delay in the Earth's field: 1 to 2 cm (Ashby 2003, section 3)
  double satellite_clock_s = 0.0;  ///< at transmission
  double satellite_clock_drift = 0.0;
};

/// Returns whether a satellite at this position (Earth-fixed frame of reception) is visible under `settings`.
bool is_visible(const fsw::Vector3& satellite_ecef, const AntennaState& antenna, const VisibilitySettings& settings);

/// Returns the delay of a signal in the Earth's field, m, from the distances of both ends from the Earth's centre.
double shapiro_delay_m(double transmitter_radius_m, double receiver_radius_m, double range_m);

/// Returns the true path from satellite `index`; empty if it is not visible under `settings`.
std::optional<SignalPath> visible_path(const Constellation& constellation, std::size_t index,
                                       const AntennaState& antenna, const VisibilitySettings& settings);

/// Returns the path that a broadcast set predicts to the true antenna: the prediction of the receiver's own point
/// solution.
SignalPath broadcast_path(const Ephemeris& ephemeris, const AntennaState& antenna);

}  // namespace vbar::twins::gnss
