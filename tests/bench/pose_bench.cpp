// What the pose network's front end costs beside the network itself: the search for the target, maps, the pose.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>

#include <benchmark/benchmark.h>

#include "fsw/vision/pose/heatmap.h"
#include "fsw/vision/pose/keypoint_network.h"
#include "fsw/vision/pose/pnp.h"
#include "fsw/vision/pose/target_finder.h"
#include "tests/support/tango_view.h"
#include "tests/unit/fsw/measurements/keypoint_flight.h"
#include "tests/unit/fsw/vision/pose/close_images.h"
#include "tests/unit/fsw/vision/pose/network_file.h"

namespace {

using namespace vbar;

void find_target(benchmark::State& state) {
  const auto pixels = test::CloseImage(1).box({}).stars_and_hot_pixels().expose();
  const auto finder = std::make_unique<fsw::pose::TargetFinder>();
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        finder->find(test::view_of(pixels, test::kCloseWidth, test::kCloseHeight), {64.0, test::kCloseNoiseDn, 4000}));
  }
}

/// Eleven maps with nothing in them, the worst case: no cell is too low to count.
void read_maps(benchmark::State& state) {
  std::array<float, fsw::pose::kMapCells> map{};
  map[500] = 3.0F;
  for (auto _ : state) {
    for (int k = 0; k < 11; ++k) benchmark::DoNotOptimize(fsw::pose::read_map(map, 1.0));
  }
}

void solve(benchmark::State& state) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<fsw::pose::Keypoints> problems;
  for (int n = 0; n < 50; ++n) {
    problems.push_back(test::seen_keypoints(test::random_pose(random, 5.0, 13.0), 1.0, 1.0, random));
    for (std::size_t k = 0; k < static_cast<std::size_t>(state.range(0)); ++k) {
      problems.back()[(3 * k) % 11].pixel += 50.0 * fsw::Vector2(uniform(random), uniform(random));
    }
  }
  std::size_t n = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        fsw::pose::solve_pnp(problems[n++ % problems.size()], test::tango_shape(), test::close_camera(), {}, 1));
  }
}

BENCHMARK(find_target)->Name("pose/find_target/vbar/800x500")->Unit(benchmark::kMicrosecond);
BENCHMARK(read_maps)->Name("pose/maps/vbar/11")->Unit(benchmark::kMicrosecond);
BENCHMARK(solve)->Name("pose/pnp/vbar/outliers")->Arg(0)->Arg(1)->Arg(3)->Arg(5)->Unit(benchmark::kMicrosecond);

}  // namespace

// What one run of the keypoint network costs, on one thread: with four lanes, as on a flight computer, with wider
// registers where this computer has them, and beside OpenCV's, which takes the widest as well, and contracts products
// and sums, which flight code does not.

#ifdef VBAR_HAVE_OPENCV
#include "tests/support/opencv_network.h"
#endif

namespace {

using namespace vbar::fsw::pose;

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

// Keypoints as an aid of the filter: what 5 s between images and an image's eleven keypoints cost.

namespace {

using fsw::measurements::KeypointFlight;

constexpr int kSettling = 60;
constexpr int kImages = 60;

void image(benchmark::State& state) {
  const test::CloseFlight flight = test::fly_closely(0.2);
  KeypointFlight flown(flight, {.has_dark = false}, 1.0, 1, fsw::measurements::flight_blocks(flight),
                       fsw::measurements::flight_settings());
  for (int k = 0; k < kSettling; ++k) flown.step();
  if (!flown.filter->has_attitude()) std::abort();
  std::vector<test::MeasuredEpoch> epochs;
  std::vector<fsw::pose::Keypoints> keypoints;
  for (int k = 0; k < kImages; ++k) {
    epochs.push_back(flown.network.measure(flown.next++));
    keypoints.push_back(*epochs.back().keypoints);
  }
  for (auto _ : state) {
    state.PauseTiming();
    const auto filter = std::make_unique<fsw::filter::RelativeNavigationFilter>(*flown.filter);
    const auto aiding = std::make_unique<fsw::measurements::KeypointAiding>(*flown.aiding);
    state.ResumeTiming();
    for (std::size_t k = 0; k < epochs.size(); ++k) {
      filter->advance_to(epochs[k].time, {});
      aiding->process({.time = epochs[k].time,
                       .camera = flown.camera,
                       .sun_eci = epochs[k].sun_eci,
                       .R_camera_eci = epochs[k].R_camera_eci,
                       .keypoints = &keypoints[k],
                       .pnp = epochs[k].pnp},
                      *filter);
    }
    benchmark::DoNotOptimize(filter->roe());
  }
  state.counters["image"] = benchmark::Counter(static_cast<double>(kImages * state.iterations()),
                                               benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(image)->Name("keypoints/vbar/image")->Unit(benchmark::kMillisecond);

}  // namespace
