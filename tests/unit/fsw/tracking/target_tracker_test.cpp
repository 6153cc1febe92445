// The tracker among other satellites, false detections and hot pixels.

#include "fsw/tracking/target_tracker.h"

#include <gtest/gtest.h>

#include "tests/unit/fsw/tracking/scene.h"

namespace {

using namespace vbar::fsw;
using namespace vbar::fsw::tracking;
using namespace vbar::testing;

SceneSettings far_scene(std::uint64_t seed) {
  SceneSettings settings;
  settings.seed = seed;
  // 8 km further behind with another relative eccentricity and inclination; and one that leaves the field in minutes.
  Vector6 follower;
  follower << -1800.0, -83000.0, 900.0, -700.0, 800.0, 900.0;
  Vector6 crosser;
  crosser << 9000.0, -60000.0, 9000.0, 4000.0, -9000.0, 7000.0;
  settings.decoys_a_roe_m = {follower, crosser};
  return settings;
}

TEST(TargetTracker, PicksTheTargetInEveryConfirmedImage) {
  RunResult all;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    TargetTracker tracker;
    SceneMaker maker(far_scene(seed));
    const RunResult run = run_tracker(tracker, maker, 180);
    EXPECT_EQ(run.wrong, 0) << "seed " << seed;
    EXPECT_GT(run.confirmed, 0.9 * run.target_seen) << "seed " << seed << " first " << run.first_confirmed;
    all.target_seen += run.target_seen;
    all.confirmed += run.confirmed;
  }
  EXPECT_GT(all.confirmed, 0.9 * all.target_seen);
}

}  // namespace
