#pragma once
// Input and output of every control solver.
//
// All algebra is in dimensionless mean ROE of the target (deputy) with respect to the servicer (chief). The solvers
// assume a manoeuvring deputy; a plan's burns are already those of the servicer: dv_servicer = -dv_deputy, in the
// servicer's RTN.

#include <array>
#include <cstddef>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::control {

inline constexpr std::size_t kMaxBurns = 32;

/// The solver that made a plan: kNone, or kId of an entry of the solver list (solver_list.h).
enum class Solver : signed char { kNone = -1 };

/// Defines when thrust is allowed (attitude, camera, eclipse); without a function, always.
struct ThrustWindows {
  bool (*allowed)(const void* context, GpsTime time) = nullptr;
  const void* context = nullptr;
};

/// Holds an impulse of the servicer, m/s in its RTN frame at `time`.
struct Burn {
  GpsTime time;
  Vector3 dv_rtn = Vector3::Zero();
};

/// Holds burns in order of time.
struct Plan {
  std::array<Burn, kMaxBurns> burns{};
  std::size_t count = 0;
  Solver solver = Solver::kNone;

  /// Returns the burns; the plan must outlive the span.
  [[nodiscard]] std::span<const Burn> all() const { return {burns.data(), count}; }

  /// Returns the sum of the norms of the burns, m/s.
  [[nodiscard]] double total_dv() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < count; ++k) sum += burns[k].dv_rtn.norm();
    return sum;
  }
};

/// States the problem of a solver: change the ROE from their free drift to the desired ones, by impulses in [start,
/// arrival].
struct ControlProblem {
  GpsTime start;                     ///< earliest burn, epoch of servicer_mean
  GpsTime arrival;                   ///< waypoint time
  orbit::QnsElements servicer_mean;  ///< mean elements of the servicer at `start`
  /// Desired change of the mean ROE at `arrival` beyond the free drift (the paper's pseudo-state w), dimensionless.
  Vector6 pseudo_state = Vector6::Zero();
};

// Checks that every solver applies before it starts.

/// Returns kOk if the problem is in the domain of the maps of mean ROE: 0 <= e < 0.9, sin i > 1e-6, perigee above the
/// ground, arrival at or after the start and at most 30 days later; else kOutOfRange. kNotFinite for a NaN or an
/// infinity.
Status check_problem(const ControlProblem& problem);

}  // namespace vbar::fsw::control
