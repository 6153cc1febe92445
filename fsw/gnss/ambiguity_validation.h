#pragma once
// Selection of the float ambiguities that may be held to integers. Integers are accepted if
//   the model is strong:  bootstrapping succeeds with the required probability (Teunissen 1998);
//   they are distinct:    the second-best are farther by the ratio that keeps wrong fixes below kFixFailureRate
//                        , and by a fixed ratio against covariances that are too small;
//   they fit:             their squared distance from the float solution is plausible for a chi-square variable.
// If not all can be accepted, the worst one is left out and the others are tried again, down to a smallest useful set.
// More than kMaxAmbiguities are reduced first to the most precise given each other; once these are held, the covariance
// of the others in the filter shrinks and a further call resolves them.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/result.h"
#include "fsw/gnss/lambda.h"

namespace vbar::fsw::gnss {

// Tail probability of the chi-square distribution, in closed form for integer degrees of freedom.

/// Returns the probability that a chi-square variable of `degrees` >= 1 degrees of freedom exceeds x >= 0 (Abramowitz
/// and Stegun, 26.4.4 and 26.4.5). The sum has `degrees` terms; the relative error is about 1e-15 times degrees.
double chi_square_tail(double x, std::size_t degrees);

// The ratio test with fixed failure rate (Teunissen and Verhagen 2009, "The GNSS ambiguity ratio-test revisited"): how
// much farther than the best the second-best integers must be, so that strong models are accepted early and weak ones
// are not accepted wrongly.

/// Largest part of all problems in which wrong integers are accepted, if their covariance is correct.
inline constexpr double kFixFailureRate = 1e-3;

/// Failure rate of the weakest models of the table.
inline constexpr double kLargestModelFailureRate = 0.1;

/// Returns the smallest ratio second_norm2 / best_norm2 to accept, at least 1, for 1 <= count <= kMaxAmbiguities
/// ambiguities of a model on which bootstrapping fails at the given rate (1 - success rate). Infinity, which no ratio
/// reaches, beyond kLargestModelFailureRate and for an invalid rate or count.
double ratio_threshold(std::size_t count, double model_failure_rate);

/// Largest number of double differences that a filter may carry; 80 observations have fewer.
inline constexpr std::size_t kMaxFloatAmbiguities = 80;

struct ValidationCriteria {
  double min_success_rate = 0.9;       ///< smallest success rate by bootstrapping; 1 - kLargestModelFailureRate or more
  double min_ratio = 2.0;              ///< smallest ratio of squared norms, second-best to best, for any model
  double residual_false_alarm = 1e-4;  ///< probability that correct integers are rejected for their residual
  std::size_t min_count = 4;           ///< fewer double differences do not fix a baseline
};

/// Rejection reason of the ambiguities that are not held.
enum class RejectionReason : std::uint8_t {
  kNone = 0,
  kTooFew,    ///< fewer ambiguities than min_count
  kWeak,      ///< success rate too small
  kNotApart,  ///< ratio too small
  kNoFit,     ///< residual too large
  kSearch,    ///< the search reached its bound, or the covariance is not positive definite
};

struct AmbiguityDecision {
  std::size_t count = 0;  ///< number to be held; 0: none, the float solution remains
  /// Ambiguities to be held, as indices in the caller's vector, increasing, and their integers.
  std::array<std::uint8_t, kMaxAmbiguities> position{};
  std::array<double, kMaxAmbiguities> whole{};
  RejectionReason rejection_reason = RejectionReason::kNone;  ///< the first one met while reducing the set
  // Criteria of the set that is held, or of the last set considered.
  double success_rate = 0.0;
  double ratio = 0.0;     ///< at most 1e9
  double residual = 0.0;  ///< squared norm of the integers, chi-square with the size of the set if they are correct
  std::size_t tried = 0;  ///< number of sets tried
};

/// Memory of a decision, too large for a small stack; holds no state between calls.
struct ValidationWorkspace {
  Decorrelation decorrelation;
  std::array<double, kMaxAmbiguities> floats{};
  std::array<double, kMaxAmbiguities * kMaxAmbiguities> covariance{};
  std::array<double, kMaxAmbiguities * kMaxAmbiguities> information{};
  std::array<double, kMaxAmbiguities * kMaxFloatAmbiguities> factor{};
};

/// Decides on `ambiguities`, n floats, cycles, n <= kMaxFloatAmbiguities, with `covariance`, n x n, cycles^2,
/// column-major, lower triangle read. kInvalidArgument for sizes or criteria that make no sense, kNotFinite.
Result<AmbiguityDecision> decide_ambiguities(std::span<const double> ambiguities, std::span<const double> covariance,
                                             const ValidationCriteria& criteria, ValidationWorkspace& workspace);

}  // namespace vbar::fsw::gnss
