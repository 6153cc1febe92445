#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "host_sim/mission/data_directory.h"
#include "host_sim/training/circumstances.h"
#include "host_sim/training/soft_picture.h"
#include "host_sim/twins/camera/model/silhouette.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::training {
namespace {

using fsw::Vector3;

TEST(SoftPicture, KeepsLightAndSpreadsItAsTold) {
  constexpr int kWidth = 61, kHeight = 41, kX = 30, kY = 20;
  for (const double sigma : {0.8, 1.5, 4.0}) {
    std::vector<float> picture(kWidth * kHeight, 0.0F);
    picture[kY * kWidth + kX] = 1000.0F;
    soften(sigma, kWidth, kHeight, picture);
    double sum = 0.0, across = 0.0, down = 0.0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const double light = static_cast<double>(picture[static_cast<std::size_t>(y * kWidth + x)]);
        sum += light;
        across += light * (x - kX) * (x - kX);
        down += light * (y - kY) * (y - kY);
      }
    EXPECT_NEAR(sum, 1000.0, 0.01);
    // Cut off at three and a half deviations a Gaussian has lost 1 to 2 % of its variance.
    EXPECT_NEAR(across / sum, sigma * sigma, 0.02 * sigma * sigma);
    EXPECT_NEAR(down / sum, sigma * sigma, 0.02 * sigma * sigma);
  }
}

TEST(SoftPicture, WithoutSpreadNothingChanges) {
  std::vector<float> picture{1.0F, 2.0F, 3.0F, 4.0F};
  soften(0.0, 2, 2, picture);
  EXPECT_EQ(picture, (std::vector<float>{1.0F, 2.0F, 3.0F, 4.0F}));
}

twins::camera::CadModel plate(double width_m, double height_m) {
  const Vector3 a(-0.5 * width_m, -0.5 * height_m, 0.0), b(0.5 * width_m, -0.5 * height_m, 0.0);
  const std::array<Vector3, 3> flat{Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
  return twins::camera::make_cad_model("plate", {{{a, b, -a}, flat, 0}, {{a, -a, -b}, flat, 0}},
                                       {{"white", {}, {}, 0.0}});
}

// A plate square to the boresight: its size in pixels is focal length times size over range.
TEST(Silhouette, PlateCoversWhatItShould) {
  auto camera = close_range_camera(mission::data_directory());
  camera.optics.distortion = {};
  const twins::camera::Optics optics(camera);
  twins::camera::Silhouette silhouette(plate(0.8, 0.4));
  const twins::camera::Region region{380, 200, 200, 200};
  std::vector<float> covered;
  silhouette.draw(optics, Vector3(0.0, 0.0, 8.0), fsw::Matrix3::Identity(), region, covered);
  double area = 0.0, x_sum = 0.0, y_sum = 0.0;
  for (int y = 0; y < region.height; ++y)
    for (int x = 0; x < region.width; ++x) {
      const double share = static_cast<double>(covered[static_cast<std::size_t>(y * region.width + x)]);
      area += share;
      x_sum += share * (region.x + x);
      y_sum += share * (region.y + y);
    }
  const double f = camera.focal_length_px();
  // Edges are found to half a point of the grid, a quarter of a pixel.
  EXPECT_NEAR(area, f * f * 0.8 * 0.4 / 64.0, 0.25 * 2.0 * f * (0.8 + 0.4) / 8.0);
  EXPECT_NEAR(x_sum / area, 479.5, 0.25);
  EXPECT_NEAR(y_sum / area, 299.5, 0.25);
}

}  // namespace
}  // namespace vbar::training
