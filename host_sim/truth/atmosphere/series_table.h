#pragma once
// Several series in the horizontal functions, summed side by side: four lanes of a row share each function's value.

#include <array>
#include <cstring>

#include "host_sim/truth/atmosphere/horizontal_basis.h"

namespace vbar::truth {

/// Table of `kCount` series in the first `kFunctions` functions.
template <int kCount, int kFunctions>
class SeriesTable {
 public:
  void set(int index, const HorizontalSeries& series) {
    for (int k = 0; k < kFunctions; ++k) blocks_[index / kLanes][k].lanes[index % kLanes] = series[k];
  }

  std::array<double, kCount> sums(const HorizontalSeries& functions) const {
    std::array<std::array<double, kLanes>, kBlocks> all{};
    for (int block = 0; block < kBlocks; ++block) sum_block(blocks_[block], functions, all[block].data());
    std::array<double, kCount> result{};
    std::memcpy(result.data(), all.data(), sizeof result);
    return result;
  }

 private:
  using TwoLanes = double __attribute__((vector_size(16)));
  static constexpr int kLanes = 4;
  static constexpr int kBlocks = (kCount + kLanes - 1) / kLanes;

  struct alignas(16) Row {
    double lanes[kLanes];
  };
  using Block = std::array<Row, kFunctions>;

  static void sum_block(const Block& block, const HorizontalSeries& functions, double* sums) {
    TwoLanes low{}, high{}, low_odd{}, high_odd{};  // even and odd functions apart: shorter chains of additions
    const auto add = [&](int k, TwoLanes& a, TwoLanes& b) {
      TwoLanes rows[2];
      std::memcpy(rows, block[k].lanes, sizeof rows);
      a += rows[0] * functions[k];
      b += rows[1] * functions[k];
    };
    int k = 0;
    for (; k + 1 < kFunctions; k += 2) {
      add(k, low, high);
      add(k + 1, low_odd, high_odd);
    }
    if (k < kFunctions) add(k, low, high);
    const TwoLanes both[2] = {low + low_odd, high + high_odd};
    std::memcpy(sums, both, sizeof both);
  }

  std::array<Block, kBlocks> blocks_{};
};

}  // namespace vbar::truth
