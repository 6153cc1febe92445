#pragma once
// When a function of time changes sign: shadow edges, apsides, any event at which an integration must stop.

#include <functional>
#include <optional>

namespace vbar::truth {

/// Returns the first time after `from` (up to `to`, either direction) at which `g` is no longer positive. It counts as
/// positive at `from` regardless of rounding, so that an edge just located is not found again. The function is sampled
/// in `samples` (> 0, rounded up to even) equal parts; it may have one extremum in any two of them. A dip below zero
/// between samples is found however short it is, if the parabola through the samples comes near zero: the minimum is
/// then searched (Brent's method). The change is located to `resolution` (> 0, in the unit of time) by the TOMS 748
/// bracketing method (Alefeld, Potra, Shi 1995); the time returned lies on its far side. Throws std::invalid_argument
/// for samples or resolution not above 0 and for a `g` that is not a number.
std::optional<double> first_exit(const std::function<double(double)>& g, double from, double to, int samples,
                                 double resolution);

/// Returns the first change of sign of `g`, searched and located as by first_exit(); a zero at `from` itself does not
/// count.
std::optional<double> first_sign_change(const std::function<double(double)>& g, double from, double to, int samples,
                                        double resolution);

}  // namespace vbar::truth
