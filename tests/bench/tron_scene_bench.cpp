// The laboratory drawn with all parts of the gap: mock-up at two ranges, calibration board; the sensor apart.

#include <benchmark/benchmark.h>

#include "hil_drivers/tron/bench/scene/lab_renderer.h"
#include "tests/unit/hil_drivers/tron/bench/scene/lab_scenes.h"

namespace {

namespace bench = vbar::tron::bench;

void draw(benchmark::State& state, double distance_m, bool is_board, bool is_read) {
  bench::LabRenderer renderer(bench::tests::tron_bench(), {}, 1, vbar::tests::source_path("data"));
  bench::LabView view = bench::tests::view_of(distance_m, bench::tests::some_attitude());
  view.arms = {{{6.7, -0.3, 1.0}, {7.0, 0.0, 0.5}, 0.08}};
  if (is_board) {
    view.T_L_board = view.T_L_T;
    view.T_L_board->linear() = view.T_L_C.linear();
  }
  for (auto _ : state) {
    ++view.frame;
    if (is_read)
      benchmark::DoNotOptimize(renderer.expose(view));
    else
      benchmark::DoNotOptimize(renderer.expected(view).electrons.data());
  }
}
BENCHMARK_CAPTURE(draw, near, 2.5, false, false)
    ->Name("tron/scene/mock_up_2.5m")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(draw, far, 4.5, false, false)
    ->Name("tron/scene/mock_up_4.5m")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(draw, read, 2.5, false, true)
    ->Name("tron/scene/mock_up_2.5m_read")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(draw, board, 2.5, true, false)
    ->Name("tron/scene/board_2.5m")
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace
