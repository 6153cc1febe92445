#include "host_sim/training/crop_maker.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/mission/data_file.h"
#include "host_sim/training/circumstances.h"
#include "host_sim/twins/camera/photometry.h"
#include "host_sim/twins/camera/scene.h"
#include "tests/support/figures.h"

#ifdef VBAR_HAVE_OPENCV
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#endif

namespace vbar::training {

namespace {

CropMaker& maker() {
  static CropMaker one(mission::data_directory(), "tango", CropKind::kTraining, 1);
  return one;
}

TEST(CropMaker, CropDependsOnSeedAndNumberOnly) {
  LabelledCrop first, again, other_seed;
  maker().make(7, first);
  maker().make(3, again);
  maker().make(7, again);
  EXPECT_EQ(first.samples, again.samples);
  EXPECT_EQ(first.cells, again.cells);
  CropMaker fresh(mission::data_directory(), "tango", CropKind::kTraining, 1);
  fresh.make(7, again);
  EXPECT_EQ(first.samples, again.samples);
  CropMaker other(mission::data_directory(), "tango", CropKind::kTraining, 2);
  other.make(7, other_seed);
  EXPECT_NE(first.samples, other_seed.samples);
}

TEST(CropMaker, KindsShareNothing) {
  LabelledCrop training, held_out;
  maker().make(0, training);
  CropMaker other(mission::data_directory(), "tango", CropKind::kHeldOut, 1);
  other.make(0, held_out);
  EXPECT_NE(training.circumstances.centre_of_mass_camera, held_out.circumstances.centre_of_mass_camera);
}

// Keypoints of the CAD frame and the way to its origin by OpenCV's pinhole camera with distortion; in cells by hand.
TEST(CropMaker, LabelsAreOpenCvsProjection) {
#ifdef VBAR_HAVE_OPENCV
  const auto& camera = maker().camera();
  const cv::Matx33d matrix(17.0 / 0.01172, 0.0, 479.5, 0.0, 17.0 / 0.01172, 299.5, 0.0, 0.0, 1.0);
  const std::vector<double> distortion(camera.optics.distortion.begin(), camera.optics.distortion.end());
  const double published[11][3] = {{-.37, -.385, .3215},  {-.37, .385, .3215}, {.37, .385, .3215},
                                   {.37, -.385, .3215},   {-.37, -.264, 0},    {-.37, .304, 0},
                                   {.37, .304, 0},        {.37, -.264, 0},     {-.5427, .4877, .2535},
                                   {.5427, .4877, .2591}, {.305, -.579, .2515}};
  std::vector<cv::Point3d> points;
  for (const auto& p : published) points.emplace_back(p[0], p[1], p[2]);
  LabelledCrop crop;
  for (int index = 0; index < 20; ++index) {
    maker().make(index, crop);
    const Circumstances& c = crop.circumstances;
    const fsw::Vector3 centre_of_mass(0.0, 0.018823529411764704, 0.160794117647059);  // data/bodies/tango.toml
    const fsw::Vector3 t = c.centre_of_mass_camera - c.R_camera_body * centre_of_mass;
    cv::Matx33d rotation;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) rotation(i, j) = c.R_camera_body(i, j);
    cv::Mat turn;
    cv::Rodrigues(rotation, turn);
    std::vector<cv::Point2d> pixels;
    cv::projectPoints(points, turn, cv::Vec3d(t.x(), t.y(), t.z()), matrix, distortion, pixels);
    for (std::size_t k = 0; k < points.size(); ++k) {
      EXPECT_NEAR(crop.pixels[k].x(), pixels[k].x, 1e-6);
      EXPECT_NEAR(crop.pixels[k].y(), pixels[k].y, 1e-6);
      // A crop of side s about c: its left edge c - s/2 is the left edge of cell 0, at -0.5.
      const double column = (pixels[k].x - c.region.centre_px.x()) / c.region.side_px * 32.0 + 15.5;
      const double row = (pixels[k].y - c.region.centre_px.y()) / c.region.side_px * 32.0 + 15.5;
      EXPECT_NEAR(crop.cells[k].x(), column, 1e-6);
      EXPECT_NEAR(crop.cells[k].y(), row, 1e-6);
      EXPECT_EQ(crop.counts[k], column >= -1.0 && column <= 32.0 && row >= -1.0 && row <= 32.0);
    }
  }
#else
  GTEST_SKIP() << "without OpenCV";
#endif
}

/// Mean of the samples within `reach` cells of a place.
double mean_about(const LabelledCrop& crop, const fsw::Vector2& cell, double reach) {
  double sum = 0.0;
  int count = 0;
  for (int j = 0; j < fsw::pose::kCropSide; ++j)
    for (int i = 0; i < fsw::pose::kCropSide; ++i) {
      const fsw::Vector2 at((i + 0.5) / 4.0 - 0.5, (j + 0.5) / 4.0 - 0.5);
      if ((at - cell).norm() > reach) continue;
      sum += static_cast<double>(crop.samples[static_cast<std::size_t>(j * fsw::pose::kCropSide + i)]);
      ++count;
    }
  return count > 0 ? sum / count : 0.0;
}

// What is drawn stands where the labels say: about the middle of the eight corners there is more light than at the
// crop's edge, and mirrored labels would not all have it so. Only crops with a dark sky and the Sun behind the camera.
TEST(CropMaker, TargetStandsWhereTheLabelsSay) {
  LabelledCrop crop;
  int looked_at = 0;
  for (int index = 0; index < 80; ++index) {
    maker().make(index, crop);
    const Circumstances& c = crop.circumstances;
    if (c.phase_angle > 1.2 || c.glow_electrons > 0.0 || c.nadir_camera.z() > 0.2) continue;
    const auto& link = maker().camera().region;
    bool is_inside = true;
    fsw::Vector2 middle = fsw::Vector2::Zero();
    for (std::size_t k = 0; k < 8; ++k) {
      middle += 0.125 * crop.cells[k];
      is_inside = is_inside && crop.counts[k] && crop.pixels[k].x() > link.x && crop.pixels[k].y() > link.y &&
                  crop.pixels[k].x() < link.x + link.width && crop.pixels[k].y() < link.y + link.height;
    }
    if (!is_inside) continue;
    ++looked_at;
    EXPECT_GT(mean_about(crop, middle, 3.0), 3.0 * mean_about(crop, {0.0, 0.0}, 2.0)) << index;
  }
  EXPECT_GT(looked_at, 8);
}

/// The same crop by the scene renderer of the simulation.
fsw::pose::CropSamples crop_of_scene(const LabelledCrop& crop, twins::camera::TargetRenderer& target) {
  const Circumstances& c = crop.circumstances;
  auto camera = maker().camera();
  camera.exposure_s *= c.exposure;
  camera.optics.point_spread_sigma_px = c.point_spread_sigma_px;
  const double half = 0.5 * c.region.side_px + 2.0;
  const auto begin = [](double at, int least) { return std::max(static_cast<int>(std::floor(at)), least); };
  const auto end = [](double at, int most) { return std::min(static_cast<int>(std::ceil(at)), most); };
  const auto link = camera.region;
  auto& region = camera.region;
  region.x = begin(c.region.centre_px.x() - half, link.x);
  region.y = begin(c.region.centre_px.y() - half, link.y);
  region.width = end(c.region.centre_px.x() + half, link.x + link.width) - region.x;
  region.height = end(c.region.centre_px.y() + half, link.y + link.height) - region.y;

  target.set_materials(crop.materials);
  std::vector<twins::camera::LightSample> samples;
  twins::camera::SceneRenderer scene(
      camera, mission::data_directory(),
      [&](const twins::camera::ObjectView& seen, std::vector<twins::camera::LightSample>& out) {
        twins::camera::TargetView view;
        view.position_camera = seen.position_camera;
        view.R_camera_body = seen.R_camera_body;
        view.sun_camera = seen.sun_direction_camera;
        view.sun_photons_per_m2_s = seen.sun_photons_per_m2_s;
        view.nadir_camera = seen.earth_direction_camera;
        view.earth_photons_per_m2_s = seen.earth_photons_per_m2_s;
        view.earth_half_angle = seen.earth_half_angle;
        view.texel_pitch = 0.5 * seen.pixel_rad;
        target.render(view, samples);
        out.insert(out.end(), samples.begin(), samples.end());
      });
  twins::camera::Exposure exposure;
  const fsw::Matrix3 R_camera_eci = c.q_camera_eci.toRotationMatrix();
  exposure.q_camera_eci = c.q_camera_eci;
  exposure.camera_position_eci = -7078137.0 * (R_camera_eci.transpose() * c.nadir_camera);
  exposure.sun_eci = twins::camera::kAstronomicalUnit * (R_camera_eci.transpose() * c.sun_camera);
  exposure.moon_eci = -3.8e8 * (R_camera_eci.transpose() * fsw::Vector3::UnitZ());  // behind the camera
  exposure.years_since_j2000 = 11.8;
  twins::camera::ObjectInView tango;
  const fsw::Vector3 centre_of_mass(0.0, 0.018823529411764704, 0.160794117647059);
  tango.position_eci = R_camera_eci.transpose() * (c.centre_of_mass_camera - c.R_camera_body * centre_of_mass);
  tango.q_body_eci = Eigen::Quaterniond(fsw::Matrix3(c.R_camera_body.transpose() * R_camera_eci));
  tango.sunlit = c.sunlit;
  exposure.objects.push_back(tango);

  twins::camera::PhotonImage photons;
  scene.render(exposure, photons);
  std::vector<std::uint16_t> dn;
  twins::camera::Detector(camera, 99, "test").expose(photons, 0, dn);
  fsw::pose::CropSamples cut;
  const fsw::imaging::ImageFrame frame{region.width, region.height, region.x, region.y, 12};
  EXPECT_EQ(fsw::pose::cut_crop({frame, dn}, c.region, 64.0, cut, false), fsw::Status::kOk);
  return cut;
}

// Sun, sky and Earth's light of the simulation, through its own lens on its own fine grid. What is left is noise of the
// detector (0.1 to 0.4 a sample) and, where edges are sharp, the coarser lens of training: found are 4 to 7 % of the
// root mean square, and light alike to 1 %, to 5 % where the Sun grazes a face (crop 23): the shadow map of a coarser
// picture is coarser too.
TEST(CropMaker, ShowsWhatTheSimulationShows) {
  twins::camera::TargetRenderer target(
      twins::camera::load_cad_model(mission::data_directory() / "models" / "tango.obj"));
  LabelledCrop crop;
  int looked_at = 0;
  for (int index = 0; index < 200 && looked_at < 4; ++index) {
    engine::RandomStream stream(1, fmt::format("crops/training/{}", index));
    const Circumstances c = draw_circumstances(maker().camera(), maker().shape(), stream);
    const bool is_lit = c.phase_angle < 1.2 && c.sunlit == 1.0;
    if (!is_lit || c.glow_electrons > 0.0 || c.nadir_camera.z() > 0.2 || c.centre_of_mass_camera.norm() < 11.0)
      continue;
    ++looked_at;
    maker().make(index, crop);
    const auto twin = crop_of_scene(crop, target);
    double light = 0.0, twin_light = 0.0, off = 0.0;
    for (std::size_t i = 0; i < twin.size(); ++i) {
      const double ours = static_cast<double>(crop.samples[i]), theirs = static_cast<double>(twin[i]);
      light += ours * ours;
      twin_light += theirs * theirs;
      off += (ours - theirs) * (ours - theirs);
    }
    EXPECT_NEAR(light / twin_light, 1.0, 0.06) << index;
    EXPECT_LT(std::sqrt(off / twin_light), 0.08) << index;
  }
  EXPECT_EQ(looked_at, 4);
}

}  // namespace

