#include "fsw/vision/pose/convolution.h"

#include <cstring>

#include "fsw/vision/pose/architecture.h"
#include "fsw/vision/pose/lanes.h"

namespace vbar::fsw::pose {

namespace {

constexpr int kBlockCells = 4;

/// Four lanes of each of four neighbouring cells. Written out, not an array with a loop over it, so that it stays in
/// registers independent of the compiler's loop optimisation.
struct Cells {
  Lanes a, b, c, d;
};

/// Inputs of a block of output.
struct Window {
  const float* first = nullptr;  ///< first channel under the first cell's kernel
  std::ptrdiff_t row_step = 0;
  std::ptrdiff_t cell_step = 0;  ///< from one output cell to the next
  int rows = 0;                  ///< rows of the kernel
  int run = 0;                   ///< values of a kernel's row: its columns and their channels are contiguous
};

/// Sums of four cells, kGroups times four channels.
template <int kGroups>
struct Block {
  Cells groups[static_cast<std::size_t>(kGroups)];
};

/// Lane k of the cells with four channels' weights.
template <int k>
inline void add_products(Cells& sums, Lanes w, const Cells& x) {
  sums.a = add_product<k>(sums.a, w, x.a);
  sums.b = add_product<k>(sums.b, w, x.b);
  sums.c = add_product<k>(sums.c, w, x.c);
  sums.d = add_product<k>(sums.d, w, x.d);
}

template <int k>
inline void add_products(Block<1>& block, const float* weights, const Cells& x) {
  add_products<k>(block.groups[0], load(weights), x);
}

template <int k>
inline void add_products(Block<2>& block, const float* weights, const Cells& x) {
  add_products<k>(block.groups[0], load(weights), x);
  add_products<k>(block.groups[1], load(weights + kLanes), x);
}

/// The sums are passed by value to avoid stores in the loop because of possible aliasing. `weights` in the
/// panel's order. The run must be a multiple of four.
template <int kGroups>
inline Block<kGroups> add_window(Block<kGroups> block, const Window& window, const float* weights) {
  constexpr int kStep = kGroups * kLanes;
  const std::ptrdiff_t step = window.cell_step;
  for (int row = 0; row < window.rows; ++row) {
    const float* in = window.first + row * window.row_step;
    for (int i = 0; i < window.run; i += kLanes) {
      const Cells x{load(in), load(in + step), load(in + 2 * step), load(in + 3 * step)};
      add_products<0>(block, weights, x);
      add_products<1>(block, weights + kStep, x);
      add_products<2>(block, weights + 2 * kStep, x);
      add_products<3>(block, weights + 3 * kStep, x);
      in += kLanes;
      weights += kLanes * kStep;
    }
  }
  return block;
}

/// Computes the sums of the first layer, whose single channel does not fill four lanes.
template <int kGroups>
inline Block<kGroups> add_grey_window(Block<kGroups> block, const Window& window, const float* weights) {
  const std::ptrdiff_t step = window.cell_step;
  for (int row = 0; row < window.rows; ++row) {
    const float* in = window.first + row * window.row_step;
    for (int i = 0; i < window.run; ++i) {
      const Cells x{all(in[0]), all(in[step]), all(in[2 * step]), all(in[3 * step])};
      add_products<0>(block, weights, x);
      ++in;
      weights += kGroups * kLanes;
    }
  }
  return block;
}

template <int kGroups>
Block<kGroups> block_of(const Window& window, const WeightPanel& panel) {
  Block<kGroups> biases;
  for (int group = 0; group < kGroups; ++group) {
    const Lanes bias = load(panel.biases.data() + group * kLanes);
    biases.groups[group] = {bias, bias, bias, bias};
  }
  return window.run % kLanes == 0 ? add_window(biases, window, panel.weights.data())
                                  : add_grey_window(biases, window, panel.weights.data());
}

/// Puts the weights of kGroups times four channels from `channel` on side by side.
template <int kGroups>
void fill_panel(const Layer& layer, std::span<const std::byte> weights, int channel, WeightPanel& panel) {
  constexpr std::size_t kWidth = kGroups * kLanes * sizeof(float);
  const std::size_t row_bytes = static_cast<std::size_t>(layer.out) * sizeof(float);
  const std::byte* from = weights.data() + static_cast<std::size_t>(channel) * sizeof(float);
  float* to = panel.weights.data();
  for (int row = 0; row < layer.kernel * layer.kernel * layer.in; ++row) {
    std::memcpy(to, from, kWidth);
    from += row_bytes;
    to += kGroups * kLanes;
  }
  std::memcpy(panel.biases.data(), from, kWidth);
}

template <int kGroups, class Sink>
void convolve_channels(const Layer& layer, const FeatureMap& in, int channel, const WeightPanel& panel,
                       const Sink& sink) {
  const int margin = layer.kernel / 2;
  const int side = in.side / layer.stride;
  Window window{.row_step = in.row_step(),
                .cell_step = static_cast<std::ptrdiff_t>(layer.stride) * in.channels,
                .rows = layer.kernel,
                .run = layer.kernel * in.channels};
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; column += kBlockCells) {
      window.first = in.cell(row * layer.stride - margin, column * layer.stride - margin);
      const Block<kGroups> block = block_of<kGroups>(window, panel);
      for (int group = 0; group < kGroups; ++group) {
        const Cells& sums = block.groups[group];
        const int first = channel + group * kLanes;
        sink(row, column, first, sums.a);
        sink(row, column + 1, first, sums.b);
        sink(row, column + 2, first, sums.c);
        sink(row, column + 3, first, sums.d);
      }
    }
  }
}

