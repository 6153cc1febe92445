#include "host_sim/training/circumstances.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "host_sim/mission/body_file.h"
#include "host_sim/sensors/settings/camera_file.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::training {

TargetShape TargetShape::load(const std::filesystem::path& data_directory, const std::string& target) {
  const std::filesystem::path file = mission::body_file_of(data_directory, target);
  const fsw::Vector3 centre_of_mass = mission::load_body(file).centre_of_mass_m;
  const std::vector<fsw::Vector3> from_origin = mission::load_keypoints(file, fsw::pose::kKeypoints);
  TargetShape shape;
  std::copy(from_origin.begin(), from_origin.end(), shape.keypoints.begin());
  shape.model_origin = -centre_of_mass;
  for (fsw::Vector3& keypoint : shape.keypoints) {
    keypoint -= centre_of_mass;
    shape.radius_m = std::max(shape.radius_m, keypoint.norm());
  }
  return shape;
}

namespace {

using twins::camera::Material;

constexpr double kMaxReflected = 0.95;
constexpr double kMaxExponent = 3000.0;

Material grey(const Material& like, double diffuse, double specular, double exponent) {
  const double sum = diffuse + specular;
  const double by = sum > kMaxReflected ? kMaxReflected / sum : 1.0;
  Material material = like;
  material.diffuse.fill(by * diffuse);
  material.specular.fill(by * specular);
  material.exponent = std::min(exponent, kMaxExponent);
  return material;
}

Material near(const Material& own, engine::RandomStream& stream) {
  // Inside the range that training excludes, also after rounding.
  constexpr double kNear = 0.999 * kOwnFamily;
  double diffuse = stream.uniform(-kNear, kNear) * own.grey_diffuse();
  double specular = stream.uniform(-kNear, kNear) * own.grey_specular();
  const double exponent = own.exponent * stream.uniform(1.0 - kNear, 1.0 + kNear);
  // Limited to physical reflectivities: then part of the way.
  const double own_sum = own.grey_diffuse() + own.grey_specular();
  const double part = std::min(1.0, (kMaxReflected - own_sum) / std::max(diffuse + specular, 1e-9));
  diffuse = own.grey_diffuse() + part * diffuse;
  specular = own.grey_specular() + part * specular;
  return grey(own, diffuse, specular, exponent);
}

Material far(std::span<const Material> file, std::size_t which, engine::RandomStream& stream) {
  constexpr double kSwapped = 0.3;
  constexpr int kTries = 100;  // one in ten is too close
  const Material& own = file[which];
  Material drawn;
  for (int i = 0; i < kTries; ++i) {
    const Material& like = stream.uniform() < kSwapped ? file[index_below(file.size(), stream)] : own;
    const double diffuse = like.grey_diffuse() * log_uniform(0.3, 3.0, stream);
    const double specular = like.grey_specular() * log_uniform(0.3, 3.0, stream);
    drawn = grey(own, diffuse, specular, like.exponent * log_uniform(0.2, 5.0, stream));
    if (!is_of_own_family(drawn, own)) return drawn;
  }
  return grey(own, 0.5 * own.grey_diffuse(), 0.5 * own.grey_specular(), own.exponent);
}

}  // namespace

bool is_of_own_family(const Material& drawn, const Material& own) {
  const auto is_near = [](double value, double reference) {
    return std::abs(value - reference) <= kOwnFamily * reference;
  };
  return is_near(drawn.grey_diffuse(), own.grey_diffuse()) && is_near(drawn.grey_specular(), own.grey_specular());
}

std::vector<Material> draw_materials(CropKind kind, std::span<const Material> file, engine::RandomStream& stream) {
  std::vector<Material> materials;
  for (std::size_t i = 0; i < file.size(); ++i)
    materials.push_back(kind == CropKind::kHeldOut ? near(file[i], stream) : far(file, i, stream));
  return materials;
}

