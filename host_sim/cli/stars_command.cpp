#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "host_sim/cli/commands.h"
#include "host_sim/files/output_file.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/star_images/grey_image.h"
#include "host_sim/star_images/star_fix.h"
#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::app {
namespace {

using fsw::Vector3;
using fsw::imaging::CameraModel;
using star_images::FixSettings;
using star_images::ImageObjects;
using star_images::StarFix;

constexpr double kSpeedOfLight = 299792458.0;         // m/s
constexpr double kDegree = std::numbers::pi / 180.0;  // rad
constexpr double kArcsecond = kDegree / 3600.0;       // rad
constexpr double kSearchStep = 0.001;                 // the identification tolerates some 0.2 %

struct Image {
  std::filesystem::path file;
  ImageObjects objects;
  std::optional<StarFix> fix;
};

Vector3 velocity_over_c(const std::string& utc) {
  if (utc.empty()) return Vector3::Zero();
  try {
    return truth::earth_velocity_bcrs(truth::tt_of(truth::gps_from_utc(utc))) / kSpeedOfLight;
  } catch (const std::invalid_argument& error) {
    throw Refused(fmt::format("--utc: {}", error.what()));
  }
}

Image read_image(const std::filesystem::path& file, const StarsOptions& options) {
  try {
    const star_images::GreyImage image = star_images::read_grey_image(file);
    fsw::imaging::DetectorSettings detector;
    detector.detection_sigmas = options.detection_sigmas;
    detector.saturation_dn = image.bits == 8 ? 250 : 4000;
    return {.file = file, .objects = star_images::detect_objects(image, detector), .fix = std::nullopt};
  } catch (const star_images::ImageRefused& error) {
    throw Refused(error.what());
  }
}

CameraModel lens_of(const StarsOptions& options, const ImageObjects& image) {
  CameraModel camera;
  camera.focal_length_px = fsw::Vector2::Constant(options.focal_length_px);
  camera.principal_point_px = {0.5 * image.width - 0.5, 0.5 * image.height - 0.5};
  if (options.principal_point_px.size() == 2)
    camera.principal_point_px = {options.principal_point_px[0], options.principal_point_px[1]};
  for (std::size_t k = 0; k < options.distortion.size(); ++k) camera.distortion[k] = options.distortion[k];
  return camera;
}

/// Identifies an image with the focal length given and then, alternately longer and shorter, with others.
std::optional<StarFix> identify(const Image& image, FixSettings settings, double search_percent) {
  const fsw::Vector2 given = settings.camera.focal_length_px;
  const int steps = static_cast<int>(search_percent / 100.0 / kSearchStep);
  for (int k = 0; k <= 2 * steps; ++k) {
    const int step = k % 2 == 0 ? -k / 2 : (k + 1) / 2;
    settings.camera.focal_length_px = given * (1.0 + kSearchStep * step);
    if (std::optional<StarFix> fix = star_images::identify(image.objects, settings)) return fix;
  }
  return std::nullopt;
}

/// Position angle of the image's upward direction, from north through east, rad.
double roll_of(const fsw::Matrix3& R_camera_eci) {
  const Vector3 boresight = R_camera_eci.row(2);
  const Vector3 up = -R_camera_eci.row(1);
  const Vector3 east = Vector3::UnitZ().cross(boresight).normalized();
  return std::atan2(up.dot(east), up.dot(boresight.cross(east)));
}

double turned(double angle_rad) {
  return std::remainder(angle_rad - std::numbers::pi, 2.0 * std::numbers::pi) + std::numbers::pi;
}

void print_fix(const std::filesystem::path& file, std::size_t objects, const StarFix& fix) {
  const Vector3 boresight = fix.R_camera_eci.row(2);
  const Eigen::Quaterniond q(fix.R_camera_eci);
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  fmt::print("{}\n", file.string());
  fmt::print("    stars            {} of {} objects, residual {:.3f} px rms; by chance: e^{:.0f}\n", fix.stars.size(),
             objects, star_images::residual_rms_px(fix), fix.log_chance);
  fmt::print("    boresight        right ascension {:.5f} deg, declination {:.5f} deg, 1 sigma {:.1f} arcsec\n",
             turned(std::atan2(boresight.y(), boresight.x())) / kDegree, std::asin(boresight.z()) / kDegree,
             fix.sigma_rad / kArcsecond);
  fmt::print("    roll             {:.4f} deg from north through east, 1 sigma {:.1f} arcsec\n",
             turned(roll_of(fix.R_camera_eci)) / kDegree, fix.sigma_roll_rad / kArcsecond);
  fmt::print("    q_camera_eci     [{:.9f}, {:.9f}, {:.9f}, {:.9f}]\n", sign * q.w(), sign * q.x(), sign * q.y(),
             sign * q.z());
}

void print_lens(const star_images::LensCalibration& lens) {
  const auto& distortion = lens.camera.distortion;
  fmt::print("lens by {} stars of {} images, {} left out: residual {:.3f} px rms\n", lens.stars, lens.fixes.size(),
             lens.outliers, lens.rms_px);
  fmt::print("    focal length     {:.2f} px, 1 sigma {:.2f} px\n", lens.camera.focal_length_px.x(),
             lens.focal_length_sigma_px);
  fmt::print("    distortion       [{:.5f}, {:.5f}, {:.6f}, {:.6f}, {:.5f}]\n", distortion[0], distortion[1],
             distortion[2], distortion[3], distortion[4]);
  fmt::print("    1 sigma          [{:.5f}, {:.5f}, {:.6f}, {:.6f}]\n", lens.distortion_sigma[0],
             lens.distortion_sigma[1], lens.distortion_sigma[2], lens.distortion_sigma[3]);
}

/// Identification and fit by turns: with the better lens more stars agree.
star_images::LensCalibration calibrate(std::vector<Image>& images, FixSettings settings) {
  constexpr int kTurns = 3;
  star_images::LensCalibration lens;
  for (int turn = 0; turn < kTurns; ++turn) {
    std::vector<StarFix> fixes;
    for (const Image& image : images)
      if (image.fix) fixes.push_back(*image.fix);
    lens = star_images::calibrate_lens(fixes, settings.camera);
    settings.camera = lens.camera;
    if (turn + 1 < kTurns)
      for (Image& image : images)
        if (std::optional<StarFix> fix = star_images::identify(image.objects, settings)) image.fix = fix;
  }
  std::size_t next = 0;
  for (Image& image : images)
    if (image.fix) image.fix = lens.fixes[next++];
  return lens;
}

void write_table(const std::filesystem::path& file, const std::vector<Image>& images) {
  std::string text = "image,hipparcos,magnitude_v,x_px,y_px,residual_x_px,residual_y_px\n";
  for (const Image& image : images) {
    if (!image.fix) continue;
    for (const star_images::SeenStar& star : image.fix->stars)
      text += fmt::format("{},{},{:.2f},{:.3f},{:.3f},{:.3f},{:.3f}\n", image.file.filename().string(), star.hipparcos,
                          star.magnitude, star.pixel.x(), star.pixel.y(), star.residual_px.x(), star.residual_px.y());
  }
  files::replace_text_file(file, text);
}

}  // namespace

