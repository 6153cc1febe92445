#pragma once
// Whether a filter's claims agree with its errors: means of chi-square distributed figures (NEES, NIS) against the band
// that contains the mean of this number of independent samples with a probability of 95 %.

#include <cstddef>
#include <optional>
#include <string>

#include "host_sim/report/html_page.h"
#include "host_sim/report/plot_axis.h"

namespace vbar::report {

/// The central 95 % of chi-square with `degrees` (> 0) degrees of freedom.
[[nodiscard]] Range chi_square_band(double degrees);

/// Returns the band of the mean of `samples` (> 0) independent draws.
[[nodiscard]] Range mean_band(double degrees, std::size_t samples);

/// The mean beside its expectation and band, set off if it is outside; a dash without a mean, no band without samples.
[[nodiscard]] Fact consistency_fact(const std::string& name, const std::optional<double>& mean, double degrees,
                                    std::size_t samples);

/// Explanation of the bands for the reader, as HTML.
inline constexpr const char* kBandNote =
    "<p class=\"note\">95 % bands of NEES and NIS are those of a mean of independent chi-square samples. Successive "
    "errors of a filter are correlated, so that the mean of a consistent filter leaves its band more often.</p>\n";

}  // namespace vbar::report
