// RSI of two robots: a document each way, and whole cycles on the virtual clock between two threads, as driver and
// emulator have them. A run of 1,619 images has some 250 cycles an image.

#include <thread>

#include <benchmark/benchmark.h>

#include "hil_drivers/tron/bench/controller/cycle_clock.h"
#include "hil_drivers/tron/eki/client/client.h"
#include "hil_drivers/tron/robot/robot_files.h"
#include "hil_drivers/tron/rsi/client/client.h"
#include "hil_drivers/tron/rsi/wire/codec.h"
#include "host_sim/mission/data_directory.h"

namespace {

using namespace vbar::tron;
using namespace std::chrono_literals;

rsi::Rob example_rob() {
  rsi::Rob rob;
  rob.cartesian = {1595.1234, -12.0, 435.5678, 12.3456, 90.0, -179.9999};
  rob.axes_deg = {1.25, -90.1234, 90.4321, 0.0, 45.0, 349.9999};
  rob.external_mm[0] = -1234.5678;
  rob.ipoc = {"4208163634", 4208163634U};
  return rob;
}

rsi::Sen example_sen() {
  rsi::Sen sen;
  sen.type = "VBAR";
  sen.stop = false;
  sen.axes_deg = {1.25, -90.1234, 90.4321, 0.0, 45.0, 349.9999};
  sen.track_mm = -1234.5678;
  sen.ipoc = "4208163634";
  return sen;
}

void rsi_state_encode(benchmark::State& state) {
  const rsi::EthernetXml ethernet = robot_files(kCameraRobot).ethernet;
  std::string text;
  for (auto step : state) benchmark::DoNotOptimize(rsi::encode(example_rob(), ethernet, 4, text));
}
BENCHMARK(rsi_state_encode);

void rsi_state_decode(benchmark::State& state) {
  const rsi::EthernetXml ethernet = robot_files(kCameraRobot).ethernet;
  rsi::Decoder decoder(ethernet);
  rsi::Rob rob;
  std::string text;
  if (!rsi::encode(example_rob(), ethernet, 4, text)) state.SkipWithError("not encoded");
  for (auto step : state) benchmark::DoNotOptimize(decoder.decode(text, rob));
}
BENCHMARK(rsi_state_decode);

void rsi_answer_encode_decode(benchmark::State& state) {
  const rsi::EthernetXml ethernet = robot_files(kCameraRobot).ethernet;
  rsi::Decoder decoder(ethernet);
  rsi::Sen sen = example_sen();
  std::string text;
  for (auto step : state) {
    benchmark::DoNotOptimize(rsi::encode(example_sen(), ethernet, text));
    benchmark::DoNotOptimize(decoder.decode(text, sen));
  }
}
BENCHMARK(rsi_answer_encode_decode);

bench::ControllerSettings controller_of(const BenchFile& bench_file, const char* name, std::uint16_t port) {
  const bool is_camera = std::string_view(name) == kCameraRobot;
  const rsi::RobotFiles files = robot_files(name);
  bench::ControllerSettings settings{name, is_camera ? bench_file.camera_robot : bench_file.target_robot, std::nullopt,
                                     files.ethernet, files.context};
  if (is_camera) settings.track = bench_file.track;
  settings.ethernet.address = "127.0.0.1";
  settings.ethernet.port = port;
  settings.flange_pose = [](const rsi::AxisPositions& positions) {
    return bench::CartesianPose{positions.track_m, 0.0, 0.0, 0.0, 0.0, 0.0};
  };
  return settings;
}

rsi::ClientSettings client_of(const BenchFile& bench_file, const char* name) {
  const bool is_camera = std::string_view(name) == kCameraRobot;
  auto settings = rsi::client_settings(name, is_camera ? bench_file.camera_robot : bench_file.target_robot,
                                       is_camera ? &bench_file.track : nullptr, robot_files(name));
  settings.port = 0;
  return settings;
}

/// Two robots in a thread, which both answer; a cycle of bench time an iteration.
class TwoRobots {
 public:
  explicit TwoRobots(bench::ClockKind kind)
      : bench_file_(read_bench_file(vbar::mission::data_directory() / "benches" / "tron.toml")),
        clients{rsi::Client(client_of(bench_file_, kCameraRobot)), rsi::Client(client_of(bench_file_, kTargetRobot))},
        camera(context_, controller_of(bench_file_, kCameraRobot, clients[0].port())),
        target(context_, controller_of(bench_file_, kTargetRobot, clients[1].port())),
        clock(context_, {kind, 60s, true}, {&camera, &target}) {
    clock.start();
    thread_ = std::thread([this] { context_.run(); });
    for (bench::Controller* controller : {&camera, &target}) {
      const auto& line = controller->settings().robot.line;
      vbar::tron::eki::Client eki({controller->settings().name, line.address, controller->eki_port()});
      (void)eki.start();
    }
  }
  ~TwoRobots() { stop(); }
  TwoRobots(const TwoRobots&) = delete;
  TwoRobots& operator=(const TwoRobots&) = delete;

  bool cycle() {
    for (rsi::Client& client : clients)
      if (!client.receive(10s)) return false;
    for (rsi::Client& client : clients) client.answer(client.zero());
    return true;
  }
  void stop() {
    context_.stop();
    if (thread_.joinable()) thread_.join();
  }

 private:
  BenchFile bench_file_;
  boost::asio::io_context context_;

 public:
  std::array<rsi::Client, 2> clients;
  bench::Controller camera, target;
  bench::CycleClock clock;

 private:
  std::thread thread_;
};

void rsi_cycle_of_two_robots(benchmark::State& state) {
  TwoRobots robots(bench::ClockKind::kVirtual);
  for (auto step : state)
    if (!robots.cycle()) state.SkipWithError("a robot is silent");
  robots.stop();
  if (robots.camera.statistics().cycles_without_answer != 0) state.SkipWithError("an answer is missing");
}
BENCHMARK(rsi_cycle_of_two_robots)->UseRealTime()->Unit(benchmark::kMicrosecond);

/// Figures of the real clock over 30,000 cycles (two minutes): answers within 1 ms of the request, and Delay.
void rsi_real_clock(benchmark::State& state) {
  TwoRobots robots(bench::ClockKind::kReal);
  for (auto step : state)
    if (!robots.cycle()) state.SkipWithError("a robot is silent");
  robots.stop();
  double answers = 0.0, in_time = 0.0, delay = 0.0;
  for (const bench::Controller* controller : {&robots.camera, &robots.target}) {
    const bench::ControllerStatistics& counts = controller->statistics();
    answers += static_cast<double>(counts.answers);
    in_time += static_cast<double>(counts.answers_within_1ms);
    delay += static_cast<double>(counts.cycles_without_answer);
    state.counters[controller->settings().name + "_longest_ms"] = 1e3 * counts.max_answer_time_s;
  }
  state.counters["within_1ms_percent"] = 100.0 * in_time / answers;
  state.counters["delay"] = delay;
  state.counters["overruns"] = static_cast<double>(robots.clock.overruns());
}
BENCHMARK(rsi_real_clock)->Iterations(30000)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