namespace {

using fsw::Matrix3;
using fsw::Vector2;
using fsw::Vector3;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kEarthRadiusM = 6378137.0;
constexpr double kCropRadii = 2.2;  // side of a crop in apparent radii of the target

/// The target's centre on the detector: mostly with the complete target in the image if it fits, else anywhere.
Vector2 draw_centre(const twins::camera::Region& region, double radius_px, engine::RandomStream& stream) {
  const bool is_whole = stream.uniform() < 0.9;
  const auto along = [&](int first, int pixels) {
    const double least = 0.1 * pixels;
    const double half = is_whole ? std::max(least, 0.5 * pixels - radius_px) : 0.5 * pixels;
    return first + 0.5 * (pixels - 1) + stream.uniform(-half, half);
  };
  const double x = along(region.x, region.width);
  return {x, along(region.y, region.height)};
}

/// A random attitude of the sky about the camera, with the Earth's centre along nadir_camera.
Eigen::Quaterniond draw_sky(engine::RandomStream& stream) {
  return attitude(stream);
}

void draw_light(Circumstances& drawn, engine::RandomStream& stream) {
  const double earth_radius = std::asin(kEarthRadiusM / (kEarthRadiusM + kAltitudeM));
  const double limb_in_field = earth_radius + 12.0 * kDegree;
  const Vector3 to_camera = -drawn.centre_of_mass_camera.normalized();
  const bool is_level = stream.uniform() < 0.7;
  const bool is_behind = stream.uniform() < 0.03;
  constexpr int kTries = 200;
  for (int i = 0; i < kTries; ++i) {
    const double down = is_level ? stream.uniform(limb_in_field, 115.0 * kDegree) : stream.uniform(0.0, limb_in_field);
    drawn.nadir_camera = at_angle(Vector3::UnitZ(), down, stream);
    drawn.phase_angle = (is_behind ? stream.uniform(130.0, 150.0) : stream.uniform(15.0, 130.0)) * kDegree;
    drawn.sun_camera = at_angle(to_camera, drawn.phase_angle, stream);
    const double from_nadir = std::acos(std::clamp(drawn.sun_camera.dot(drawn.nadir_camera), -1.0, 1.0));
    const double from_boresight = std::acos(std::clamp(drawn.sun_camera.z(), -1.0, 1.0));
    if (from_nadir > earth_radius && from_boresight > 25.0 * kDegree) break;
  }
  drawn.sunlit = stream.uniform() < 0.02 ? stream.uniform(0.1, 1.0) : 1.0;
  drawn.glow_electrons = stream.uniform() < 0.2 ? log_uniform(5.0, 2000.0, stream) : 0.0;
  drawn.glow_slope.x() = stream.uniform(-0.4, 0.4);
  drawn.glow_slope.y() = stream.uniform(-0.4, 0.4);
}

}  // namespace

twins::camera::CameraSettings close_range_camera(const std::filesystem::path& data_directory) {
  sensors::CameraFile file = sensors::load_camera(data_directory / "cameras" / "tron.toml");
  file.binning = 2;
  twins::camera::CameraSettings camera = file.settings();
  twins::camera::DetectorSettings& detector = camera.detector;
  detector.bits = 12;
  detector.offset_dn = 64.0;
  detector.gain_dn_per_electron = 0.03125;
  camera.region = {(detector.width - 800) / 2, (detector.height - 500) / 2, 800, 500};
  camera.exposure_s = kNominalExposureS;
  return camera;
}

Circumstances draw_circumstances(const twins::camera::CameraSettings& camera, const TargetShape& shape,
                                 engine::RandomStream& stream) {
  const twins::camera::Optics optics(camera);
  Circumstances drawn;
  const double range = stream.uniform(kMinRangeM, kMaxRangeM);
  const double radius_px = shape.radius_m * optics.focal_length_px() / range;
  const Vector2 centre_px = draw_centre(camera.region, radius_px, stream);
  drawn.centre_of_mass_camera = range * optics.direction_of(centre_px);
  drawn.R_camera_body = attitude(stream).toRotationMatrix();
  draw_light(drawn, stream);
  drawn.q_camera_eci = draw_sky(stream);
  drawn.exposure = log_uniform(0.5, 2.0, stream);
  drawn.point_spread_sigma_px = stream.uniform(0.25, 0.9);
  drawn.region.side_px = kCropRadii * radius_px * log_uniform(0.85, 1.3, stream);
  const double off_x = stream.uniform(-0.1, 0.1), off_y = stream.uniform(-0.1, 0.1);
  drawn.region.centre_px = centre_px + drawn.region.side_px * Vector2(off_x, off_y);
  return drawn;
}

}  // namespace vbar::training
