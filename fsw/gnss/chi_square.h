#pragma once
// Tail probability of the chi-square distribution, in closed form for integer degrees of freedom.

#include <cstddef>

namespace vbar::fsw::gnss {

/// Returns the probability that a chi-square variable of `degrees` >= 1 degrees of freedom exceeds x >= 0 (Abramowitz
/// and Stegun, 26.4.4 and 26.4.5). The sum has `degrees` terms; the relative error is about 1e-15 times degrees.
double chi_square_tail(double x, std::size_t degrees);

}  // namespace vbar::fsw::gnss
