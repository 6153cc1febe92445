// What the plan of an image costs on TRON: inverse kinematics, beside Orocos KDL, collisions, a placement, a path.

#include <thread>

#include <benchmark/benchmark.h>

#include "emulators/tron/controller/cycle_clock.h"
#include "emulators/tron/scene/lab_renderer.h"
#include "hil_drivers/tron/protocols/eki.h"
#include "hil_drivers/tron/protocols/rsi_client.h"
#include "hil_drivers/tron/protocols/rsi_messages.h"
#include "hil_drivers/tron/robot/robot_files.h"
#include "host_sim/mission/data_file.h"
#include "tests/unit/emulators/tron/scene/lab_scenes.h"

#ifdef VBAR_HAVE_KDL
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#endif

#include "hil_drivers/tron/motion_planning/placement.h"
#include "tests/support/paths.h"

namespace {

using namespace vbar;
using namespace vbar::tron;

const TestbedDesign& tron_bench_file() {
  static const TestbedDesign file = read_testbed_design(tests::source_path("data/benches/tron.toml"));
  return file;
}

Posture posture() {
  return {Joints(0.1, -1.4, 1.2, 0.5, 0.7, -0.6), Joints(-0.2, -1.6, 1.5, -0.4, 0.8, 0.3), 3.0};
}

void inverse_vbar(benchmark::State& state) {
  const Arm arm(tron_bench_file().camera_robot.design);
  const Eigen::Isometry3d T = arm.forward(posture().camera_rad);
  for (auto _ : state) benchmark::DoNotOptimize(arm.inverse(T));
}
BENCHMARK(inverse_vbar)->Name("tron_inverse_8_branches/vbar");

#ifdef VBAR_HAVE_KDL
/// One branch, from joints 0.2 rad off.
void inverse_kdl(benchmark::State& state) {
  const ArmDesign& arm = tron_bench_file().camera_robot.design;
  const KDL::Vector x(1, 0, 0), z(0, 0, 1);
  using KDL::Frame;
  using KDL::Joint;
  using KDL::Segment;
  KDL::Chain chain;
  chain.addSegment(Segment(Joint(Joint::None), Frame(arm.d1_m * z)));
  chain.addSegment(Segment(Joint(KDL::Vector::Zero(), -z, Joint::RotAxis), Frame(arm.a1_m * x)));
  chain.addSegment(Segment(Joint(Joint::RotY), Frame(arm.a2_m * x)));
  chain.addSegment(Segment(Joint(Joint::RotY), Frame(arm.a3_m * z)));
  chain.addSegment(Segment(Joint(KDL::Vector::Zero(), -x, Joint::RotAxis), Frame(arm.d4_m * x)));
  chain.addSegment(Segment(Joint(Joint::RotY), Frame::Identity()));
  chain.addSegment(Segment(Joint(KDL::Vector::Zero(), -x, Joint::RotAxis), Frame(arm.d6_m * x)));
  KDL::ChainFkSolverPos_recursive forward(chain);
  KDL::ChainIkSolverPos_LMA inverse(chain);
  KDL::JntArray at(kJoints), from(kJoints), found(kJoints);
  at.data = posture().camera_rad;
  from.data = posture().camera_rad + 0.2 * Joints::Ones();
  KDL::Frame frame;
  forward.JntToCart(at, frame);
  for (auto _ : state) benchmark::DoNotOptimize(inverse.CartToJnt(from, frame, found));
}
BENCHMARK(inverse_kdl)->Name("tron_inverse_1_branch/kdl_lma");
#endif

void collision(benchmark::State& state) {
  const TestbedBodies bodies(tron_bench_file());
  for (auto _ : state) benchmark::DoNotOptimize(bodies.collision(bodies.at(posture())));
}
BENCHMARK(collision)->Name("tron_collision_of_a_posture");

/// From one scene to the next, 5 deg of tumbling away.
void placement(benchmark::State& state) {
  const TestbedBodies bodies(tron_bench_file());
  const PathPlanner paths(tron_bench_file(), bodies);
  const PlacementSearch search(tron_bench_file(), bodies, paths, bodies.points_to_see(tests::source_path("data")),
                               {.trials = static_cast<int>(state.range(0))});
  Posture at{Joints::Map(tron_bench_file().camera_robot.home_rad.data()),
             Joints::Map(tron_bench_file().target_robot.home_rad.data()), 4.0};
  std::int64_t number = 0;
  int taken = 0;
  for (auto _ : state) {
    Scene scene;
    const double spin = 0.09 * static_cast<double>(number);
    scene.T_C_T.linear() = (Eigen::AngleAxisd(spin, fsw::Vector3(0.3, 1.0, 0.2).normalized()) *
                            Eigen::AngleAxisd(2.4, fsw::Vector3::UnitX()))
                               .toRotationMatrix();
    scene.T_C_T.translation() << 0.02, -0.03, 3.0;
    scene.sun_C = fsw::Vector3(0.8, 0.3, -0.3).normalized();
    const auto found = search.find(scene, at, number++);
    if (const auto* placed = std::get_if<Placement>(&found)) {
      at = placed->posture;
      ++taken;
    }
  }
  state.counters["taken"] = static_cast<double>(taken) / static_cast<double>(number);
}
BENCHMARK(placement)->Name("tron_placement_of_an_image")->Arg(160)->Arg(400)->Unit(benchmark::kMillisecond);

}  // namespace

// RSI of two robots: a document each way, and whole cycles on the virtual clock between two threads, as driver and
// emulator have them. A run of 1,619 images has some 250 cycles an image.

namespace {

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

bench::ControllerSettings controller_of(const TestbedDesign& bench_file, const char* name, std::uint16_t port) {
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

rsi::ClientSettings client_of(const TestbedDesign& bench_file, const char* name) {
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
      : bench_file_(read_testbed_design(vbar::mission::data_directory() / "benches" / "tron.toml")),
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
  TestbedDesign bench_file_;
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

// The laboratory drawn with all parts of the gap: mock-up at two ranges, calibration board; the sensor apart.

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
