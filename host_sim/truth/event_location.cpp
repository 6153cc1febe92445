#include "host_sim/truth/event_location.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include <boost/math/tools/toms748_solve.hpp>

namespace vbar::truth {
namespace {

constexpr std::uintmax_t kMostEvaluations = 200;  // bisection alone would need fewer than 64

/// A time between half and one `resolution` beyond the change of sign, or `far` if that comes before.
double just_beyond(const std::function<double(double)>& g, double near, double far, double g_near, double g_far,
                   double resolution) {
  if (g_far == 0.0) return far;
  const bool forward = near < far;
  std::uintmax_t evaluations = kMostEvaluations;
  const auto close_enough = [&](double a, double b) { return std::abs(a - b) <= 0.5 * resolution; };
  using boost::math::tools::toms748_solve;
  const auto [low, high] = forward ? toms748_solve(g, near, far, g_near, g_far, close_enough, evaluations)
                                   : toms748_solve(g, far, near, g_far, g_near, close_enough, evaluations);
  return forward ? std::min(low + resolution, far) : std::max(high - resolution, far);
}

}  // namespace

std::optional<double> first_sign_change(const std::function<double(double)>& g, double from, double to, int samples,
                                        double resolution) {
  if (samples <= 0 || !(resolution > 0.0)) {
    throw std::invalid_argument("event location needs samples and a resolution above 0");
  }
  double near = from;
  double g_near = g(near);
  for (int i = 1; i <= samples; ++i) {
    const double far = i == samples ? to : from + (to - from) * i / samples;
    const double g_far = g(far);
    if (std::isnan(g_far) || std::isnan(g_near)) throw std::invalid_argument("the event function is not a number");
    const bool changed = (g_near < 0.0 && g_far >= 0.0) || (g_near > 0.0 && g_far <= 0.0);
    if (changed) return just_beyond(g, near, far, g_near, g_far, resolution);
    near = far;
    g_near = g_far;
  }
  return std::nullopt;
}

}  // namespace vbar::truth
