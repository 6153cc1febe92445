// The tracker among other satellites, false detections and hot pixels, from 75 km to 100 m: whatever it calls the
// target must be the target. True motion, images and prediction come from scene.h.

#include "fsw/tracking/target_tracker.h"

#include <gtest/gtest.h>

#include <functional>
#include <ostream>

#include "tests/unit/fsw/tracking/scene.h"

namespace {

using namespace vbar::fsw;
using namespace vbar::fsw::tracking;
using namespace vbar::testing;

Vector6 six(double a, double b, double c, double d, double e, double f) {
  Vector6 v;
  v << a, b, c, d, e, f;
  return v;
}

/// At waypoint 0, which is left at 3.2 m/s. One decoy 8 km further behind with another relative eccentricity and
/// inclination; one that leaves the field in minutes.
SceneSettings far_scene() {
  SceneSettings settings;
  settings.decoys_a_roe_m = {six(-1800.0, -83000.0, 900.0, -700.0, 800.0, 900.0),
                             six(9000.0, -60000.0, 9000.0, 4000.0, -9000.0, 7000.0)};
  return settings;
}

/// At waypoint 1 of the mission.
SceneSettings fifty_kilometres() {
  SceneSettings settings;
  settings.target_a_roe_m = six(-87.0, -50000.0, 0.0, 1000.0, 0.0, 1000.0);
  settings.sigma_a_roe_m = six(10.0, 600.0, 100.0, 100.0, 100.0, 100.0);
  settings.decoys_a_roe_m = {six(-60.0, -58000.0, 600.0, -300.0, -500.0, 700.0),
                             six(6000.0, -40000.0, 9000.0, 4000.0, -9000.0, 7000.0)};
  return settings;
}

/// Between waypoints 3 and 4, where the relative eccentricity is a tenth of the distance and more: the bearing moves by
/// half a degree an image, the range by a fifth within an orbit.
SceneSettings five_kilometres() {
  SceneSettings settings;
  settings.target_a_roe_m = six(-120.0, -5000.0, 0.0, 500.0, 0.0, 500.0);
  settings.sigma_a_roe_m = six(1.0, 60.0, 5.0, 5.0, 5.0, 5.0);
  settings.refined = 0.3;
  settings.decoys_a_roe_m = {six(-100.0, -13000.0, 400.0, 900.0, -500.0, 900.0), six(-100.0, -9000.0, -400.0, 500.0, 200.0, 700.0)};
  return settings;
}

SceneSettings one_kilometre() {
  SceneSettings settings;
  settings.target_a_roe_m = six(0.0, -1000.0, 0.0, 30.0, 0.0, 30.0);
  settings.sigma_a_roe_m = six(0.1, 10.0, 1.0, 1.0, 1.0, 1.0);
  settings.refined = 0.3;
  settings.decoys_a_roe_m = {six(0.0, -9000.0, 100.0, 200.0, -200.0, 200.0), six(0.0, -3000.0, -60.0, 90.0, 50.0, 60.0)};
  return settings;
}

SceneSettings hundred_metres() {
  SceneSettings settings;
  settings.target_a_roe_m = six(0.0, -100.0, 0.0, 3.0, 0.0, 3.0);
  settings.sigma_a_roe_m = six(0.01, 1.0, 0.2, 0.2, 0.2, 0.2);
  settings.refined = 0.3;
  settings.noise_arcsec = 60.0;  // 41 pixels across, so its centre of brightness wanders
  settings.decoys_a_roe_m = {six(0.0, -8100.0, 100.0, 200.0, -200.0, 200.0), six(0.0, -300.0, -6.0, 9.0, 5.0, 6.0)};
  return settings;
}

/// Dark for 34 minutes, the mission's longest, every orbit of 99 minutes.
SceneSettings dark(SceneSettings settings) {
  settings.eclipses = {{1800.0, 3840.0}, {7740.0, 9780.0}};
  return settings;
}

SceneSettings burning(SceneSettings settings, double size) {
  settings.burns = {{2430.0, size * Vector3(0.0, 1.0, 0.0)},
                    {4815.0, size * Vector3(0.3, -0.5, 0.2)},
                    {8300.0, size * Vector3(0.0, 0.3, -0.8)}};
  return settings;
}

struct Case {
  const char* name;
  std::function<SceneSettings()> scene;
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << c.name;
}

class Scenes : public ::testing::TestWithParam<Case> {};

constexpr std::uint64_t kSeeds = 40;
constexpr int kImages = 180;

TEST_P(Scenes, TheTargetInEveryConfirmedImage) {
  RunResult all;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SceneSettings settings = GetParam().scene();
    settings.seed = seed;
    TargetTracker tracker;
    SceneMaker maker(settings);
    const RunResult run = run_tracker(tracker, maker, kImages);
    EXPECT_EQ(run.wrong, 0) << "seed " << seed;
    all.target_seen += run.target_seen;
    all.confirmed += run.confirmed;
    if (run.confirmed < 0.9 * run.target_seen) std::printf("  %lu: %d of %d, first %d, wrong %d\n", seed, run.confirmed, run.target_seen, run.first_confirmed, run.wrong);
  }
  std::printf("%s seen %d confirmed %d: %.4f\n", GetParam().name, all.target_seen, all.confirmed, 1.0 * all.confirmed / all.target_seen);
  EXPECT_GT(all.confirmed, 0.9 * all.target_seen);
}

INSTANTIATE_TEST_SUITE_P(
    Ranges, Scenes,
    ::testing::Values(Case{"far", far_scene}, Case{"far_dark", [] { return dark(far_scene()); }},
                      Case{"far_burning", [] { return burning(far_scene(), 1.0); }},
                      Case{"far_dark_burning", [] { return dark(burning(far_scene(), 1.0)); }},
                      Case{"fifty_kilometres", fifty_kilometres},
                      Case{"fifty_kilometres_dark_burning", [] { return dark(burning(fifty_kilometres(), 0.3)); }},
                      Case{"five_kilometres", five_kilometres},
                      Case{"five_kilometres_dark_burning", [] { return dark(burning(five_kilometres(), -0.1)); }},
                      Case{"one_kilometre", one_kilometre},
                      Case{"one_kilometre_dark_burning", [] { return dark(burning(one_kilometre(), 0.01)); }},
                      Case{"hundred_metres", hundred_metres},
                      Case{"hundred_metres_dark_burning", [] { return dark(burning(hundred_metres(), 0.001)); }}),
    [](const auto& of) { return std::string(of.param.name); });

}  // namespace