/// By four lanes, which every target has.
template <class Sink>
void convolve_by_panels(const Layer& layer, std::span<const std::byte> weights, const FeatureMap& in,
                        WeightPanel& panel, const Sink& sink) {
  int channel = 0;
  for (; channel + 2 * kLanes <= layer.out; channel += 2 * kLanes) {
    fill_panel<2>(layer, weights, channel, panel);
    convolve_channels<2>(layer, in, channel, panel, sink);
  }
  for (; channel < layer.out; channel += kLanes) {
    fill_panel<1>(layer, weights, channel, panel);
    convolve_channels<1>(layer, in, channel, panel, sink);
  }
}

#if defined(__x86_64__)

constexpr std::size_t kMaxSumsOfRow = [] {
  std::size_t most = 0;
  int side = kInputSide;
  for (const Layer& layer : kLayers) {
    side /= layer.stride;
    const auto sums = static_cast<std::size_t>(side) * static_cast<std::size_t>(layer.out);
    most = sums > most ? sums : most;
    if (!layer.is_rectified) side *= 2;
  }
  return most;
}();

/// By wider registers, a row at a time.
template <class Sink>
void convolve_by_strips(const Layer& layer, std::span<const std::byte> weights, const FeatureMap& in,
                        Registers registers, const Sink& sink) {
  const auto sum_strip = registers == Registers::kSixteen ? &sum_strip_avx512 : &sum_strip_avx2;
  const int margin = layer.kernel / 2;
  const int side = in.side / layer.stride;
  alignas(64) std::array<float, kMaxSumsOfRow> sums;
  Strip strip{.row_step = in.row_step(),
              .cell_step = static_cast<std::ptrdiff_t>(layer.stride) * in.channels,
              .rows = layer.kernel,
              .run = layer.kernel * in.channels,
              .weights = weights.data(),
              .biases = weights.data() + layer.weights() * sizeof(float),
              .cells = side,
              .channels = layer.out,
              .sums = sums.data()};
  for (int row = 0; row < side; ++row) {
    strip.first = in.cell(row * layer.stride - margin, -margin);
    sum_strip(strip);
    const float* from = sums.data();
    for (int column = 0; column < side; ++column) {
      for (int channel = 0; channel < layer.out; channel += kLanes, from += kLanes) {
        sink(row, column, channel, load(from));
      }
    }
  }
}

#endif

/// `sink(row, column, first channel, four channels)` receives the complete convolution.
template <class Sink>
void convolve(const Layer& layer, std::span<const std::byte> weights, const FeatureMap& in, WeightPanel& panel,
              Registers registers, const Sink& sink) {
#if defined(__x86_64__)
  if (registers != Registers::kFour) return convolve_by_strips(layer, weights, in, registers, sink);
#else
  static_cast<void>(registers);
#endif
  convolve_by_panels(layer, weights, in, panel, sink);
}

}  // namespace

void convolve_rectified(const Layer& layer, std::span<const std::byte> weights, const FeatureMap& in,
                        const FeatureMap& out, WeightPanel& panel, Registers registers) {
  convolve(layer, weights, in, panel, registers, [&out](int row, int column, int channel, Lanes x) {
    store(out.cell(row, column) + channel, where_above(x, kMinActivation));
  });
}

void convolve_and_add_enlarged(const Layer& layer, std::span<const std::byte> weights, const FeatureMap& in,
                               const FeatureMap& sum_map, WeightPanel& panel, Registers registers) {
  convolve(layer, weights, in, panel, registers, [&sum_map](int row, int column, int channel, Lanes x) {
    for (int part = 0; part < 4; ++part) {
      float* const place = sum_map.cell(2 * row + part / 2, 2 * column + part % 2) + channel;
      store(place, where_beyond(sum(load(place), x), kMinActivation));
    }
  });
}

void convolve_to_maps(const Layer& layer, std::span<const std::byte> weights, const FeatureMap& in,
                      std::span<std::array<float, kMapCells>> maps, WeightPanel& panel, Registers registers) {
  convolve(layer, weights, in, panel, registers, [&](int row, int column, int channel, Lanes x) {
    const std::size_t place = static_cast<std::size_t>(row * in.side + column);
    for (int lane = 0; lane < kLanes; ++lane) {
      const auto map = static_cast<std::size_t>(channel + lane);
      if (map < maps.size()) maps[map][place] = x[lane];
    }
  });
}

Registers widest_registers() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) return Registers::kSixteen;
  if (__builtin_cpu_supports("avx2")) return Registers::kEight;
#endif
  return Registers::kFour;
}

}  // namespace vbar::fsw::pose
