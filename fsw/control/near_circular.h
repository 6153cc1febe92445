#pragma once
// The near-circular model of relative motion that the closed-form solver uses: a tangential impulse changes da
// and, by drift, dlambda, and changes de along one phase; a normal impulse changes di along one phase (Chernick and
// D'Amico 2018). Terms of order e are left to the caller, who evaluates the exact effects.

#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::control {

/// Holds the rates of a near-circular orbit under J2 that determine the effects of impulses, from mean elements.
struct NearCircularOrbit {
  double a = 0.0;                ///< m
  double n = 0.0;                ///< Keplerian mean motion, rad/s
  double u = 0.0;                ///< mean argument of latitude at the start, rad
  double latitude_rate = 0.0;    ///< rate of u, rad/s
  double perigee_rate = 0.0;     ///< rotation of the eccentricity vector, rad/s
  double drift_rate = 0.0;       ///< -d(dlambda)/dt per da, rad/s: 1.5 n and the J2 part
  double node_drift_rate = 0.0;  ///< d(diy)/dt per dix, rad/s
};

NearCircularOrbit near_circular_orbit(const orbit::QnsElements& mean);

/// Holds the in-plane change wanted at the end of the window, as speeds (m/s): sums over tangential impulses x_k at
/// times-to-go tau_k.
struct TangentialTask {
  double window = 0.0;  ///< s
  double sum = 0.0;     ///< sum of x_k, from da
  double moment = 0.0;  ///< sum of tau_k x_k, from dlambda, m
  double e_cos = 0.0;   ///< sum of x_k cos(phase of burn k), from dex
  double e_sin = 0.0;   ///< sum of x_k sin(phase of burn k), from dey
};

/// Returns the in-plane change for `pseudo_state`, dimensionless, at the end of a window of `window` s.
TangentialTask tangential_task(const NearCircularOrbit& orbit, const Vector6& pseudo_state, double window);

/// Returns the phase (rad) in the eccentricity plane, at the end of the window, of a tangential impulse `offset` s into
/// the window.
double eccentricity_phase(const NearCircularOrbit& orbit, double window, double offset);

/// Holds lower bounds of the delta-v (m/s) for each part of a pseudo-state by reachable-set theory: radial impulses
/// excluded, which are of use only in windows shorter than 0.3 orbits.
struct ReachableBounds {
  double da = 0.0;
  double dlambda = 0.0;
  double de = 0.0;
  double di = 0.0;

  /// Returns the largest in-plane bound: one set of burns may achieve all in-plane parts.
  [[nodiscard]] double in_plane() const;
};

ReachableBounds reachable_bounds(const NearCircularOrbit& orbit, const Vector6& pseudo_state, double window);

}  // namespace vbar::fsw::control
