// Pictures in 8 bits against the light that was wanted: analytic Gaussians of known place and flux.

#include "hil_drivers/optical_stimulator/pictures/picture_maker.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "hil_drivers/optical_stimulator/pictures/display_light.h"
#include "host_sim/engine/random_stream.h"
#include "tests/support/figures.h"

namespace vbar::optical_stimulator {

namespace {

using fsw::Vector2;
using twins::camera::PhotonImage;
using twins::camera::Region;

constexpr int kSide = 40;
constexpr double kFull = 2.4e6;  // electrons of a full pixel: brief of the testbed, 200 cd/m2 in 0.2 s
constexpr double kPixel_arcsec = 34.5;

DisplayLight uneven_light(double unevenness) {
  engine::RandomStream random(7, "evenness");
  std::vector<float> full(kSide * kSide);
  for (float& electrons : full) electrons = static_cast<float>(kFull * (1.0 + unevenness * random.normal()));
  return {{2.2, 3.0, 1e5}, kSide, kSide, full};
}

double integral(double distance, double sigma) {
  return 0.5 * (std::erf((distance + 0.5) / (std::sqrt(2.0) * sigma)) -
                std::erf((distance - 0.5) / (std::sqrt(2.0) * sigma)));
}

PhotonImage black() {
  return {Region{0, 0, kSide, kSide}, std::vector<float>(kSide * kSide, 0.0F)};
}

void add_star(const Vector2& at, double electrons, PhotonImage& image, double sigma = 0.5) {
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      image.at(x, y) += static_cast<float>(electrons * integral(x - at.x(), sigma) * integral(y - at.y(), sigma));
}

/// Light shown, by the display's law written out once more.
struct Shown {
  double electrons = 0.0;
  Vector2 centroid = Vector2::Zero();
};

Shown shown_by(const Picture& picture, const DisplayLight& light) {
  Shown shown;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const double count = picture.at(x, y);
      if (count <= 3.0) continue;
      const double electrons = light.full_electrons(x, y) * std::pow((count - 3.0) / 252.0, 2.2);
      shown.electrons += electrons;
      shown.centroid += electrons * Vector2(x, y);
    }
  if (shown.electrons > 0.0) shown.centroid /= shown.electrons;
  return shown;
}

struct Errors {
  double position_arcsec = 0.0, flux = 0.0;  // rms an axis; relative rms
};

/// A star that is `fainter` magnitudes below a full pixel, at random places of a pixel.
template <class Draw>
Errors errors_of(double fainter, const DisplayLight& light, const Draw& draw) {
  engine::RandomStream random(1, "stars/" + std::to_string(fainter));
  double place2 = 0.0, flux2 = 0.0;
  constexpr int kStars = 400;
  for (int k = 0; k < kStars; ++k) {
    const Vector2 at(18.0 + 4.0 * random.uniform(), 18.0 + 4.0 * random.uniform());
    const double electrons = kFull * std::pow(10.0, -0.4 * fainter);
    Picture picture(kSide, kSide);
    draw(at, electrons, picture);
    const Shown shown = shown_by(picture, light);
    place2 += (shown.centroid - at).squaredNorm();
    flux2 += std::pow(shown.electrons / electrons - 1.0, 2);
  }
  return {kPixel_arcsec * std::sqrt(place2 / (2 * kStars)), std::sqrt(flux2 / kStars)};
}

// Required: 0.3 arcsec rms an axis and 3 % rms, from a full pixel to eight magnitudes below. Whole-pixel plotting has
// the rms of a uniform distribution, 1/sqrt(12) px = 9.96 arcsec.
TEST(PictureMaker, StarsHaveTheirPlaceAndFluxInEightBits) {
  const DisplayLight light = uneven_light(0.02);
  std::printf("magnitudes below a full pixel: matched counts, arcsec and flux; whole pixels, arcsec and flux\n");
  for (const double fainter : {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0}) {
    const Errors matched = errors_of(fainter, light, [&](const Vector2& at, double electrons, Picture& picture) {
      PhotonImage image = black();
      add_star(at, electrons, image);
      EXPECT_EQ(PictureMaker(light).draw(image, picture).points, 1);
    });
    const Errors whole = errors_of(fainter, light, [&](const Vector2& at, double electrons, Picture& picture) {
      const int x = static_cast<int>(std::lround(at.x())), y = static_cast<int>(std::lround(at.y()));
      picture.at(x, y) = light.nearest_count(electrons / light.full_electrons(x, y));
    });
    std::printf("%4.1f  %6.3f %6.2f %%   %6.2f %6.2f %%\n", fainter, matched.position_arcsec, 100.0 * matched.flux,
                whole.position_arcsec, 100.0 * whole.flux);
    EXPECT_LE(matched.position_arcsec, 0.3) << fainter;
    EXPECT_LE(matched.flux, 0.03) << fainter;
    EXPECT_NEAR(whole.position_arcsec, 9.96, 1.0) << fainter;
  }
}

TEST(PictureMaker, DotsHaveTheirPlaceAndFlux) {
  const DisplayLight light = uneven_light(0.02);
  for (const double fainter : {0.0, 4.0, 6.5}) {
    const Errors errors = errors_of(fainter, light, [&](const Vector2& at, double electrons, Picture& picture) {
      EXPECT_TRUE(draw_dot(light, at, 0.7, electrons, picture));
    });
    EXPECT_LE(errors.position_arcsec, 0.3) << fainter;
    EXPECT_LE(errors.flux, 0.03) << fainter;
  }
  Picture picture(kSide, kSide);
  EXPECT_FALSE(draw_dot(light, {1.0, 20.0}, 0.7, kFull, picture));
  EXPECT_FALSE(draw_dot(light, {std::nan(""), 20.0}, 0.7, kFull, picture));
}

// Smear of 1.3 px, as the camera rotates by 218 arcsec/s in 0.2 s.
TEST(PictureMaker, SmearedStarsKeepTheMiddleOfTheirStreak) {
  const DisplayLight light = uneven_light(0.02);
  for (const double fainter : {2.0, 6.0}) {
    const Errors errors = errors_of(fainter, light, [&](const Vector2& at, double electrons, Picture& picture) {
      PhotonImage image = black();
      constexpr int kNodes = 13;
      for (int k = 0; k < kNodes; ++k)
        add_star(at + Vector2(0.9, 0.94) * ((k + 0.5) / kNodes - 0.5), electrons / kNodes, image);
      EXPECT_EQ(PictureMaker(light).draw(image, picture).points, 1);
    });
    EXPECT_LE(errors.position_arcsec, 0.3) << fainter;
    EXPECT_LE(errors.flux, 0.03) << fainter;
  }
}

TEST(PictureMaker, PointsBrighterThanAPixelSpreadOverUpToNine) {
  const DisplayLight light = uneven_light(0.0);
  for (const double pixels : {1.5, 4.0, 9.0, 40.0}) {
    const Vector2 at(20.31, 19.77);
    PhotonImage image = black();
    add_star(at, pixels * kFull, image);
    Picture picture(kSide, kSide);
    const PictureFigures figures = PictureMaker(light).draw(image, picture);
    const Shown shown = shown_by(picture, light);
    EXPECT_NEAR(shown.electrons / kFull, std::min(pixels, 9.0), 0.01 * pixels);
    EXPECT_NEAR(figures.clipped_electrons / kFull, std::max(0.0, pixels - 9.0), 1e-3 * pixels);
    EXPECT_EQ(figures.clipped_points, pixels > 9.0 ? 1 : 0);
    // 0.01 px is 0.35 arcsec.
    EXPECT_NEAR((shown.centroid - at).norm(), 0.0, 0.01) << pixels;
  }
}

TEST(PictureMaker, ExtendedLightKeepsItsMeanAndIsClippedAtTheFullCount) {
  const DisplayLight light = uneven_light(0.02);
  PhotonImage image = black();
  // A ramp below the least count and above: 1e-6 to 1e-3 of a full pixel. Its mean within the diffusion's edge loss.
  double wanted = 0.0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      image.at(x, y) = static_cast<float>(kFull * std::pow(10.0, -6.0 + 3.0 * x / kSide));
      wanted += static_cast<double>(image.at(x, y));
    }
  Picture picture(kSide, kSide);
  PictureMaker maker(light);
  EXPECT_EQ(maker.draw(image, picture).clipped_electrons, 0.0);
  EXPECT_NEAR(shown_by(picture, light).electrons / wanted, 1.0, 0.01);

