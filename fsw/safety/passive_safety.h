#pragma once
// Passive safety: the minimum distance of the spacecraft in free drift, now and after every burn of a plan.
//
// The drift is computed by the linear near-circular map with its along-track and cross-track coordinates interpreted as
// angles (curvilinear), and the ROE drifting under J2. Against the exact map through both osculating orbits its minimum
// distances err by under 0.6 (e + J2) of the largest separation on the way, 1.3 cm for 10 m and 95 m for 75 km on the
// mission's orbit, for its waypoints and most others; the worst of 1,500 random drifts by 0.85 (e + J2).

#include <cstddef>
#include <optional>

#include "fsw/control/plan.h"
#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "fsw/safety/retreat.h"

namespace vbar::fsw::safety {

/// Returns the minimum distance, m, in the plane perpendicular to the flight direction over a revolution, from the
/// dimensionless eccentricity and inclination vectors of the ROE (da = 0; otherwise the bound is this less a |da|). `a`
/// in m. D'Amico 2010, eq. 2.22.
double eccentricity_inclination_separation(const Vector6& roe, double a);

/// Holds the uncertainty of the relative position as bounds, not sigmas: the caller chooses the confidence. All m, >=
/// 0.
struct PositionBound {
  double radial_normal = 0.0;     ///< bound of the position in the RN plane
  double along_track = 0.0;       ///< bound of the T coordinate at the start
  double along_track_rate = 0.0;  ///< its growth, m/s: 1.5 n times the bound of a da
};

/// Holds a minimum distance and its time, s after the start.
struct Closest {
  double distance = 0.0;
  double time = 0.0;
};

/// Holds the minimum distances of a free drift, reduced by `PositionBound`, never below zero.
struct DriftSafety {
  /// Minimum distance in space. At each time the guaranteed separations in the RN plane and along track are combined,
  /// so that with an unknown along-track position the RN distance remains.
  Closest spatial;
  Closest radial_normal;  ///< in the RN plane only
};

/// Assesses the free drift over `horizon` s (>= 0) from mean elements of the servicer and dimensionless mean ROE of the
/// target. It is sampled a hundred times a revolution, and minima are refined by a parabola. kNotFinite; kOutOfRange
/// for a horizon over 40 revolutions, ROE over 0.5 or elements outside the mean-element theory.
Result<DriftSafety> assess_drift(const orbit::QnsElements& servicer_mean, const Vector6& mean_roe, double horizon,
                                 const PositionBound& bound = {});

/// Holds the uncertainty of a burn of the servicer, each axis, 1 sigma.
struct BurnUncertainty {
  double sigma_mps = 0.0;
  double sigma_relative = 0.0;  ///< share of its size
};

/// Requires that a plan allows a retreat after every burn.
struct RetreatCriterion {
  RetreatSettings settings;
  double delay = 0.0;                          ///< s until the retreat burn, from now and from each burn
  Matrix6 covariance_m2 = Matrix6::Zero();     ///< covariance of the mean ROE times a at the start
  double maximum_collision_probability = 1.0;  ///< after the retreat burn, over the horizon
};

/// Holds the criteria of a plan.
struct SafetyCriterion {
  double keep_out_radius = 0.0;  ///< m
  double horizon = 0.0;          ///< s, how long each drift is evaluated
  PositionBound bound{};
  BurnUncertainty burns{};
  std::optional<RetreatCriterion> retreat{};
};

/// Describes the worst drift of a plan. In prefix k the first k burns are executed and the others missed.
struct PlanSafety {
  bool safe = false;             ///< keeps the keep-out radius as assess_plan() states, and can retreat throughout
  double min_distance = 0.0;     ///< m, in space, bound subtracted, over all prefixes
  double min_rn_distance = 0.0;  ///< m, in the RN plane, bound subtracted, over all prefixes
  double time = 0.0;             ///< s after `start`, time of min_distance
  std::size_t prefix = 0;        ///< prefix of min_distance
  /// States, with a RetreatCriterion, whether it holds after all prefixes; the worst values follow.
  bool allows_retreat = true;
  double retreat_distance = 0.0;       ///< m
  double collision_probability = 0.0;  ///< after the retreat burn
};

/// Evaluates the drift after each prefix of the plan's burns (the servicer's, in its RTN), from 0 burns at `start` to
/// all, for the horizon and at least until the next burn. Each must keep the distance, but the drift before the first
/// burn only until that burn, with a RetreatCriterion until the retreat that follows if it is missed: not flying the
/// plan would not end it. Elements and ROE hold at `start`. kInvalidArgument unless the burns are in order of time and
/// none before `start`; errors of assess_drift. A plan that cannot be assessed is unsafe.
Result<PlanSafety> assess_plan(GpsTime start, const orbit::QnsElements& servicer_mean, const Vector6& mean_roe,
                               const control::Plan& plan, const SafetyCriterion& criterion);

}  // namespace vbar::fsw::safety
