#pragma once
// How well any unbiased navigation could know the target's orbit: Cramer and Rao's bound from all bearings, with the
// dynamics, the servicer's orbit and its burns known exactly. What a filter is worse by, it or its models lose.

#include <vector>

#include "tests/integration/angles_only/true_flight.h"

namespace vbar::test {

struct BoundSettings {
  double bearing_sigma = 12.0 / 206264.8;  ///< rad
  double resolved_share = 0.25;            ///< of the apparent radius, as the filter takes it
  double bias_sigma = 3.0 / 206264.8;      ///< rad, each axis, constant; 0: none
  fsw::Vector6 prior_sigma_a_roe_m = (fsw::Vector6() << 30.0, 1000.0, 200.0, 200.0, 200.0, 200.0).finished();
};

/// 1 sigma of the length of the relative position's error, m, at each of `epochs` (indices, increasing), from the lit
/// bearings up to and with it. The target never burns, so its orbit has six unknowns; slopes by central differences
/// over the whole arc in the on-board gravity field.
std::vector<double> position_bound(const TrueFlight& flight, const std::vector<std::size_t>& epochs,
                                   const BoundSettings& settings = {});

}  // namespace vbar::test
