#pragma once
// Mean <-> osculating elements: Brouwer's first-order J2 theory (Brouwer 1959; Schaub & Junkins, appendix F), with the
// term e eta^2/(1+eta) of the mean longitude that common implementations miss.

#include "fsw/orbit/elements.h"

namespace vbar::fsw::orbit {

/// Returns the osculating elements of mean ones. Long-period terms are dropped within 0.02 of the critical inclination
/// (|1 - 5 cos^2 i|). kOutOfRange for e >= 0.9, i within 1e-4 rad of 0 or pi.
Result<QnsElements> osculating_from_mean(const QnsElements& mean);

/// Returns the mean elements whose osculating image is `osculating`: fixed point of the forward map to 1e-12 (rad, and
/// relative in a). The returned u lies within pi of the given one. kDidNotConverge after 30 iterations.
Result<QnsElements> mean_from_osculating(const QnsElements& osculating);

}  // namespace vbar::fsw::orbit
