#include "host_sim/truth/forces/harmonic_sum.h"

#include <cstring>

namespace vbar::truth {
namespace {

using TwoLanes = double __attribute__((vector_size(16)));
using FourLanes = double __attribute__((vector_size(32)));

/// Sums over k of p_k times the six factors, for the orders in the lanes of `Lanes`, left in `sums` lane by lane:
/// sums[component][lane]. Always inlined, so that it takes the instruction set of its caller.
template <class Lanes>
[[gnu::always_inline]] inline void sum_over_degree(const FourTerms* first, const FourTerms* end, int first_lane,
                                                   const HarmonicPoint& point, double (&sums)[6][4]) {
  const Lanes z = Lanes{} + point.z;
  const Lanes q = Lanes{} + point.q;
  Lanes x_cos{}, x_sin{}, y_cos{}, y_sin{}, z_cos{}, z_sin{};
  Lanes p = Lanes{} + 1.0;
  Lanes before{};
  const auto add = [&](Lanes & sum, const double(&factors)[4]) __attribute__((always_inline)) {
    Lanes factor;
    std::memcpy(&factor, factors + first_lane, sizeof factor);
    sum += p * factor;
  };
  for (const FourTerms* term = first;;) {
    add(x_cos, term->x_cos);
    add(x_sin, term->x_sin);
    add(y_cos, term->y_cos);
    add(y_sin, term->y_sin);
    add(z_cos, term->z_cos);
    add(z_sin, term->z_sin);
    if (++term == end) break;
    Lanes recursion;
    std::memcpy(&recursion, term->recursion + first_lane, sizeof recursion);
    const Lanes next = z * p - (q * recursion) * before;
    before = p;
    p = next;
  }
  std::memcpy(sums[0] + first_lane, &x_cos, sizeof x_cos);
  std::memcpy(sums[1] + first_lane, &x_sin, sizeof x_sin);
  std::memcpy(sums[2] + first_lane, &y_cos, sizeof y_cos);
  std::memcpy(sums[3] + first_lane, &y_sin, sizeof y_sin);
  std::memcpy(sums[4] + first_lane, &z_cos, sizeof z_cos);
  std::memcpy(sums[5] + first_lane, &z_sin, sizeof z_sin);
}

template <class Lanes>
[[gnu::always_inline]] inline HarmonicSum sum_over_order(const HarmonicSeries& series, const HarmonicPoint& point) {
  constexpr int kWidth = sizeof(Lanes) / sizeof(double);
  HarmonicSum total{0.0, 0.0, 0.0};
  double cos_m = 1.0, sin_m = 0.0;  // ((R/r) cos(latitude))^m times cos and sin of m longitude
  const FourTerms* term = series.terms.data();
  for (const int length : series.lengths) {
    double sums[6][4];
    for (int lane = 0; lane < 4; lane += kWidth) sum_over_degree<Lanes>(term, term + length, lane, point, sums);
    for (int lane = 0; lane < 4; ++lane) {
      total.x += cos_m * sums[0][lane] + sin_m * sums[1][lane];
      total.y += cos_m * sums[2][lane] + sin_m * sums[3][lane];
      total.z += cos_m * sums[4][lane] + sin_m * sums[5][lane];
      const double next_cos = cos_m * point.x - sin_m * point.y;
      sin_m = cos_m * point.y + sin_m * point.x;
      cos_m = next_cos;
    }
    term += length;
  }
  return total;
}

}  // namespace

HarmonicSum sum_harmonics_portable(const HarmonicSeries& series, const HarmonicPoint& point) {
  return sum_over_order<TwoLanes>(series, point);
}

#if defined(__x86_64__)

[[gnu::target("avx2")]] HarmonicSum sum_harmonics_avx2(const HarmonicSeries& series, const HarmonicPoint& point) {
  return sum_over_order<FourLanes>(series, point);
}

HarmonicSummation fastest_harmonic_summation() {
  return __builtin_cpu_supports("avx2") != 0 ? sum_harmonics_avx2 : sum_harmonics_portable;
}

#else

HarmonicSummation fastest_harmonic_summation() {
  return sum_harmonics_portable;
}

#endif

}  // namespace vbar::truth