  // A disc of 64 full pixels a pixel keeps its shape.
  image = black();
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      if (std::hypot(x - 20, y - 20) < 8.0) image.at(x, y) = static_cast<float>(64.0 * kFull);
  const PictureFigures figures = maker.draw(image, picture);
  EXPECT_NEAR(figures.clipped_electrons / figures.wanted_electrons, 63.0 / 64.0, 1e-3);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      EXPECT_EQ(picture.at(x, y), std::hypot(x - 20, y - 20) < 8.0 ? 255 : 0) << x << ' ' << y;
}

TEST(PictureMaker, RepeatsBitForBitAndLeavesTheRestOfThePicture) {
  const DisplayLight light = uneven_light(0.05);
  PhotonImage image{Region{5, 6, 30, 20}, std::vector<float>(600, 0.0F)};
  engine::RandomStream random(3, "light");
  for (float& electrons : image.electrons) electrons = static_cast<float>(1e3 * std::abs(random.normal()));
  image.electrons[7] = std::nanf("");
  Picture first(kSide, kSide), second(kSide, kSide);
  first.counts.assign(first.counts.size(), 200);
  second.counts.assign(second.counts.size(), 200);
  PictureMaker maker(light);
  static_cast<void>(maker.draw(image, first));
  static_cast<void>(maker.draw(image, second));
  EXPECT_EQ(first.counts, second.counts);
  EXPECT_EQ(first.at(4, 6), 200);
  EXPECT_EQ(first.at(5, 5), 200);
  image.region.x = 20;
  EXPECT_THROW(static_cast<void>(maker.draw(image, first)), std::invalid_argument);
}

}  // namespace

