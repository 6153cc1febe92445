#pragma once
// The ratio test with fixed failure rate (Teunissen and Verhagen 2009, "The GNSS ambiguity ratio-test revisited"): how
// much farther than the best the second-best integers must be, so that strong models are accepted early and weak ones
// are not accepted wrongly.

#include <cstddef>

namespace vbar::fsw::gnss {

/// Largest part of all problems in which wrong integers are accepted, if their covariance is correct.
inline constexpr double kFixFailureRate = 1e-3;

/// Failure rate of the weakest models of the table.
inline constexpr double kLargestModelFailureRate = 0.1;

/// Returns the smallest ratio second_norm2 / best_norm2 to accept, at least 1, for 1 <= count <= kMaxAmbiguities
/// ambiguities of a model on which bootstrapping fails at the given rate (1 - success rate). Infinity, which no ratio
/// reaches, beyond kLargestModelFailureRate and for an invalid rate or count.
double ratio_threshold(std::size_t count, double model_failure_rate);

}  // namespace vbar::fsw::gnss
