#pragma once
// State blocks of differences of code and carrier phase between two receivers. Those without a process are constants,
// or are reset at each epoch.

#include "fsw/estimation/gauss_markov.h"

namespace vbar::fsw::measurements {

/// Signals whose phases are tracked at once.
inline constexpr int kPhaseChannelCount = 56;

/// Offset of an antenna from its nominal phase centre, body axes, m.
struct ServicerAntenna {
  static constexpr int kSize = 3;
};
struct TargetAntenna {
  static constexpr int kSize = 3;
};

/// Jitter of the pair of phase centres, reset at each epoch, ECI, m.
struct PhaseCentreJitter {
  static constexpr int kSize = 3;
};

/// Clock of the target minus that of the servicer, reset at each epoch, m.
struct ClockDifference {
  static constexpr int kSize = 1;
  static constexpr bool kDeterminesOrbit = true;
};

/// Biases of the codes of GPS L2, Galileo E1, BeiDou B1I over GPS L1, m.
struct CodeBiases {
  static constexpr int kSize = 3;
};

/// Vertical group delay of L1 by the electrons above the servicer, m, and its change along the track and the orbit
/// normal, m per 1000 km.
struct Ionosphere : estimation::GaussMarkovBlock<Ionosphere, 3> {
  static constexpr estimation::GaussMarkov kDefaults{.sigma = 0.5, .time_s = 1800.0};
};

/// Ambiguities of single differences, m.
struct Ambiguities {
  static constexpr int kSize = kPhaseChannelCount;
};

/// Time-correlated errors of single differences of phase, m.
struct PhaseWander : estimation::GaussMarkovBlock<PhaseWander, kPhaseChannelCount> {
  static constexpr estimation::GaussMarkov kDefaults{.sigma = 0.0, .time_s = 1.0};
};

}  // namespace vbar::fsw::measurements
