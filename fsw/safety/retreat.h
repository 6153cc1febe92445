#pragma once
// The retreat: one burn of the servicer after which the target recedes, with the errors that it must allow for.
//
// The receding burn is along track and sets a da = -sgn(a dl) recession, so that the distance along track grows by
// 3 pi recession an orbit: dv_T = n/2 (a da + sgn(a dl) recession). In its first half orbit the target swings towards
// the servicer by 0.45 m per mm/s; where that or the errors make it too close, the smallest burn of a menu is flown
// that keeps the distance.

#include <cstdint>

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "fsw/safety/collision_probability.h"

namespace vbar::fsw::safety {

struct RetreatSettings {
  double contact_distance = 2.0;    ///< m, distance to be kept for the horizon
  double margin = 0.0;              ///< m, to be kept in addition: uncertainty of the position
  double horizon = 86400.0;         ///< s
  double recession = 1.0;           ///< m
  double a_da_error_m = 0.05;       ///< error of a da, either sign
  double differential_drag = 1e-9;  ///< m/s^2, either sign, together with that error
  double unmeasured = 0.0;          ///< s before the burn without a measurement of the target, in which the errors act
};

/// Choices, with the numbers of telemetry_safety.choice.
enum class RetreatChoice : std::int8_t { kNone = 0, kReceding = 1, kMenu = 2 };

struct RetreatBurn {
  Vector3 dv_rtn = Vector3::Zero();  ///< of the servicer, m/s
  double distance = 0.0;             ///< m, minimum over the horizon and all errors
  RetreatChoice choice = RetreatChoice::kNone;
  bool keeps_distance = false;  ///< `distance` reaches contact_distance + margin
};

/// Returns the retreat burn at the instant at which the mean elements of the servicer and the mean ROE of the target
/// times a (m) hold: the receding burn if it keeps the distance, else the smallest one of the menu that does, else the
/// receding burn without keeps_distance. Errors of LinearDrift::make.
Result<RetreatBurn> find_retreat(const orbit::QnsElements& servicer_mean, const Vector6& a_roe_m,
                                 const RetreatSettings& settings);

/// Holds a retreat burn and the situation in which it is flown.
struct DelayedRetreat {
  RetreatBurn burn;
  orbit::QnsElements servicer_mean;   ///< at the burn
  Vector6 a_roe_m = Vector6::Zero();  ///< before it
};

/// Returns the retreat burn after a drift of `delay` s (>= 0) from these elements. Its distance includes the minimum
/// during that drift.
Result<DelayedRetreat> find_delayed_retreat(const orbit::QnsElements& servicer_mean, const Vector6& a_roe_m,
                                            double delay, const RetreatSettings& settings);

/// Returns the probability of collision over the horizon after the burn; `covariance_m2` is that of the mean ROE times
/// a at the burn.
Result<DriftProbability> retreat_probability(const DelayedRetreat& retreat, const Matrix6& covariance_m2,
                                             const RetreatSettings& settings);

}  // namespace vbar::fsw::safety
