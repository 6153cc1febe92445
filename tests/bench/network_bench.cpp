// What one run of the keypoint network costs, on one thread: with four lanes, as on a flight computer, with wider
// registers where this computer has them, and beside OpenCV's, which takes the widest as well, and contracts products
// and sums, which flight code does not.

#include <algorithm>
#include <cmath>
#include <memory>

#include <benchmark/benchmark.h>

#include "fsw/network/keypoint_network.h"
#include "tests/unit/fsw/network/network_file.h"
#ifdef VBAR_HAVE_OPENCV
#include "tests/support/opencv_network.h"
#endif

namespace {

using namespace vbar::fsw::network;

std::unique_ptr<KeypointNetwork> network_on_board() {
  auto network = std::make_unique<KeypointNetwork>();
  if (network->load(weights_on_board()) != vbar::fsw::Status::kOk) return nullptr;
  return network;
}

void run_vbar(benchmark::State& state, Registers registers) {
  if (registers > widest_registers()) return state.SkipWithError("this computer has no such registers");
  const auto network = network_on_board();
  if (!network) return state.SkipWithError("the weights on board were refused");
  const vbar::test::Crop crop = vbar::test::structured_crop();
  for (auto _ : state) benchmark::DoNotOptimize(network->run(crop, registers));
}
BENCHMARK_CAPTURE(run_vbar, 4, Registers::kFour)->Name("network/vbar_4_lanes/128")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(run_vbar, 8, Registers::kEight)->Name("network/vbar_8_lanes/128")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(run_vbar, 16, Registers::kSixteen)->Name("network/vbar_16_lanes/128")->Unit(benchmark::kMillisecond);

void load_vbar(benchmark::State& state) {
  const auto network = std::make_unique<KeypointNetwork>();
  for (auto _ : state) benchmark::DoNotOptimize(network->load(weights_on_board()));
}
BENCHMARK(load_vbar)->Name("network_load/vbar/128")->Unit(benchmark::kMillisecond);

#ifdef VBAR_HAVE_OPENCV

void run_opencv(benchmark::State& state) {
  cv::setNumThreads(1);
  vbar::test::OpencvNetwork network(weights_on_board());
  const vbar::test::Crop crop = vbar::test::structured_crop();
  cv::Mat maps = network.run(crop);
  const auto vbar_network = network_on_board();
  if (!vbar_network || vbar_network->run(crop) != vbar::fsw::Status::kOk) {
    return state.SkipWithError("nothing to compare with");
  }
  const std::span<const float> logits = vbar_network->logits(3);
  for (std::size_t cell = 0; cell < kMapCells; ++cell) {
    if (std::abs(logits[cell] - maps.ptr<float>(0, 3)[cell]) > 1e-3F)
      return state.SkipWithError("not the same network");
  }
  for (auto _ : state) maps = network.run(crop);
}
BENCHMARK(run_opencv)->Name("network/opencv_dnn/128")->Unit(benchmark::kMillisecond);

#endif

}  // namespace
