// Paths that are free, that need a detour, and that there are none of. Judged by finer samples than the planner's.

#include "hil_drivers/tron/motion/path_planner.h"

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/paths.h"

namespace vbar::tron {
namespace {

BenchFile bench() {
  return read_bench_file(tests::source_path("data/benches/tron.toml"));
}

Posture home(const BenchFile& file) {
  return {Joints::Map(file.camera_robot.home_rad.data()), Joints::Map(file.target_robot.home_rad.data()),
          file.track.home_m};
}

void expect_free(const Path& path, const BenchBodies& bodies) {
  for (int cycle = 0; cycle <= path.cycles(); ++cycle)
    ASSERT_EQ(bodies.collision(bodies.at(path.at(cycle)), 0.8 * bodies.clearance_m()), "") << cycle;
}

TEST(TronPathPlanner, TheHomePostureIsFreeAlongTheTrack) {
  const BenchFile file = bench();
  const BenchBodies bodies(file);
  const PathPlanner planner(file, bodies);
  Posture to = home(file);
  to.carriage_m = 3.0;
  const auto path = planner.plan(home(file), to);
  ASSERT_TRUE(std::holds_alternative<Path>(path)) << std::get<NoPath>(path).reason;
  expect_free(std::get<Path>(path), bodies);
}

TEST(TronPathPlanner, GoesOverARetractedPostureWhereTheStraightPathIsBlocked) {
  const BenchFile file = bench();
  const BenchBodies bodies(file);
  const PathPlanner planner(file, bodies);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto drawn = [&] {
    Posture at = home(file);
    for (int k = 0; k < 6; ++k) {
      at.camera_rad[k] += 0.9 * uniform(random);
      at.target_rad[k] += 0.9 * uniform(random);
    }
    at.target_rad[0] = 2.8 * uniform(random);
    at.carriage_m = 5.8 + 0.5 * uniform(random);
    return at;
  };
  int detours = 0;
  for (int n = 0; n < 3000 && detours < 5; ++n) {
    const Posture from = drawn(), to = drawn();
    if (!bodies.is_free(bodies.at(from)) || !bodies.is_free(bodies.at(to)) || planner.is_straight_free(from, to))
      continue;
    const auto path = planner.plan(from, to);
    if (!std::holds_alternative<Path>(path)) continue;
    ++detours;
    expect_free(std::get<Path>(path), bodies);
    EXPECT_EQ(std::get<Path>(path).end().target_rad, to.target_rad);
    EXPECT_EQ(std::get<Path>(path).end().camera_rad, to.camera_rad);
  }
  EXPECT_GT(detours, 0);
}

TEST(TronPathPlanner, RefusesEndsThatCannotBe) {
  const BenchFile file = bench();
  const BenchBodies bodies(file);
  const PathPlanner planner(file, bodies);
  const auto reason = [&](const Posture& to) {
    const auto path = planner.plan(home(file), to);
    return std::holds_alternative<NoPath>(path) ? std::get<NoPath>(path).reason : "";
  };
  Posture to = home(file);
  to.camera_rad[0] = 3.1;
  EXPECT_NE(reason(to).find("limit of the camera's arm"), std::string::npos);
  to = home(file);
  to.carriage_m = 7.6;
  EXPECT_NE(reason(to).find("beyond the track"), std::string::npos);
  to = home(file);
  to.camera_rad[3] = 3.0;
  to.camera_rad[5] = 4.0;
  EXPECT_NE(reason(to).find("cable"), std::string::npos);
  to = home(file);
  to.target_rad = Joints(0.0, 0.7, 0.5, 0.0, 0.0, 0.0);  // into the floor
  EXPECT_NE(reason(to).find("closer than"), std::string::npos);
  to = home(file);
  to.carriage_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(reason(to).find("not finite"), std::string::npos);
  const auto from_nowhere = planner.plan(to, home(file));
  EXPECT_TRUE(std::holds_alternative<NoPath>(from_nowhere));
}

}  // namespace
}  // namespace vbar::tron
