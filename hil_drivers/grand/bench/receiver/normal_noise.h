#pragma once
// Normal noise for the hot loop: the numbers of an engine::RandomStream through a table of the normal quantile. Cubic
// interpolation deviates from the quantile by at most 3e-5; the outer 3 % are computed exactly.

#include <array>
#include <cstdint>
#include <string_view>

#include "host_sim/engine/distributions.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::grand::bench {

/// Quantile of the standard normal distribution at p = (bits + 1/2)/2^64.
class NormalTable {
 public:
  static const NormalTable& instance();

  [[nodiscard]] double quantile(std::uint64_t bits) const {
    const std::size_t cell = bits >> 56U;
    if (cell < kTail || cell >= kCells - kTail) return engine::normal_quantile(engine::open_unit_interval(bits));
    const double u = static_cast<double>((bits << 8U) >> 12U) * 0x1p-52;
    const std::array<double, 4>& c = cells_[cell];
    return ((c[3] * u + c[2]) * u + c[1]) * u + c[0];
  }

 private:
  static constexpr std::size_t kCells = 256;
  static constexpr std::size_t kTail = 4;
  NormalTable();
  std::array<std::array<double, 4>, kCells> cells_{};
};

class NormalNoise {
 public:
  NormalNoise(std::uint64_t seed, std::string_view name) : stream_(seed, name), table_(&NormalTable::instance()) {}

  double operator()() { return table_->quantile(stream_.bits()); }
  /// Returns a number uniform on (low, high), from the same stream.
  double uniform(double low, double high) { return stream_.uniform(low, high); }

 private:
  engine::RandomStream stream_;
  const NormalTable* table_;
};

}  // namespace vbar::grand::bench