int stars_command(const StarsOptions& options) {
  FixSettings settings;
  settings.centroid_floor_px = options.centroid_floor_px;
  settings.velocity_over_c_eci = velocity_over_c(options.utc);
  std::vector<Image> images;
  bool is_any_missing = false, is_any_found = false;
  for (const std::filesystem::path& file : options.images) {
    Image& image = images.emplace_back(read_image(file, options));
    const ImageObjects& first = images.front().objects;
    if (image.objects.width != first.width || image.objects.height != first.height)
      throw Refused(fmt::format("{}: found {} x {} pixels; accepted: {} x {}, those of the first image", file.string(),
                                image.objects.width, image.objects.height, first.width, first.height));
    settings.camera = lens_of(options, image.objects);
    image.fix = identify(image, settings, options.search_percent);
    (image.fix ? is_any_found : is_any_missing) = true;
  }
  if (options.calibrate && is_any_found) print_lens(calibrate(images, settings));
  for (const Image& image : images) {
    if (image.fix) {
      print_fix(image.file, image.objects.objects.size(), *image.fix);
    } else {
      files::print_error("vbar", fmt::format("{}: {} objects, no attitude agrees with them; noise {:.1f}, background "
                                             "{:.0f} of 4095",
                                             image.file.string(), image.objects.objects.size(), image.objects.noise_dn,
                                             image.objects.background_dn));
    }
  }
  if (!options.table.empty()) write_table(options.table, images);
  return is_any_missing ? kFailed : kDone;
}

}  // namespace vbar::app
