#pragma once
// Checks that the states of a truth in another process can be those of the mission's spacecraft. An invalid unit, frame
// or convention is found by the motion: a state is compared with the position and velocity to which the point mass of
// the Earth leads the previous one.

#include <string>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::external {

/// Largest perturbation of the point mass that is accepted, m/s^2. That of the Earth's oblateness is 0.032 m/s^2 above
/// a pole at the surface, and less everywhere else; that of all other forces is far smaller.
inline constexpr double kLargestPerturbation = 0.05;

/// Returns the reason why `stated` cannot be the state `interval` after `before`, the impulses since then included;
/// empty if it can. A constant acceleration a moves a spacecraft by up to 1.5 a t^2 against an orbit without it, along
/// track; in addition 10 m and 0.01 m/s are accepted, more than the EME2000 frame (0.8 m) or single precision (0.5 m)
/// cause.
[[nodiscard]] std::string fault_of_motion(const twins::SpacecraftTruth& stated, const twins::SpacecraftTruth& before,
                                          fsw::Duration interval);

/// Returns the reason why `stated` cannot be the attitude at the start, `expected` that of the mission; empty if it
/// can, or if the mission has none. A difference of a degree is accepted.
[[nodiscard]] std::string fault_of_first_attitude(const twins::SpacecraftTruth& stated,
                                                  const twins::SpacecraftTruth& expected);

/// Returns the reason why a matrix is not a rotation; empty if it is.
[[nodiscard]] std::string fault_of_rotation(const fsw::Matrix3& R_itrf_gcrf);

}  // namespace vbar::external
