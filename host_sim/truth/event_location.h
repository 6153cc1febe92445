#pragma once
// When a function of time changes sign: shadow edges, apsides, anything an integration must stop at.

#include <functional>
#include <optional>

namespace vbar::truth {

/// The first change of sign of `g` going from `from` to `to` (either direction), seen at `samples` (> 0) equal parts
/// and located to `resolution` (> 0, in the unit of time) by the TOMS 748 bracketing method (Alefeld, Potra, Shi 1995).
/// The time returned lies on the far side of the change, so that a search resumed from there does not find it again; a
/// zero at `from` itself does not count. Nothing if no sample shows a change. Throws std::invalid_argument for samples
/// or resolution not above 0 and for a `g` that is not a number.
std::optional<double> first_sign_change(const std::function<double(double)>& g, double from, double to, int samples,
                                        double resolution);

}  // namespace vbar::truth
