// What the tracker says when it cannot know: refused input, nothing to see, two alike, outages.

#include <limits>

#include <gtest/gtest.h>

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

SceneSettings clean_scene() {
  SceneSettings settings;
  settings.false_detections = 0.0;
  settings.hot_pixels = 0;
  settings.detection_probability = 1.0;
  return settings;
}

TEST(TargetTracker, RefusesWhatCannotBe) {
  SceneMaker maker(clean_scene());
  const Scene scene = maker.next();
  ASSERT_EQ(scene.candidates.size(), 1U);
  TargetTracker tracker;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto status_of = [&](const auto& change) {
    Scene changed = scene;
    change(changed);
    TrackerInput input = changed.input();
    return tracker.step(input).status();
  };
  EXPECT_EQ(status_of([&](Scene& s) { s.candidates[0].direction_rtn.x() = nan; }), Status::kNotFinite);
  EXPECT_EQ(status_of([&](Scene& s) { s.candidates[0].direction_rtn *= 2.0; }), Status::kOutOfRange);
  EXPECT_EQ(status_of([&](Scene& s) { s.candidates[0].sigma = nan; }), Status::kNotFinite);
  EXPECT_EQ(status_of([&](Scene& s) { s.candidates[0].sigma = 0.0; }), Status::kOutOfRange);
  EXPECT_EQ(status_of([&](Scene& s) { s.candidates[0].object.flux_dn = nan; }), Status::kNotFinite);
  EXPECT_EQ(status_of([&](Scene& s) { s.servicer.velocity_eci.x() = nan; }), Status::kNotFinite);
  EXPECT_EQ(status_of([&](Scene& s) { s.prediction.covariance(1, 1) = nan; }), Status::kNotFinite);
  EXPECT_EQ(status_of([&](Scene& s) { s.detection_probability = nan; }), Status::kOutOfRange);
  EXPECT_EQ(status_of([&](Scene& s) { s.detection_probability = 1.5; }), Status::kOutOfRange);
  EXPECT_EQ(status_of([&](Scene& s) { s.candidates.resize(kMaxCandidates + 1, s.candidates[0]); }), Status::kTooLong);
  EXPECT_EQ(status_of([&](Scene& s) { s.burns = {{s.time, Vector3(nan, 0.0, 0.0), 0.0}}; }), Status::kNotFinite);
  EXPECT_EQ(status_of([&](Scene& s) {
              s.burns = {{s.time + duration_of_seconds(1), Vector3::Zero(), 0.0}};
            }),
            Status::kInvalidArgument);
  // None of it left a trace: the same image is taken, but not twice.
  EXPECT_EQ(status_of([](Scene&) {}), Status::kOk);
  EXPECT_EQ(status_of([](Scene&) {}), Status::kInvalidArgument);
}

TEST(TargetTracker, CoastsThroughEmptyImagesAndGivesUpAfterFifteen) {
  SceneMaker maker(clean_scene());
  TargetTracker tracker;
  for (int k = 0; k < 30; ++k) static_cast<void>(tracker.step(maker.next().input()));
  for (int k = 0; k < 40; ++k) {
    Scene scene = maker.next();
    scene.candidates.clear();
    const TrackerOutput output = tracker.step(scene.input()).value();
    EXPECT_EQ(output.candidate, -1);
    EXPECT_FALSE(output.confirmed);
    EXPECT_EQ(output.state, k < 14 ? TrackerState::kCoasting : TrackerState::kSearching) << k;
  }
  // And finds it again by the same rules as at first.
  int confirmed = 0;
  for (int k = 0; k < 20; ++k) {
    const Scene scene = maker.next();
    const TrackerOutput output = tracker.step(scene.input()).value();
    if (output.confirmed) {
      ++confirmed;
      EXPECT_EQ(output.candidate, scene.target_index());
    }
  }
  EXPECT_GE(confirmed, 13);
}

// An eclipse of 34 minutes: at its end one image is enough, for nothing else can be in so narrow a gate.
TEST(TargetTracker, KnowsTheTargetAgainAfterTheEclipse) {
  SceneSettings settings = clean_scene();
  settings.eclipses = {{5400.0, 7440.0}};
  SceneMaker maker(settings);
  TargetTracker tracker;
  for (int k = 0; k < 140; ++k) {
    const Scene scene = maker.next();
    const TrackerOutput output = tracker.step(scene.input()).value();
    EXPECT_EQ(output.confirmed, k >= 6 && scene.target_index() >= 0) << k;
  }
}

TEST(TargetTracker, WithoutAPredictionTheOnlySatelliteIsTheTarget) {
  SceneMaker maker(clean_scene());
  TargetTracker tracker;
  int confirmed = 0;
  for (int k = 0; k < 60; ++k) {
    const Scene scene = maker.next();
    TrackerInput input = scene.input();
    input.prediction.reset();
    const TrackerOutput output = tracker.step(input).value();
    if (output.confirmed) ++confirmed;
  }
  EXPECT_GT(confirmed, 45);
}

