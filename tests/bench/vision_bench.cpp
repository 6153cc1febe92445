// What an image of the reference camera's region costs: out of its tiles, and into objects.

#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "fsw/vision/imaging/image_assembly.h"
#include "fsw/vision/imaging/object_detector.h"
#include "fsw/vision/stars/star_identification.h"
#include "tests/support/paths.h"
#include "tests/support/star_sky.h"
#include "tests/support/synthetic_image.h"
#include "tests/unit/fsw/vision/target_tracking/scene.h"

namespace {

using namespace vbar::fsw::imaging;

constexpr int kWidth = 500;
constexpr int kHeight = 800;

/// A number of stars of magnitude 7.5 and brighter, smeared as by the orbit's rate.
std::vector<std::uint16_t> star_field(int stars) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  vbar::test::SyntheticImage scene(kWidth, kHeight);
  for (int k = 0; k < stars; ++k) {
    scene.add({kWidth * uniform(random), kHeight * uniform(random), 900.0 / (0.01 + uniform(random)), 0.8, 0.0, 1.2});
  }
  return scene.expose({}, random);
}

void detect(benchmark::State& state) {
  const auto pixels = star_field(static_cast<int>(state.range(0)));
  const auto detector = std::make_unique<ObjectDetector>();
  DetectionReport report;
  for (auto _ : state) {
    report = detector->detect(vbar::test::view_of(pixels, kWidth, kHeight), {});
    benchmark::DoNotOptimize(report);
  }
  state.counters["objects"] = report.objects;
}

std::vector<vbar::image_tile> tiles() {
  const auto pixels = star_field(50);
  std::vector<vbar::image_tile> all;
  for (std::size_t first = 0; first < pixels.size(); first += kTilePixels12) {
    vbar::image_tile tile{};
    const std::size_t count = std::min<std::size_t>(kTilePixels12, pixels.size() - first);
    tile.tile = static_cast<std::int16_t>(all.size());
    tile.tiles = 461;
    tile.width = kWidth;
    tile.height = kHeight;
    tile.bits = 12;
    tile.pixels = static_cast<std::int16_t>(count);
    pack_pixels(std::span(pixels).subspan(first, count), 12, tile.data);
    all.push_back(tile);
  }
  return all;
}

void unpack(benchmark::State& state) {
  const auto all = tiles();
  const auto assembly = std::make_unique<ImageAssembly>();
  std::int64_t time = 0;
  for (auto _ : state) {
    ++time;
    for (const vbar::image_tile& tile : all) benchmark::DoNotOptimize(assembly->take({time}, 0, tile));
  }
  if (assembly->tiles_missing() != 0) state.SkipWithError("the image is not complete");
}

BENCHMARK(detect)->Name("imaging/detect/400000")->Arg(50)->Arg(500)->Unit(benchmark::kMillisecond);
BENCHMARK(unpack)->Name("imaging/unpack/400000")->Unit(benchmark::kMillisecond);

}  // namespace

// Star identification on 200 random skies in turn: 8 false objects, 0.1 pixel of noise, stars to V 7.5. One iteration
// is one image's objects. `stars/lost_in_space/nothing` is the bound: 30 objects, none a star.

namespace {

using namespace vbar;
using fsw::Matrix3;
using fsw::Vector3;

struct Image {
  std::vector<fsw::stars::ObservedStar> objects;
  Matrix3 R_camera_eci;
};

std::vector<Image> draw_images(const sky::SceneSettings& settings, bool with_stars) {
  const auto stars = with_stars ? sky::read_sky(vbar::tests::source_path("data/stars/hipparcos_v8.csv"), 2011.55)
                                : std::vector<sky::TrueStar>{};
  sky::Random random(1);
  std::vector<Image> images;
  for (int k = 0; k < 200; ++k) {
    const Matrix3 attitude = sky::random_rotation(random);
    const sky::Scene scene = sky::draw_scene(stars, settings, attitude, Vector3::Zero(), random);
    images.push_back({sky::observed(scene, 0.1 / settings.camera.focal_length_px), attitude});
  }
  return images;
}

template <class Identify>
void identify_in_turn(benchmark::State& state, const sky::SceneSettings& settings, bool with_stars,
                      const Identify& identify) {
  const std::vector<Image> images = draw_images(settings, with_stars);
  const fsw::stars::Field field{Vector3::UnitZ(), settings.camera.radius()};
  auto identifier = std::make_unique<fsw::stars::StarIdentifier>();
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(identify(*identifier, images[next], field));
    next = (next + 1) % images.size();
  }
}

void lost_in_space(benchmark::State& state, const sky::SceneSettings& settings, bool with_stars) {
  identify_in_turn(state, settings, with_stars, [](auto& identifier, const Image& image, const auto& field) {
    return identifier.lost_in_space(image.objects, field, Vector3::Zero());
  });
}

void track(benchmark::State& state, const sky::SceneSettings& settings) {
  const Matrix3 turn = sky::small_rotation({7e-4, -5e-4, 9e-4});
  identify_in_turn(state, settings, true, [&turn](auto& identifier, const Image& image, const auto& field) {
    return identifier.track(image.objects, field, turn * image.R_camera_eci, 1.454e-3, Vector3::Zero());
  });
}

const sky::SceneSettings kRegion{.camera = sky::kRegion};
const sky::SceneSettings kFull{.camera = sky::kFull};
const sky::SceneSettings kNothing{.false_objects = 30};

BENCHMARK_CAPTURE(lost_in_space, region, kRegion, true)
    ->Name("stars/lost_in_space/region")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(lost_in_space, full, kFull, true)->Name("stars/lost_in_space/full")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(lost_in_space, nothing, kNothing, false)
    ->Name("stars/lost_in_space/nothing")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(track, region, kRegion)->Name("stars/track/region")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(track, full, kFull)->Name("stars/track/full")->Unit(benchmark::kMicrosecond);

}  // namespace

// Target tracking: an image of many false detections, all places for hypotheses taken.

namespace {

void update(benchmark::State& state) {
  testing::SceneSettings settings;
  settings.false_detections = 100.0;
  testing::SceneMaker maker(settings);
  fsw::target_tracking::TargetTracker warm;
  for (int k = 0; k < 40; ++k) {
    const testing::Scene scene = maker.next();
    if (!warm.step(scene.input()).ok()) state.SkipWithError("the tracker refused an image");
  }
  const testing::Scene scene = maker.next();
  int hypotheses = 0;
  for (auto _ : state) {
    state.PauseTiming();
    fsw::target_tracking::TargetTracker tracker = warm;
    state.ResumeTiming();
    const auto output = tracker.step(scene.input());
    hypotheses = output.value().hypotheses;
    benchmark::DoNotOptimize(hypotheses);
  }
  state.counters["hypotheses"] = hypotheses;
}

BENCHMARK(update)->Name("tracking/update/64")->Unit(benchmark::kMicrosecond);

}  // namespace
