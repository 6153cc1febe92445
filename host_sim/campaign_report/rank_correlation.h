#pragma once
// Whether two quantities of a case go together: Spearman's rank correlation, and Holm's correction where many pairs are
// tested at once.

#include <cstddef>
#include <optional>
#include <vector>

namespace vbar::campaign_report {

/// Ranks from 1; equal values share the mean of their ranks.
[[nodiscard]] std::vector<double> ranks(const std::vector<double>& values);

struct RankCorrelation {
  double rho = 0.0;      ///< -1 to 1
  double p_value = 1.0;  ///< two-sided, of independent quantities, by Student's t with n - 2 degrees of freedom
  std::size_t count = 0;
};

/// Returns the p value of a rank correlation of `count` > 2 pairs.
[[nodiscard]] double spearman_p_value(double rho, std::size_t count);

/// Fewer pairs do not support the approximation of the p value.
inline constexpr std::size_t kMinPairs = 10;

/// Returns the rank correlation of the pairs in which both values are finite; empty if these are fewer than kMinPairs,
/// or one quantity is constant. Both vectors have the same size.
[[nodiscard]] std::optional<RankCorrelation> spearman(const std::vector<double>& x, const std::vector<double>& y);

/// p values adjusted for their number (Holm, 1979), in the same order: those below a level are significant with at most
/// that probability of even one false one, whatever their dependence.
[[nodiscard]] std::vector<double> holm(const std::vector<double>& p_values);

}  // namespace vbar::campaign_report
