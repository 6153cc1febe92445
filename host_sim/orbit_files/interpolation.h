#pragma once
// Interpolation between the states of a track, checked against these states by leaving each of them out.
//
// Bound of the error. A polynomial through n nodes t_k (each of them twice for Hermite's) misses a smooth orbit f by
//   f^(m)(.)/m! w(t),  w(t) = product (t - t_k), each factor as often as its node, m = n or 2n.
// A state of the file left out and predicted from the n nearest of the others shows this error at twice the spacing:
// there |w| is 16 h^8 for four states with velocities and 14,400 h^10 for ten positions, against 0.32 h^8 and 872 h^10
// midway between two states of the complete file, and, at the ends of a track, 36 h^8 against 0.93 h^8 at most. So the
// error of the prediction exceeds that of the interpolation 16- to 60-fold for even steps; for uneven ones it is
// multiplied by |w(t)| over |w| of the state left out where that is more than 1. Errors of the states themselves
// (rounding, a maneuver, velocities that contradict the positions) enter the prediction in full. The bound is the
// largest over the states through which the polynomial passes. That of the velocity is the largest of the same states,
// but not below that of the position over the step: the derivative of w vanishes at a state left out between even ones
// (16 h^7 are above the 0.97 h^7 of the complete file, at its ends 36 h^7 above 4.2 h^7). It presumes that the states
// resolve the orbit: at steps of a period all are alike, whatever lies between, so a step may be a quarter of a
// revolution at most.

#include "host_sim/orbit_files/orbit_file.h"

namespace vbar::orbit_files {

/// Largest bound of the position's error that is accepted. By the factor above the error itself is then below 1 m, the
/// accuracy of the orbits that operators publish, and far below what a wrong file shows (kilometres).
inline constexpr double kMaxInterpolationErrorM = 10.0;

/// Returns the state at a time between the first and the last of the track. Throws std::out_of_range that names `file`,
/// time and reason.
[[nodiscard]] FramedState interpolated(const Track& track, fsw::GpsTime time, const std::string& file);

/// Returns the name of a rule: "Hermite polynomial of degree 7".
[[nodiscard]] std::string name_of(const InterpolationRule& rule);

}  // namespace vbar::orbit_files