TEST(TargetTracker, WithoutAPredictionNoneOfTwoSatellitesIsConfirmed) {
  SceneSettings settings = clean_scene();
  settings.decoys_a_roe_m = {six(-1800.0, -83000.0, 900.0, -700.0, 800.0, 900.0)};
  SceneMaker maker(settings);
  TargetTracker tracker;
  TrackerOutput output;
  for (int k = 0; k < 60; ++k) {
    const Scene scene = maker.next();
    TrackerInput input = scene.input();
    input.prediction.reset();
    output = tracker.step(input).value();
    EXPECT_FALSE(output.confirmed) << k;
  }
  EXPECT_EQ(output.state, TrackerState::kAmbiguous);
}

// Two satellites at equal distances from where the target is expected.
TEST(TargetTracker, TwoThatFitThePredictionEquallyAreAmbiguous) {
  SceneSettings settings = clean_scene();
  settings.sigma_a_roe_m = six(20.0, 1000.0, 300.0, 300.0, 300.0, 300.0);
  settings.refined_after_s = 1e9;
  settings.has_target = false;  // the orbit in the middle has nobody
  settings.decoys_a_roe_m = {settings.target_a_roe_m + six(0.0, 0.0, 60.0, 60.0, 60.0, 60.0),
                             settings.target_a_roe_m - six(0.0, 0.0, 60.0, 60.0, 60.0, 60.0)};
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    settings.seed = seed;
    TargetTracker tracker;
    SceneMaker maker(settings);
    const RunResult run = run_tracker(tracker, maker, 60);
    EXPECT_EQ(run.confirmed, 0) << seed;
  }
}

// Unidentified stars keep their place in the sky, so that from image to image they move by 3.6 degrees in RTN.
TEST(TargetTracker, StarsAreNoSatellites) {
  SceneSettings settings = clean_scene();
  settings.has_target = false;
  SceneMaker maker(settings);
  TargetTracker tracker;
  std::uint64_t state = 1;
  const auto uniform = [&state] {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state >> 11U) * 0x1p-53 * 2.0 - 1.0;
  };
  std::vector<Vector3> stars;
  for (int k = 0; k < 20000; ++k) {
    const Vector3 direction(uniform(), uniform(), uniform());
    if (direction.norm() < 1.0) stars.push_back(direction.normalized());
  }
  std::size_t seen = 0;
  for (int k = 0; k < 100; ++k) {
    const Scene scene = maker.next();
    const Matrix3 rtn_eci = orbit::R_rtn_eci(scene.servicer);
    std::vector<Candidate> candidates;
    for (const Vector3& star : stars) {
      Candidate candidate;
      candidate.direction_rtn = rtn_eci * star;
      candidate.sigma = 6e-5;
      candidate.object.pixels = 6;
      candidate.object.flux_dn = 5000.0;
      if (-candidate.direction_rtn.y() > 0.9985 && candidates.size() < kMaxCandidates) candidates.push_back(candidate);
    }
    seen += candidates.size();
    TrackerInput input = scene.input();
    input.candidates = candidates;
    EXPECT_FALSE(tracker.step(input).value().confirmed) << k;
  }
  EXPECT_GT(seen, 500U);
}

TEST(TargetTracker, TheFullestImageIsTaken) {
  SceneSettings settings = clean_scene();
  settings.false_detections = 250.0;
  SceneMaker maker(settings);
  TargetTracker tracker;
  for (int k = 0; k < 20; ++k) {
    const Scene scene = maker.next();
    const Result<TrackerOutput> output = tracker.step(scene.input());
    ASSERT_TRUE(output.ok());
    EXPECT_LE(output.value().hypotheses, static_cast<int>(kMaxHypotheses));
    if (output.value().confirmed) {
      EXPECT_EQ(output.value().candidate, scene.target_index());
    }
  }
}

TEST(TargetTracker, TheSameImagesGiveTheSameAnswers) {
  TargetTracker one;
  TargetTracker other;
  SceneMaker maker(SceneSettings{});
  for (int k = 0; k < 60; ++k) {
    const Scene scene = maker.next();
    const TrackerOutput a = one.step(scene.input()).value();
    const TargetTracker copy = other;  // its state is plain data
    other = copy;
    const TrackerOutput b = other.step(scene.input()).value();
    EXPECT_EQ(a.candidate, b.candidate);
    EXPECT_EQ(a.hypotheses, b.hypotheses);
    EXPECT_EQ(a.score_margin, b.score_margin);
  }
}

}  // namespace
