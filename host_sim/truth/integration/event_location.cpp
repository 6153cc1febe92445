#include "host_sim/truth/integration/event_location.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>

namespace vbar::truth {
namespace {

using Function = std::function<double(double)>;

constexpr std::uintmax_t kMaxEvaluations = 200;  // bisection alone would need fewer than 64

struct Sample {
  double time;
  double g;
};

Sample sampled(const Function& g, double time) {
  const double value = g(time);
  if (std::isnan(value)) throw std::invalid_argument("the event function is not a number");
  return {time, value};
}

/// A time between half and one `resolution` beyond the change of sign, or that of `far` if it comes before.
double just_beyond(const Function& g, const Sample& near, const Sample& far, double resolution) {
  if (far.g == 0.0) return far.time;
  const bool forward = near.time < far.time;
  const Sample& low = forward ? near : far;
  const Sample& high = forward ? far : near;
  std::uintmax_t evaluations = kMaxEvaluations;
  const auto close_enough = [&](double a, double b) { return std::abs(a - b) <= 0.5 * resolution; };
  const auto [begin, end] =
      boost::math::tools::toms748_solve(g, low.time, high.time, low.g, high.g, close_enough, evaluations);
  return forward ? std::min(begin + resolution, far.time) : std::max(end - resolution, far.time);
}

/// The minimum between three equally spaced samples, if it may reach zero.
std::optional<Sample> bottom_of_dip(const Function& g, const Sample& a, const Sample& b, const Sample& c) {
  // The parabola through the samples, x = -1, 0, 1; its vertex may lie a quarter outside (an approximation).
  constexpr double kFarthest = 1.25;
  const double slope = 0.5 * (c.g - a.g);
  const double curvature = c.g - 2.0 * b.g + a.g;
  if (!(curvature > 0.0 && std::abs(slope) < kFarthest * curvature)) return std::nullopt;
  const double vertex = b.g - 0.5 * slope * slope / curvature;
  const double spread = std::max({a.g, b.g, c.g}) - std::min({a.g, b.g, c.g});
  if (vertex > spread) return std::nullopt;
  // The minimum is found to half the digits of a double, the resolution of a smooth minimum; relative to the middle
  // sample, so that they are digits of the spacing and not of the date.
  constexpr int kBits = std::numeric_limits<double>::digits / 2;
  std::uintmax_t evaluations = kMaxEvaluations;
  const double spacing = std::abs(c.time - b.time);
  const auto [offset, value] = boost::math::tools::brent_find_minima(
      [&](double from_middle) { return g(b.time + from_middle); }, -spacing, spacing, kBits, evaluations);
  return Sample{b.time + offset, value};
}

}  // namespace

std::optional<double> first_exit(const Function& g, double from, double to, int samples, double resolution) {
  if (samples <= 0 || !(resolution > 0.0)) {
    throw std::invalid_argument("event location needs samples and a resolution above 0");
  }
  const int pairs = (samples + 1) / 2;
  const auto time_at = [&](int half) { return half == 2 * pairs ? to : from + (to - from) * half / (2 * pairs); };
  Sample a = sampled(g, from);
  a.g = std::max(a.g, std::numeric_limits<double>::min());
  for (int pair = 0; pair < pairs; ++pair) {
    const Sample b = sampled(g, time_at(2 * pair + 1));
    if (b.g <= 0.0) return just_beyond(g, a, b, resolution);
    const Sample c = sampled(g, time_at(2 * pair + 2));
    if (c.g <= 0.0) return just_beyond(g, b, c, resolution);
    const std::optional<Sample> bottom = bottom_of_dip(g, a, b, c);
    if (bottom && bottom->g <= 0.0) return just_beyond(g, a, *bottom, resolution);
    a = c;
  }
  return std::nullopt;
}

std::optional<double> first_sign_change(const Function& g, double from, double to, int samples, double resolution) {
  if (samples <= 0) throw std::invalid_argument("event location needs samples and a resolution above 0");
  double at_start = sampled(g, from).g;
  if (at_start == 0.0) at_start = g(from + (to - from) / samples);
  const double side = at_start < 0.0 ? -1.0 : 1.0;
  return first_exit([&](double t) { return side * g(t); }, from, to, samples, resolution);
}

}  // namespace vbar::truth
