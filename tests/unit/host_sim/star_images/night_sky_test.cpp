// Stars of the real sky: objects of three images of ESA's project tetra3 (tests/data/sky) through star identification
// and the calibration of the lens. Neither site nor attitude of the camera is known; its names state altitude and
// azimuth, and with them the angles between the images.

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "host_sim/files/output_file.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/star_images/star_fix.h"
#include "tests/support/paths.h"

namespace vbar::star_images {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kImages = 3;

std::vector<ImageObjects> read_objects() {
  std::vector<ImageObjects> images(kImages);
  for (ImageObjects& image : images) {
    image.width = 1024;
    image.height = 768;
  }
  const std::string text = files::read_text_file(vbar::tests::source_path("tests/data/sky/night_sky_2019_07_29.csv"));
  const auto lines = files::split_at(text, '\n');
  for (std::size_t k = 1; k < lines.size(); ++k) {
    const auto fields = files::split_at(lines[k], ',');
    if (fields.size() != 5) continue;
    fsw::imaging::DetectedObject object;
    object.centroid_px = {files::number_of(fields[1]).value(), files::number_of(fields[2]).value()};
    object.sigma_px = files::number_of(fields[3]).value();
    object.flux_dn = files::number_of(fields[4]).value();
    images.at(static_cast<std::size_t>(files::integer_of(fields[0]).value())).objects.push_back(object);
  }
  return images;
}

/// A first guess: 35 mm, and the field of 11.4 deg across that tetra3 states, 5130 px, less 0.25 %.
FixSettings first_guess() {
  FixSettings settings;
  settings.camera.focal_length_px.setConstant(5117.0);
  settings.camera.principal_point_px = {511.5, 383.5};
  return settings;
}

std::vector<StarFix> identify_all(const std::vector<ImageObjects>& images, const FixSettings& settings) {
  std::vector<StarFix> fixes;
  for (const ImageObjects& image : images)
    if (const auto fix = identify(image, settings)) fixes.push_back(*fix);
  return fixes;
}

double angle_between_deg(const StarFix& a, const StarFix& b) {
  return std::acos(a.R_camera_eci.row(2).dot(b.R_camera_eci.row(2))) / kDegree;
}

TEST(NightSky, ThreeOfThreeAreIdentifiedAndTheLensLeavesAQuarterOfAPixel) {
  const auto images = read_objects();
  const auto fixes = identify_all(images, first_guess());
  ASSERT_EQ(fixes.size(), images.size());
  const LensCalibration lens = calibrate_lens(fixes, first_guess().camera);
  EXPECT_GE(lens.stars, 150);
  // Scintillation and the refraction that differs across 8 deg of altitude, up to 0.3 px at an altitude of 40 deg.
  EXPECT_LT(lens.rms_px, 0.25);
  EXPECT_LT(lens.focal_length_sigma_px, 1.0);
  // 35 mm over twice the pitch of 3.45 um that cameras of this class have, to the 2 % of a lens.
  EXPECT_NEAR(lens.camera.focal_length_px.x(), 35.0 / 6.9e-3, 0.02 * 35.0 / 6.9e-3);
}

TEST(NightSky, AnglesBetweenTheImagesAreThoseOfTheirNames) {
  const auto fixes = identify_all(read_objects(), first_guess());
  ASSERT_EQ(fixes.size(), std::size_t{kImages});
  // Along one vertical circle the mount moves by 20 deg. Across the zenith it turns by 180 deg about an axis that is
  // vertical only as far as it was levelled: a degree of tilt counts twice. Refraction is below 0.03 deg.
  EXPECT_NEAR(angle_between_deg(fixes[0], fixes[1]), 20.0, 0.2);
  EXPECT_NEAR(angle_between_deg(fixes[1], fixes[2]), 60.0, 4.0);
}

TEST(NightSky, MirroredImagesAreNotIdentified) {
  auto images = read_objects();
  for (ImageObjects& image : images)
    for (auto& object : image.objects) object.centroid_px.x() = image.width - 1.0 - object.centroid_px.x();
  EXPECT_TRUE(identify_all(images, first_guess()).empty());
}

TEST(NightSky, AFocalLengthOffByTwoPerCentIdentifiesNothing) {
  for (const double scale : {0.98, 1.02}) {
    FixSettings settings = first_guess();
    settings.camera.focal_length_px *= scale;
    EXPECT_TRUE(identify_all(read_objects(), settings).empty()) << scale;
  }
}

TEST(NightSky, AberrationOfTheDateMovesTheAttitudeByUpToItself) {
  FixSettings settings = first_guess();
  const auto without = identify_all(read_objects(), settings);
  settings.velocity_over_c_eci = {0.0, 0.0, 9.936e-5};  // 20.49 arcsec, the constant of aberration, towards the pole
  const auto with = identify_all(read_objects(), settings);
  ASSERT_EQ(with.size(), without.size());
  for (std::size_t k = 0; k < with.size(); ++k) {
    const fsw::Vector3 boresight = without[k].R_camera_eci.row(2);
    const double across = settings.velocity_over_c_eci.cross(boresight).norm();
    EXPECT_NEAR(angle_between_deg(with[k], without[k]) * kDegree, across, 0.03 * 9.936e-5);
  }
}

TEST(LensCalibration, TooFewStarsAreRefused) {
  auto fixes = identify_all(read_objects(), first_guess());
  ASSERT_FALSE(fixes.empty());
  fixes.resize(1);
  fixes[0].stars.resize(kFewestStars - 1);
  EXPECT_THROW(static_cast<void>(calibrate_lens(fixes, first_guess().camera)), std::runtime_error);
}

}  // namespace
}  // namespace vbar::star_images
