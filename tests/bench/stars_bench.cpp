// Star identification on 200 random skies in turn: 8 false objects, 0.1 pixel of noise, stars to V 7.5. One iteration
// is one image's objects. `stars/lost_in_space/nothing` is the bound: 30 objects, none a star.

#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "fsw/stars/star_identification.h"
#include "tests/support/paths.h"
#include "tests/support/star_campaign.h"

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
