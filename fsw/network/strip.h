#pragma once
// Sums of a convolution in registers wider than four numbers, which x86 has.
//
// Every sum is its bias, then the products in the order of the weights file, each product and each sum rounded: what
// four lanes compute (convolution.cpp), bit by bit. FMA, which these processors have too, rounds once and is not used.

#include <cstddef>

namespace vbar::fsw::network {

/// A row of output cells, a multiple of eight, and all their channels, a multiple of four.
struct Strip {
  const float* first = nullptr;  ///< first channel under the first cell's kernel
  std::ptrdiff_t row_step = 0;
  std::ptrdiff_t cell_step = 0;        ///< from one output cell to the next
  int rows = 0;                        ///< rows of the kernel
  int run = 0;                         ///< values of a kernel's row: its columns and their channels are contiguous
  const std::byte* weights = nullptr;  ///< weights of the layer, as the file has them
  const std::byte* biases = nullptr;
  int cells = 0;
  int channels = 0;
  float* sums = nullptr;  ///< [cell][channel]
};

#if defined(__x86_64__)
/// Computes the sums on a processor that has AVX2.
void sum_strip_avx2(const Strip& strip);
/// Computes the sums on a processor that has AVX-512 F.
void sum_strip_avx512(const Strip& strip);
#endif

}  // namespace vbar::fsw::network
