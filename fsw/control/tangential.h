#pragma once
// Magnitudes of tangential impulses at given times.

#include <array>
#include <cstddef>
#include <span>

#include "fsw/control/near_circular.h"
#include "fsw/core/result.h"

namespace vbar::fsw::control {

/// Largest number of times of a closed-form plan: two per orbit on the phase grid, for windows of up to 15 orbits.
inline constexpr std::size_t kMaxPhaseTimes = 32;

/// Holds a time at which a tangential impulse changes the eccentricity vector along the desired direction (+1) or
/// against
/// (-1).
struct PhaseTime {
  double offset = 0.0;  ///< s into the window
  double parity = 1.0;
};

struct PhaseTimes {
  std::array<PhaseTime, kMaxPhaseTimes> times{};
  std::size_t count = 0;

  [[nodiscard]] std::span<const PhaseTime> all() const { return {times.data(), count}; }
};

/// Returns all times within [0, window] at which `rate` * offset passes `phase` + m pi, the first kMaxPhaseTimes of
/// them. rate > 0.
PhaseTimes phase_times(double phase, double rate, double window);

/// Holds tangential impulses of the deputy.
struct TangentialBurns {
  static constexpr std::size_t kMax = 4;
  struct Impulse {
    double offset = 0.0;  ///< s into the window
    double dv = 0.0;      ///< m/s along T
  };
  std::array<Impulse, kMax> impulses{};
  std::size_t count = 0;

  /// Returns the sum of magnitudes, m/s.
  [[nodiscard]] double cost() const;
};

/// Returns the cheapest three impulses at times of the grid that achieve da, dlambda and |de|, the phase of de being
/// that of the grid: the exact optimum over the grid, since a basic solution of three equations has at most three
/// non-zeros (Chernick and D'Amico 2018). Among equally cheap ones the earliest is chosen. kSingular if the grid has
/// fewer than three times or only one parity.
Result<TangentialBurns> cheapest_three_burns(const TangentialTask& task, std::span<const PhaseTime> grid);

/// Returns the cheapest impulses (at most four) among `offsets` (s into the window) that achieve da, dlambda, dex and
/// dey, of any phase: the linear program min sum |x| by the revised simplex method. kSingular if the offsets cannot
/// meet the task.
Result<TangentialBurns> cheapest_four_burns(const NearCircularOrbit& orbit, const TangentialTask& task,
                                            std::span<const double> offsets);

}  // namespace vbar::fsw::control
