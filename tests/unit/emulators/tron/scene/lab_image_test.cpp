// Images of the laboratory against the digital twin's, closed forms and an independent picture of the board.

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "emulators/tron/scene/lab_renderer.h"
#include "hil_drivers/tron/geometry/board_design.h"
#include "tests/support/figures.h"
#include "tests/unit/emulators/tron/scene/lab_scenes.h"

namespace vbar::tron::bench::tests {
namespace {

std::filesystem::path data() {
  return vbar::tests::source_path("data");
}

/// A renderer for each set of switches costs a second; tests share them.
LabRenderer& ideal() {
  static LabRenderer renderer(tron_bench(), GapSettings::none(), 1, data());
  return renderer;
}

LabRenderer& complete() {
  static LabRenderer renderer(tron_bench(), {}, 1, data());
  return renderer;
}

float at(const camera::PhotonImage& image, int x, int y) {
  return image.electrons[static_cast<std::size_t>((y - image.region.y) * image.region.width + x - image.region.x)];
}

double interpolated(const camera::PhotonImage& image, const Vector2& pixel) {
  const int x = static_cast<int>(std::floor(pixel.x())), y = static_cast<int>(std::floor(pixel.y()));
  const double u = pixel.x() - x, v = pixel.y() - y;
  return (1 - v) * ((1 - u) * static_cast<double>(at(image, x, y)) + u * static_cast<double>(at(image, x + 1, y))) +
         v * ((1 - u) * static_cast<double>(at(image, x, y + 1)) + u * static_cast<double>(at(image, x + 1, y + 1)));
}

double sum_of(const camera::PhotonImage& image) {
  double sum = 0.0;
  for (const float electrons : image.electrons) sum += static_cast<double>(electrons);
  return sum;
}

/// The board in the place of the mock-up; its normal (towards the viewer) is `facing`.
LabView board_view(double distance_m, const Vector3& facing) {
  LabView view = view_of(distance_m);
  view.box_powers.fill(0.0);
  view.T_L_board = Eigen::Isometry3d::Identity();
  const Vector3 z = -facing.normalized(), x = Vector3::UnitZ().cross(facing).normalized();
  Matrix3 R;
  R << x, z.cross(x), z;
  view.T_L_board->linear() = R;
  view.T_L_board->translation() = Vector3(6.5, 0.0, 1.4);
  return view;
}

Vector2 pixel_of(const LabView& view, const Vector3& place_B) {
  const camera::Optics optics(view.camera);
  return optics.project(view.T_L_C.inverse() * (*view.T_L_board * place_B)).value();
}

Vector3 middle_of_patch() {
  const auto corners = calibrate::BoardDesign{}.patch();
  return 0.5 * (corners[0] + corners[2]);
}

struct Agreement {
  double even_over_noise = 0.0;     ///< root mean square where the light is even
  double edge_over_contrast = 0.0;  ///< root mean square elsewhere
  double even_pixels = 0.0, edge_pixels = 0.0;
};

/// Per pixel of the target. Noise: of shot and read-out. Even: within a fifth over 5 x 5 pixels.
Agreement agreement(const camera::PhotonImage& lab, const camera::PhotonImage& twin) {
  Agreement result;
  for (int y = 102; y < 1098; ++y)
    for (int x = 162; x < 1758; ++x) {
      const double b = static_cast<double>(at(twin, x, y)), off = static_cast<double>(at(lab, x, y)) - b;
      if (!(b > 10.0)) continue;
      accuracy::Smallest low;
      accuracy::Largest high;
      for (int v = -2; v <= 2; ++v)
        for (int u = -2; u <= 2; ++u) {
          low.add(at(twin, x + u, y + v));
          high.add(at(twin, x + u, y + v));
        }
      const double contrast = high - low;
      if (contrast < 0.2 * b) {
        result.even_over_noise += off * off / (b + 49.0);
        result.even_pixels += 1.0;
      } else {
        result.edge_over_contrast += off * off / (contrast * contrast);
        result.edge_pixels += 1.0;
      }
    }
  result.even_over_noise = std::sqrt(result.even_over_noise / result.even_pixels);
  result.edge_over_contrast = std::sqrt(result.edge_over_contrast / result.edge_pixels);
  return result;
}

// Without any part of the gap the laboratory is the digital twin: within the noise where the light is even. Both take
// four samples a pixel, so an edge's cover of a pixel is known to an eighth, and that is what they may differ by there.
TEST(LabImage, WithoutGapItIsTheDigitalTwins) {
  const TestbedDesign bench = tron_bench();
  const camera::CadModel model = camera::load_cad_model(data() / "models/tango.obj");
  camera::TargetRenderer renderer(model);
  for (const double distance : {2.5, 4.9}) {
    const LabView view = view_of(distance, some_attitude());
    const camera::PhotonImage lab = ideal().expected(view);
    const camera::PhotonImage twin = twin_image(renderer, bench, view, model.centre);
    EXPECT_NEAR(sum_of(lab) / sum_of(twin), 1.0, 0.005);
    const Agreement found = agreement(lab, twin);
    EXPECT_GT(found.even_pixels, 5000.0);
    EXPECT_LT(found.even_over_noise, 1.0);
    EXPECT_LT(found.edge_over_contrast, 0.125);
    double total = 0.0, moment_x = 0.0, moment_y = 0.0;
    for (int y = 100; y < 1100; ++y)
      for (int x = 160; x < 1760; ++x) {
        const double b = static_cast<double>(at(twin, x, y)), off = static_cast<double>(at(lab, x, y)) - b;
        moment_x += (x - 959.5) * off;
        moment_y += (y - 599.5) * off;
        total += b;
      }
    EXPECT_NEAR(moment_x / total, 0.0, 0.3);  // px, of the centroid; sum of the two errors of light and place
    EXPECT_NEAR(moment_y / total, 0.0, 0.3);
    std::printf("%.1f m: light %.5f; even: %.3f of the noise; edges: %.4f of the contrast; centroid %.3f %.3f px\n",
                distance, sum_of(lab) / sum_of(twin), found.even_over_noise, found.edge_over_contrast, moment_x / total,
                moment_y / total);
  }
}

// A white Lambert patch of albedo a under irradiance E has radiance a E cos(i) / pi.
TEST(LabImage, PatchInTheLampsLight) {
  const LabView view = board_view(2.5, Vector3(-1.0, -0.6, 0.0));
  const camera::PhotonImage& image = ideal().expected(view);
  const Vector2 pixel = pixel_of(view, middle_of_patch());
  const double sun = camera::sun_photons(view.camera.zero_magnitude_photons, camera::kAstronomicalUnit);
  const double cosine = Vector3(-1.0, -0.6, 0.0).normalized().dot(Lamp::direction(view.lamp.azimuth_rad));
  const double radiance = calibrate::BoardDesign{}.white_albedo / M_PI * 0.1 * sun * cosine;
  const camera::Optics optics(view.camera);
  const Vector2 across(0.5, 0.0), down(0.0, 0.5);
  const double solid_angle = (optics.direction_of(pixel + across) - optics.direction_of(pixel - across))
                                 .cross(optics.direction_of(pixel + down) - optics.direction_of(pixel - down))
                                 .norm();
  const double expected = radiance * solid_angle * view.camera.electrons_per_photon_m2() * view.camera.exposure_s *
                          optics.vignetting(pixel);
  EXPECT_NEAR(interpolated(image, pixel) / expected, 1.0, 2e-3);
}

// The same in the light of one box: ratio of the two is that of the irradiances (the box's in closed form elsewhere).
TEST(LabImage, PatchInTheLightOfABox) {
  GapSettings gap = GapSettings::none();
  gap.earth_light = true;
  LabRenderer renderer(tron_bench(), gap, 1, data());
  const Vector3 facing = Vector3(-1.0, 0.6, 0.3).normalized();
  LabView view = board_view(2.5, facing);
  const Vector2 pixel = pixel_of(view, middle_of_patch());
  view.lamp.power = 0.0;
  view.box_powers[6] = 0.5;
  const double by_box = interpolated(renderer.expected(view), pixel);
  view.lamp = {110.0 * M_PI / 180.0, 1.0};
  view.box_powers[6] = 0.0;
  view.T_L_board = board_view(2.5, Vector3(-1.0, -0.6, 0.3)).T_L_board;
  const Vector2 other = pixel_of(view, middle_of_patch());
  const double by_lamp = interpolated(renderer.expected(view), other);
  const camera::Optics optics(view.camera);
  const double cosine = Vector3(-1.0, -0.6, 0.3).normalized().dot(Lamp::direction(view.lamp.azimuth_rad));
  const auto boxes = box_lights(tron_bench(), {0, 0, 0, 0, 0, 0, 0.5, 0, 0, 0}, 1.0);
  const Vector3 place = board_view(2.5, facing).T_L_board.value() * middle_of_patch();
  const double ratio = irradiance_of(boxes[6], place, facing) / (0.1 * cosine);
  // 0.4 %: the two patches are at different places of the image (vignetting, solid angle).
  EXPECT_NEAR(by_box / by_lamp / ratio, 1.0, 4e-3);
}

// Behind a straight edge at distance h the light of a disc of half-angle r rises over the shadow with the distribution
// of the disc's chords, of standard deviation h r / 2.
TEST(LabImage, PenumbraOfTheLamp) {
  GapSettings gap = GapSettings::none();
  gap.lamp = gap.room = true;
  LabRenderer renderer(tron_bench(), gap, 1, data());
  LabView view = board_view(2.5, Lamp::direction(M_PI / 4.0));
  view.lamp = {M_PI / 4.0, 1.0};
  constexpr double kGap = 0.4, kRadius = 0.05;
  const Vector3 shaded = *view.T_L_board * middle_of_patch();
  const Vector3 above = shaded + kGap * Lamp::direction(M_PI / 4.0);
  const Vector3 along = view.T_L_board->linear().col(1);
  const camera::PhotonImage bright = renderer.expected(view);
  view.arms = {{above - 0.3 * along, above + 0.3 * along, kRadius}};
  const camera::PhotonImage& shadow = renderer.expected(view);
  // Lit fraction along x of the board, from the middle of the shadow outwards.
  double before = 0.0, weight = 0.0, mean = 0.0, square = 0.0;
  constexpr double kStep = 0.25e-3;
  for (double x = 0.0; x < 0.12; x += kStep) {
    const Vector2 pixel = pixel_of(view, middle_of_patch() + Vector3(x, 0.0, 0.0));
    const double lit = interpolated(shadow, pixel) / interpolated(bright, pixel);
    const double rise = x == 0.0 ? 0.0 : lit - before;
    before = lit;
    weight += rise;
    mean += rise * x;
    square += rise * x * x;
  }
  mean /= weight;
  const double deviation = std::sqrt(square / weight - mean * mean);
  // The shadow's edge is where the limb's is seen from the lamp, widened by the divergence by a fraction of
  // kGap / 15.7 m. Pixels, lens and shadow map widen by 0.8 mm, in squares.
  EXPECT_NEAR(mean, kRadius * (1.0 + kGap / 15.7), 1.5e-3);
  EXPECT_NEAR(deviation, std::hypot(0.5 * kGap * kLampRadiusRad, 0.8e-3), 0.4e-3);
}

// Markers begin 7 mm from a corner: 5.5 px at 3.5 m, beyond the window and the lens's spread.
// The board's picture around a corner by 12 x 12 rays a pixel, convolved as the lens does, and the displacement of the
// drawn one against it by least squares.
Vector2 displacement(const LabView& view, const camera::PhotonImage& image, const Vector3& corner_B) {
  constexpr int kHalf = 3, kReach = 3, kRays = 12, kSize = 2 * (kHalf + kReach) + 1;
  const camera::Optics optics(view.camera);
  const Vector2 corner = pixel_of(view, corner_B);
  const int x0 = static_cast<int>(std::lround(corner.x())) - kHalf - kReach;
  const int y0 = static_cast<int>(std::lround(corner.y())) - kHalf - kReach;
  const Eigen::Isometry3d T_B_C = view.T_L_board->inverse() * view.T_L_C;
  Plane model{kSize, kSize, std::vector<float>(kSize * kSize)};
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      int white = 0;
      for (int j = 0; j < kRays; ++j)
        for (int i = 0; i < kRays; ++i) {
          const Vector2 pixel(x0 + x + (i + 0.5) / kRays - 0.5, y0 + y + (j + 0.5) / kRays - 0.5);
          const Vector3 ray = T_B_C.linear() * optics.direction_of(pixel), from = T_B_C.translation();
          const Vector3 hit = from - from.z() / ray.z() * ray - corner_B;
          if (hit.x() * hit.y() > 0.0) ++white;
        }
      model.values[static_cast<std::size_t>(y * kSize + x)] = static_cast<float>(white) / (kRays * kRays);
    }
  LensBlur lens;
  camera::OpticsSettings core = view.camera.optics;
  core.halo_fraction = 0.0;
  lens.blur(core, 0.0, model);
  const auto model_at = [&](int x, int y) {
    return static_cast<double>(model.values[static_cast<std::size_t>((y + kReach) * kSize + x + kReach)]);
  };
  // image = offset + gain * model(x - dx, y - dy)
  Eigen::Matrix<double, Eigen::Dynamic, 4> A((2 * kHalf + 1) * (2 * kHalf + 1), 4);
  Eigen::VectorXd b(A.rows());
  Eigen::Index row = 0;
  for (int y = 0; y <= 2 * kHalf; ++y)
    for (int x = 0; x <= 2 * kHalf; ++x, ++row) {
      A.row(row) << 1.0, model_at(x, y), -0.5 * (model_at(x + 1, y) - model_at(x - 1, y)),
          -0.5 * (model_at(x, y + 1) - model_at(x, y - 1));
      b[row] = static_cast<double>(at(image, x0 + kReach + x, y0 + kReach + y));
    }
  const Eigen::Vector4d fit = A.colPivHouseholderQr().solve(b);
  return fit.tail<2>() / fit[1];
}

TEST(LabImage, CornersOfTheBoardAreWhereTheLensProjectsThem) {
  const calibrate::BoardDesign board;
  double squares = 0.0;
  Vector2 sum = Vector2::Zero();
  int corners = 0;
  for (const auto& [distance, facing] :
       {std::pair{1.3, Vector3(-1.0, -0.3, 0.1)}, std::pair{2.5, Vector3(-1.0, -0.7, 0.4)},
        std::pair{3.5, Vector3(-1.0, -0.2, -0.2)}}) {
    LabView view = board_view(distance, facing);
    view.T_L_board->rotate(Eigen::AngleAxisd(0.2, Vector3::UnitZ()));
    const camera::PhotonImage& image = ideal().expected(view);
    for (int id = 0; id < board.corner_count(); ++id) {
      const Vector2 pixel = pixel_of(view, board.corner(id));
      if (pixel.x() < 175.0 || pixel.x() > 1745.0 || pixel.y() < 115.0 || pixel.y() > 1085.0) continue;
      const Vector2 miss = displacement(view, image, board.corner(id));
      sum += miss;
      squares += miss.squaredNorm();
      ++corners;
    }
  }
  EXPECT_GT(corners, 120);
  // Bias, and root mean square; a single corner is off by 0.1 px at most.
  EXPECT_LT(accuracy::largest_entry(sum / corners), 0.03);
  EXPECT_LT(std::sqrt(squares / corners), 0.03);
}

TEST(LabImage, SameBitsForTheSameView) {
  LabView view = view_of(2.5, some_attitude());
  view.arms = {{{6.7, -0.3, 1.0}, {7.0, 0.0, 0.5}, 0.08}};
  const std::vector<std::uint16_t> first = complete().expose(view);
  static_cast<void>(complete().expose(board_view(2.5, Vector3(-1.0, -0.3, 0.1))));
  EXPECT_EQ(complete().expose(view), first);
  view.frame = 1;
  EXPECT_NE(complete().expose(view), first);  // other noise
}

// A view without light is not drawn. It is the limit of faint light, and has the same offset and noise.
TEST(LabImage, WithoutLightThereIsNothing) {
  LabView view = view_of(2.5, some_attitude());
  view.box_powers.fill(0.0);
  view.lamp.power = 1e-9;
  const double faint = sum_of(complete().expected(view));
  EXPECT_GT(faint, 0.0);
  EXPECT_LT(faint, 10.0);
  const std::vector<std::uint16_t> almost = complete().expose(view);
  view.lamp.power = 0.0;
  EXPECT_EQ(sum_of(complete().expected(view)), 0.0);
  EXPECT_EQ(complete().expose(view), almost);
  view.box_powers[3] = 1e-3;
  EXPECT_GT(sum_of(complete().expected(view)), 0.0);
}

// Each switch alone changes the image of the target, or of the sensor.
TEST(LabImage, EverySwitchHasItsShare) {
  const LabView view = view_of(2.5, some_attitude());
  const camera::PhotonImage base = ideal().expected(view);
  for (bool GapSettings::*part : {&GapSettings::surfaces, &GapSettings::shape, &GapSettings::lamp,
                                  &GapSettings::earth_light, &GapSettings::room, &GapSettings::focus}) {
    GapSettings gap = GapSettings::none();
    gap.*part = true;
    LabRenderer renderer(tron_bench(), gap, 1, data());
    EXPECT_NE(renderer.expected(view).electrons, base.electrons);
  }
  GapSettings gap = GapSettings::none();
  gap.detector = true;
  LabRenderer renderer(tron_bench(), gap, 1, data());
  LabView other_sensor = view;
  other_sensor.camera.detector.photo_response_nonuniformity = 0.01;
  EXPECT_EQ(renderer.expected(other_sensor).electrons, base.electrons);
  EXPECT_NE(renderer.expose(other_sensor), ideal().expose(other_sensor));
}

TEST(LabImage, ATargetBehindTheCameraIsNotSeen) {
  LabView view = view_of(2.5);
  view.T_L_C.linear() = view.T_L_C.linear() * Eigen::AngleAxisd(M_PI, Vector3::UnitY()).toRotationMatrix();
  EXPECT_EQ(sum_of(ideal().expected(view)), 0.0);
}

TEST(LabImage, ImpossibleViewsAreRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const auto& change) {
    LabView view = view_of(2.5);
    change(view);
    EXPECT_THROW(static_cast<void>(ideal().expected(view)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(complete().expose(view)), std::invalid_argument);
  };
  refused([](LabView& v) { v.T_L_C.translation() = v.T_L_T.translation(); });
  refused([&](LabView& v) { v.T_L_C.translation().x() = kNan; });
  refused([&](LabView& v) { v.T_L_T.linear()(0, 0) = kNan; });
  refused([](LabView& v) { v.T_L_T.linear() *= 2.0; });
  refused([](LabView& v) { v.T_L_T.linear().col(0) *= -1.0; });
  refused([&](LabView& v) { v.lamp.azimuth_rad = kNan; });
  refused([&](LabView& v) { v.lamp.power = kNan; });
  refused([](LabView& v) { v.lamp.power = -0.1; });
  refused([&](LabView& v) { v.box_powers[3] = kNan; });
  refused([](LabView& v) { v.box_powers[9] = -1.0; });
  refused([&](LabView& v) { v.camera.exposure_s = kNan; });
  refused([](LabView& v) { v.camera.exposure_s = 0.0; });
  refused([](LabView& v) { v.camera.region = {0, 0, 0, 100}; });
  refused([](LabView& v) { v.camera.region = {1000, 0, 1000, 100}; });
  refused([](LabView& v) { v.camera.region = {2147483000, 0, 1000, 100}; });
  refused([&](LabView& v) { v.camera.optics.distortion[1] = kNan; });
  refused([&](LabView& v) { v.camera.optics.focal_length_mm = kNan; });
  refused([&](LabView& v) { v.arms = {{{kNan, 0, 0}, {1, 0, 0}, 0.1}}; });
  refused([](LabView& v) { v.arms = {{{0, 0, 0}, {1, 0, 0}, -0.1}}; });
  refused([&](LabView& v) {
    v.T_L_board = v.T_L_T;
    v.T_L_board->translation().y() = kNan;
  });
}

}  // namespace
}  // namespace vbar::tron::bench::tests
