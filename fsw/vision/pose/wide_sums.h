#pragma once
// Sums of a strip in registers of any width, for source files that are compiled for wide ones. All functions have
// internal linkage, and nothing of the standard library is called: a function that other files compile as well could be
// linked from here, with instructions that another processor lacks.

#include "fsw/vision/pose/convolution.h"

namespace vbar::fsw::pose {
namespace {

template <int kLanes>
struct Register;
template <>
struct Register<4> {
  typedef float type __attribute__((vector_size(16)));
};
template <>
struct Register<8> {
  typedef float type __attribute__((vector_size(32)));
};
template <>
struct Register<16> {
  typedef float type __attribute__((vector_size(64)));
};

/// Sums of kCells neighbouring cells, kGroups times kLanes channels from `channel` on: that many sums stay in
/// registers.
template <int kLanes, int kGroups, int kCells>
inline void sum_block(const Strip& strip, int cell, int channel) {
  using Lanes = typename Register<kLanes>::type;
  const auto load = [](const std::byte* from) {
    Lanes x;
    __builtin_memcpy(&x, from, sizeof x);
    return x;
  };
  const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(sizeof(float)) * channel;
  const std::ptrdiff_t weights_step = static_cast<std::ptrdiff_t>(sizeof(float)) * strip.channels;
  const std::byte* weights = strip.weights + offset;

  Lanes sums[static_cast<std::size_t>(kGroups)][static_cast<std::size_t>(kCells)];
  for (int group = 0; group < kGroups; ++group) {
    const Lanes bias = load(strip.biases + offset + group * static_cast<int>(sizeof(Lanes)));
    for (int c = 0; c < kCells; ++c) sums[group][c] = bias;
  }
  for (int row = 0; row < strip.rows; ++row) {
    const float* in = strip.first + row * strip.row_step + cell * strip.cell_step;
    for (int i = 0; i < strip.run; ++i) {
      Lanes w[static_cast<std::size_t>(kGroups)];
      for (int group = 0; group < kGroups; ++group) w[group] = load(weights + group * static_cast<int>(sizeof(Lanes)));
      for (int c = 0; c < kCells; ++c) {
        const float x = in[c * strip.cell_step];
        for (int group = 0; group < kGroups; ++group) sums[group][c] = sums[group][c] + w[group] * x;
      }
      ++in;
      weights += weights_step;
    }
  }
  for (int c = 0; c < kCells; ++c) {
    float* const to = strip.sums + static_cast<std::ptrdiff_t>(cell + c) * strip.channels + channel;
    for (int group = 0; group < kGroups; ++group) __builtin_memcpy(to + group * kLanes, &sums[group][c], sizeof(Lanes));
  }
}

/// Computes as many channels from `channel` on as are whole groups; returns the next channel.
template <int kLanes, int kGroups, int kCells>
inline int sum_channels(const Strip& strip, int channel) {
  constexpr int kWidth = kLanes * kGroups;
  for (; channel + kWidth <= strip.channels; channel += kWidth) {
    for (int cell = 0; cell < strip.cells; cell += kCells) sum_block<kLanes, kGroups, kCells>(strip, cell, channel);
  }
  return channel;
}

}  // namespace
}  // namespace vbar::fsw::pose