namespace {

constexpr double kDegree = M_PI / 180.0;

std::vector<Circumstances> draw(int count) {
  const auto data = mission::data_directory();
  const auto camera = close_range_camera(data);
  const TargetShape shape = TargetShape::load(data, "tango");
  engine::RandomStream stream(11, "circumstances");
  std::vector<Circumstances> all;
  for (int i = 0; i < count; ++i) all.push_back(draw_circumstances(camera, shape, stream));
  return all;
}

// The definition of the project: 17 mm behind 11.72 um pixels, 1450 of them.
TEST(Circumstances, CameraIsTheBinnedOne) {
  const auto camera = close_range_camera(mission::data_directory());
  EXPECT_NEAR(camera.focal_length_px(), 17.0 / 0.01172, 1e-9);
  EXPECT_EQ(camera.region, (twins::camera::Region{80, 50, 800, 500}));
  EXPECT_DOUBLE_EQ(camera.optics.principal_point_px[0], 479.5);
  EXPECT_DOUBLE_EQ(camera.optics.principal_point_px[1], 299.5);
  EXPECT_DOUBLE_EQ(camera.detector.full_well_electrons, 128000.0);
}

// Radiance of a matt white surface: albedo / pi of what falls on it; a pixel sees the square of its angle.
TEST(Circumstances, NominalExposureFillsSixTenthsWithWhite) {
  const auto camera = close_range_camera(mission::data_directory());
  const double sun = twins::camera::sun_photons(camera.zero_magnitude_photons, twins::camera::kAstronomicalUnit);
  const double pixel_rad = 0.01172 / 17.0;
  constexpr double kWhite = 0.78;
  const double electrons =
      sun * kWhite / M_PI * pixel_rad * pixel_rad * camera.electrons_per_photon_m2() * kNominalExposureS;
  EXPECT_NEAR(electrons / 128000.0, 0.6, 0.02);
}

TEST(Circumstances, StayWithinTheirBounds) {
  const auto camera = close_range_camera(mission::data_directory());
  const double earth_radius = std::asin(6378.137 / 7078.137);
  for (const Circumstances& c : draw(3000)) {
    const double range = c.centre_of_mass_camera.norm();
    EXPECT_GT(range, 4.0);
    EXPECT_LT(range, 15.0);
    EXPECT_NEAR((c.R_camera_body.transpose() * c.R_camera_body - fsw::Matrix3::Identity()).norm(), 0.0, 1e-12);
    const double phase = std::acos(-c.sun_camera.dot(c.centre_of_mass_camera.normalized()));
    EXPECT_NEAR(phase, c.phase_angle, 1e-6);
    EXPECT_LT(phase, 150.001 * kDegree);
    EXPECT_GT(std::acos(c.sun_camera.z()), 25.0 * kDegree);
    EXPECT_GT(std::acos(c.sun_camera.dot(c.nadir_camera)), earth_radius);
    EXPECT_GE(c.exposure, 0.5);
    EXPECT_LE(c.exposure, 2.0);
    EXPECT_GE(c.point_spread_sigma_px, 0.25);
    EXPECT_LE(c.point_spread_sigma_px, 0.9);
    const double radius_px = 0.722 * camera.focal_length_px() / range;  // Tango's farthest keypoint
    EXPECT_GT(c.region.side_px, 0.84 * 2.2 * radius_px);
    EXPECT_LT(c.region.side_px, 1.31 * 2.2 * radius_px);
  }
}

// Shares that the training of 54,000 crops relies on; 3000 draws tell a share to 0.03 at three deviations.
TEST(Circumstances, SharesAreThoseMeant) {
  const auto all = draw(3000);
  double behind = 0.0, penumbra = 0.0, earth = 0.0, phase = 0.0;
  for (const Circumstances& c : all) {
    behind += c.phase_angle > 130.0 * kDegree ? 1.0 : 0.0;
    penumbra += c.sunlit < 1.0 ? 1.0 : 0.0;
    earth += std::acos(c.nadir_camera.z()) < 76.3 * kDegree ? 1.0 : 0.0;
    phase += c.phase_angle;
  }
  const double n = static_cast<double>(all.size());
  EXPECT_NEAR(behind / n, 0.03, 0.01);
  EXPECT_NEAR(penumbra / n, 0.02, 0.01);
  EXPECT_NEAR(earth / n, 0.3, 0.03);
  EXPECT_NEAR(phase / n, 73.5 * kDegree, 6.0 * kDegree);
}

// Of attitudes uniform on SO(3) every body axis points everywhere: its mean is near zero, its square a third.
TEST(Circumstances, AttitudesAreUniform) {
  const auto all = draw(3000);
  fsw::Vector3 mean = fsw::Vector3::Zero(), square = fsw::Vector3::Zero();
  for (const Circumstances& c : all) {
    const fsw::Vector3 axis = c.R_camera_body.col(2);
    mean += axis / static_cast<double>(all.size());
    square += axis.cwiseAbs2() / static_cast<double>(all.size());
  }
  // Three deviations: 3 / sqrt(3 * 3000), and 3 * sqrt(4 / 45 / 3000).
  EXPECT_LT(accuracy::largest_entry(mean), 0.04);
  EXPECT_LT(accuracy::largest_entry(square - fsw::Vector3::Constant(1.0 / 3.0)), 0.02);
}

}  // namespace

}  // namespace vbar::training
