#pragma once
// The hot loop of the gravity field: three harmonic series summed over degree, four orders at a time. Two builds of one
// source, for SSE2 (every x86-64; plain vectors elsewhere) and for AVX2; lanes never mix and no product is fused with a
// sum, so both give the same bits.

#include <vector>

namespace vbar::truth {

/// One term of four neighbouring orders m at the same k = n - m.
struct alignas(32) FourTerms {
  double recursion[4];        ///< c_k of p_k = z p_(k-1) - q c_k p_(k-2)
  double x_cos[4], x_sin[4];  ///< factors of cos(m longitude), sin(m longitude) in the x component
  double y_cos[4], y_sin[4];
  double z_cos[4], z_sin[4];
};

/// The series as the loop reads them.
struct HarmonicSeries {
  std::vector<int> lengths;      ///< number of terms, k = 0, 1, ..., of each block of four orders; above 0
  std::vector<FourTerms> terms;  ///< the blocks, one after the other
};

/// Evaluation point: (R/r^2) (x, y, z) and q = (R/r)^2, dimensionless.
struct HarmonicPoint {
  double x, y, z, q;
};

/// Components of the sum, dimensionless.
struct HarmonicSum {
  double x, y, z;
};

using HarmonicSummation = HarmonicSum (*)(const HarmonicSeries&, const HarmonicPoint&);

HarmonicSum sum_harmonics_portable(const HarmonicSeries& series, const HarmonicPoint& point);

/// Returns the fastest build this processor runs.
HarmonicSummation fastest_harmonic_summation();

#if defined(__x86_64__)
/// Sums with AVX2, only where the processor has AVX2.
HarmonicSum sum_harmonics_avx2(const HarmonicSeries& series, const HarmonicPoint& point);
#endif

}  // namespace vbar::truth