// Counts and light of a display.

namespace {

DisplayLight light_of(const DisplayResponse& response) {
  return {response, 2, 1, {100.0F, 50.0F}};
}

TEST(DisplayLight, FollowsThePowerLaw) {
  const DisplayLight light = light_of({2.0, 55.0, 1e4});
  EXPECT_EQ(light.fraction(255), 1.0);
  EXPECT_DOUBLE_EQ(light.fraction(155), 0.25);  // half of the range, squared
  EXPECT_EQ(light.fraction(55), 0.0);
  EXPECT_DOUBLE_EQ(light.fraction(56), 1.0 / 40000.0);
  EXPECT_DOUBLE_EQ(light.black_electrons(1, 0), 0.005);
}

TEST(DisplayLight, NearestCountIsThatOfALinearSearch) {
  const DisplayLight light = light_of({2.2, 3.3, 1e5});
  for (int k = 0; k <= 4000; ++k) {
    const double wanted = std::pow(10.0, -7.0 + 7.5 * k / 4000.0);
    accuracy::Smallest least;
    for (int count = 0; count <= 255; ++count) least.add(std::abs(light.fraction(count) - wanted));
    EXPECT_EQ(std::abs(light.fraction(light.nearest_count(wanted)) - wanted), least.value) << wanted;
  }
  EXPECT_EQ(light.nearest_count(0.0), 0);
  EXPECT_EQ(light.nearest_count(-1.0), 0);
  EXPECT_EQ(light.nearest_count(std::nan("")), 0);
  EXPECT_EQ(light.nearest_count(1e9), 255);
}

TEST(DisplayLight, StepsPassOverCountsWithoutLight) {
  const DisplayLight light = light_of({2.2, 3.3, 1e5});
  EXPECT_EQ(light.above(0), 4);
  EXPECT_EQ(light.below(4), 0);
  EXPECT_EQ(light.above(255), 255);
  EXPECT_EQ(light.below(0), 0);
}

TEST(DisplayLight, RefusesWhatNoDisplayHas) {
  const double nan = std::nan("");
  for (const DisplayResponse& response :
       {DisplayResponse{nan, 0.0, 1e5}, DisplayResponse{0.0, 0.0, 1e5}, DisplayResponse{2.2, nan, 1e5},
        DisplayResponse{2.2, 255.0, 1e5}, DisplayResponse{2.2, 0.0, nan}, DisplayResponse{2.2, -1.0, 1e5}})
    EXPECT_THROW(light_of(response), std::invalid_argument);
  EXPECT_THROW(DisplayLight({}, 2, 1, {1.0F}), std::invalid_argument);
  EXPECT_THROW(DisplayLight({}, 2, 1, {1.0F, 0.0F}), std::invalid_argument);
  EXPECT_THROW(DisplayLight({}, 2, 1, {1.0F, std::nanf("")}), std::invalid_argument);
}

}  // namespace

}  // namespace vbar::optical_stimulator
