#pragma once
// Receiver's own position, velocity and time: least squares of GPS L1 code and Doppler, iterated from its last
// position, with the ephemerides it has received. Neither ionosphere nor truth enters.
// State: position (m, ECEF), clock offset (s); then velocity (m/s), clock drift.

#include <optional>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/twins/gnss/broadcast_orbit.h"

namespace vbar::grand::bench {

struct SolutionInput {
  const twins::gnss::Ephemeris* ephemeris = nullptr;
  double pseudorange_m = 0.0;
  double range_rate_mps = 0.0;
  double sigma_m = 1.0;
};

struct OwnSolution {
  fsw::Vector3 position_ecef = fsw::Vector3::Zero();  ///< at the epoch
  fsw::Vector3 velocity_ecef = fsw::Vector3::Zero();
  fsw::Vector3 position_sigma_m = fsw::Vector3::Zero();
  fsw::Vector3 velocity_sigma_mps = fsw::Vector3::Zero();
  double clock_offset_s = 0.0;  ///< reading minus GPS time
  double clock_drift = 0.0;
  double clock_sigma_s = 0.0;
  int satellites = 0;
};

/// Solves for an epoch. `reading` is the epoch by the receiver's clock, `start` a position within some thousand
/// kilometres, or none. No solution with fewer than four satellites, a singular geometry, without convergence or away
/// from the Earth.
std::optional<OwnSolution> solve_own(const std::vector<SolutionInput>& input, fsw::GpsTime reading,
                                     const std::optional<fsw::Vector3>& start);

}  // namespace vbar::grand::bench
