// The kept directions are those of the lens, to the bit, also after a change of the region.

#include "host_sim/twins/camera/pixel_directions.h"

#include <memory>

#include <gtest/gtest.h>

#include "host_sim/twins/camera/optics.h"

namespace vbar::twins::camera {
namespace {

TEST(PixelDirections, AreThoseOfTheLensInEveryRegion) {
  CameraSettings settings;
  settings.optics.distortion = {-0.12, 0.08, 1.5e-3, -7e-4, 0.02};
  const auto optics = std::make_shared<const Optics>(settings);
  PixelDirections directions(optics);
  for (const Region& region :
       {Region{10, 20, 7, 5}, Region{10, 20, 7, 5}, Region{900, 600, 5, 7}, Region{0, 0, 3, 3}}) {
    directions.prepare(region);
    for (int y = region.y; y < region.y + region.height; ++y)
      for (int x = region.x; x < region.x + region.width; ++x)
        ASSERT_EQ(directions.at(x, y), optics->direction_of(fsw::Vector2(x, y))) << x << ", " << y;
  }
}

}  // namespace
}  // namespace vbar::twins::camera
