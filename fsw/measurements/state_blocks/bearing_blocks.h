#pragma once
// State blocks of bearings: errors of the camera and of the centroid of the target's light.

#include "fsw/estimation/gauss_markov.h"

namespace vbar::fsw::measurements {

/// Error of bearings among stars, in the rows of bearing_axes(), rad. Default sigma: 3 arcsec.
struct BearingBias : estimation::GaussMarkovBlock<BearingBias, 2> {
  static constexpr estimation::GaussMarkov kDefaults{.sigma = 1.5e-5, .time_s = 43200.0};
};

/// Distance of the centre of brightness from the centre of mass, towards the Sun, m.
struct BrightnessOffset : estimation::GaussMarkovBlock<BrightnessOffset, 1> {
  static constexpr estimation::GaussMarkov kDefaults{.sigma = 0.15, .time_s = 20000.0};
};

/// Displacement of the centre of brightness towards the Earth's centre, by light that the Earth reflects, m. It is in
/// the orbital plane whatever the Sun's direction: left out, it is taken for a change of the distance.
struct EarthlightOffset : estimation::GaussMarkovBlock<EarthlightOffset, 1> {
  static constexpr estimation::GaussMarkov kDefaults{.sigma = 0.05, .time_s = 100000.0};
};

/// Wander of the centroid of a resolved shape, in the rows of bearing_axes(), m.
struct CentroidWander {
  static constexpr int kSize = 2;
  using Settings = estimation::GaussMarkov;
  static constexpr Settings kDefaults{.sigma = 0.05, .time_s = 2000.0};
  /// Factor on the variance of the settings, where a source has measured it.
  struct Adaptation {
    double variance_factor = 1.0;
  };

  template <class State>
  static void propagate(estimation::Estimate<State::kSize>& estimate, const Settings& settings,
                        const Adaptation& adaptation, const estimation::BlockStep& step) {
    estimation::GaussMarkov process = settings;
    process.sigma *= math::sqrt(adaptation.variance_factor);
    estimation::propagate_components<State, CentroidWander>(estimate, process, step);
  }
};

}  // namespace vbar::fsw::measurements
