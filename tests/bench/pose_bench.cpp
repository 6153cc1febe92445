// What the pose network's front end costs beside the network itself: the search for the target, maps, the pose.

#include <memory>
#include <random>

#include <benchmark/benchmark.h>

#include "fsw/pose/heatmap.h"
#include "fsw/pose/pnp.h"
#include "fsw/pose/target_finder.h"
#include "tests/support/tango_view.h"
#include "tests/unit/fsw/pose/close_images.h"

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
  std::array<float, fsw::network::kMapCells> map{};
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
