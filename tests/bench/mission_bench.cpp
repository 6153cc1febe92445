// Whole missions in process, with the share of each part, and one step of the flight software.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include "fsw/messaging/vbar_gnc.h"
#include "host_sim/campaign_report/page.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/simulation/assembly.h"
#include "host_sim/simulation/flight_computer.h"
#include "host_sim/simulation/run_truth.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/campaign_report/synthetic_campaign.h"

namespace {

namespace app = vbar::app;
namespace mission = vbar::mission;
namespace sensors = vbar::sensors;

const std::string kRoot = vbar::tests::source_path();

mission::Mission load(const char* name) {
  return sensors::load_mission(kRoot + "/missions/" + name + ".toml");
}

void fly(const mission::Mission& mission, std::span<app::RunObserver* const> observers,
         vbar::report::RunRecord& record) {
  const auto computer = app::connect_flight_computer(app::flying_spacecraft(mission));
  vbar::engine::SteadyWallClock wall;
  app::AssembledMission(mission, kRoot + "/data").fly({*computer, wall, observers, {}, {}}, record);
}

void whole_mission(benchmark::State& state, const char* name) {
  const mission::Mission mission = load(name);
  vbar::report::Summary::WallShare sum;
  for (auto _ : state) {
    vbar::report::RunRecord record;
    fly(mission, {}, record);
    const auto& share = record.summary.wall_share;
    sum.truth_s += share.truth_s;
    sum.flight_s += share.flight_s;
    sum.link_s += share.link_s;
    sum.other_s += share.other_s;
  }
  const auto mean = [](double total) { return benchmark::Counter(total, benchmark::Counter::kAvgIterations); };
  state.counters["truth_s"] = mean(sum.truth_s);
  state.counters["flight_s"] = mean(sum.flight_s);
  state.counters["link_s"] = mean(sum.link_s);
  state.counters["other_s"] = mean(sum.other_s);
}

/// Inputs of the flight software, step by step.
class InputKeeper final : public app::RunObserver {
 public:
  struct Step {
    std::int64_t time_ns;
    std::vector<vbar::pil::Packet> inputs;
  };
  void on_step(std::uint32_t, vbar::fsw::GpsTime time, std::span<const vbar::pil::Packet> inputs,
               std::span<const vbar::pil::Packet>) override {
    steps.push_back({time.ns, {inputs.begin(), inputs.end()}});
  }
  std::vector<Step> steps;
};

class FlightSoftware {
 public:
  FlightSoftware() : memory_(vbar_gnc_state_size() + vbar_gnc_state_alignment()) {
    void* start = memory_.data();
    std::size_t room = memory_.size();
    state_ = std::align(vbar_gnc_state_alignment(), vbar_gnc_state_size(), start, room);
    vbar_gnc_init(
        state_, 1, [](void*, const std::uint8_t*, std::size_t) {}, nullptr);
  }
  void step(const InputKeeper::Step& step) {
    for (const vbar::pil::Packet& packet : step.inputs) vbar_gnc_receive(state_, packet.data(), packet.size());
    vbar_gnc_step(state_, step.time_ns);
  }

 private:
  std::vector<std::byte> memory_;
  void* state_;
};

/// The mean step of the whole mission on recorded inputs: packets in, telemetry out, all planning included.
void gnc_step(benchmark::State& state, const char* name) {
  InputKeeper recording;
  const std::array<app::RunObserver*, 1> observers{&recording};
  vbar::report::RunRecord record;
  fly(load(name), observers, record);
  for (auto _ : state) {
    state.PauseTiming();
    FlightSoftware flight;
    state.ResumeTiming();
    for (const InputKeeper::Step& step : recording.steps) flight.step(step);
  }
  state.counters["step"] = benchmark::Counter(static_cast<double>(recording.steps.size() * state.iterations()),
                                              benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// An hour of a swarm with its files, by number of spacecraft and of threads.
void propagate_swarm(benchmark::State& state) {
  const std::vector<std::string> overrides{"mission.duration_h=1",
                                           "spacecraft.swarm.count=" + std::to_string(state.range(0)),
                                           "truth.threads=" + std::to_string(state.range(1))};
  const mission::Mission mission = sensors::load_mission(kRoot + "/missions/swarm_of_fifty.toml", overrides);
  const std::filesystem::path out =
      std::filesystem::temp_directory_path() / ("vbar_swarm_bench_" + std::to_string(::getpid()));
  for (auto _ : state) {
    app::Propagation propagation(mission, kRoot + "/data");
    vbar::report::PropagationFolder folder(out, mission.name);
    folder.start_files(propagation.names(), nullptr);
    folder.finish(
        propagation.run([&](std::size_t k, const vbar::report::EphemerisRow& row) { folder.append(k, row); }, {}, {}));
  }
  std::filesystem::remove_all(out);
}

BENCHMARK(propagate_swarm)
    ->Name("truth/vbar/swarm")
    ->ArgsProduct({{50, 255, 1000}, {1, 2}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK_CAPTURE(whole_mission, ideal, "ideal_navigation")
    ->Name("mission/ideal_navigation")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(whole_mission, experiment3, "experiment3")
    ->Name("mission/experiment3")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(whole_mission, experiment2, "experiment2")
    ->Name("mission/experiment2")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(gnc_step, ideal, "ideal_navigation")->Name("gnc/vbar/step")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(gnc_step, experiment3, "experiment3")
    ->Name("gnc/vbar/step_experiment3")
    ->Unit(benchmark::kMillisecond);

}  // namespace

// The page of a campaign: from campaign.json and results.csv on disk to campaign.html on disk, by number of cases.

namespace {

void write_page(benchmark::State& state) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("vbar_campaign_page_" + std::to_string(::getpid()));
  vbar::campaign_report::test::write_synthetic_campaign(
      folder, {.cases = static_cast<std::size_t>(state.range(0)), .failed_share = 0.02});
  for (auto _ : state) vbar::campaign::write_page(folder);
  state.counters["page_bytes"] = static_cast<double>(std::filesystem::file_size(folder / "campaign.html"));
  std::filesystem::remove_all(folder);
}
BENCHMARK(write_page)->Name("campaign_report/page")->Arg(100)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);

}  // namespace
