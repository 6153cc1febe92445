// What the plan of an image costs on TRON: inverse kinematics, beside Orocos KDL, collisions, a placement, a path.

#include <benchmark/benchmark.h>

#ifdef VBAR_HAVE_KDL
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#endif

#include "hil_drivers/tron/placement/placement.h"
#include "tests/support/paths.h"

namespace {

using namespace vbar;
using namespace vbar::tron;

const BenchFile& tron_bench_file() {
  static const BenchFile file = read_bench_file(tests::source_path("data/benches/tron.toml"));
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
  const BenchBodies bodies(tron_bench_file());
  for (auto _ : state) benchmark::DoNotOptimize(bodies.collision(bodies.at(posture())));
}
BENCHMARK(collision)->Name("tron_collision_of_a_posture");

/// From one scene to the next, 5 deg of tumbling away.
void placement(benchmark::State& state) {
  const BenchBodies bodies(tron_bench_file());
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
