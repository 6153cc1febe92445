#include "host_sim/training/crop_maker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <fmt/format.h>

#include "host_sim/mission/body_file.h"
#include "host_sim/training/circumstances.h"
#include "host_sim/twins/camera/earth_disc.h"
#include "host_sim/twins/camera/photometry.h"
#include "host_sim/twins/camera/point_spread.h"

namespace vbar::training {

namespace {

std::vector<float> kernel_of(double sigma_px) {
  const int reach = static_cast<int>(std::ceil(3.5 * sigma_px));
  std::vector<double> weights;
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(std::exp(-0.5 * k * k / (sigma_px * sigma_px)));
    sum += weights.back();
  }
  std::vector<float> kernel;
  for (const double weight : weights) kernel.push_back(static_cast<float>(weight / sum));
  return kernel;
}

}  // namespace

void soften(double sigma_px, int width, int height, std::vector<float>& picture) {
  if (!(sigma_px >= 0.05)) return;
  const std::vector<float> kernel = kernel_of(sigma_px);
  const int reach = static_cast<int>(kernel.size() / 2);
  std::vector<float> across(picture.size(), 0.0F);
  for (int y = 0; y < height; ++y) {
    const float* const from = picture.data() + static_cast<std::ptrdiff_t>(y) * width;
    float* const to = across.data() + static_cast<std::ptrdiff_t>(y) * width;
    for (int k = -reach; k <= reach; ++k) {
      const float weight = kernel[static_cast<std::size_t>(k + reach)];
      const int first = std::max(0, k), last = std::min(width, width + k);
      for (int x = first; x < last; ++x) to[x] += weight * from[x - k];
    }
  }
  std::fill(picture.begin(), picture.end(), 0.0F);
  for (int y = 0; y < height; ++y) {
    float* const to = picture.data() + static_cast<std::ptrdiff_t>(y) * width;
    for (int k = std::max(-reach, y - height + 1); k <= std::min(reach, y); ++k) {
      const float weight = kernel[static_cast<std::size_t>(k + reach)];
      const float* const from = across.data() + static_cast<std::ptrdiff_t>(y - k) * width;
      for (int x = 0; x < width; ++x) to[x] += weight * from[x];
    }
  }
}

namespace {

using fsw::Vector2;
using fsw::Vector3;
using twins::camera::CameraSettings;
using twins::camera::EarthDisc;
using twins::camera::ImagePoint;
using twins::camera::LightSample;
using twins::camera::Region;

constexpr std::array<int, 10> kWindowSides{144, 176, 208, 256, 304, 368, 448, 544, 672, 832};
constexpr double kMarginPx = 12.0;  // light from beside the crop
constexpr double kTexels = 256.0;   // across the target: one and a half to three a sample of the crop
constexpr double kEarthRadiusM = 6378137.0;
// Variance of a pixel as a box, which gathering by bilinear weights exceeds by as much again.
constexpr double kPixelVariance = 1.0 / 12.0;
constexpr double kYearsSinceJ2000 = 11.8;

/// Camera and Sun in ECI, geocentric.
struct Place {
  explicit Place(const Circumstances& c) {
    const fsw::Matrix3 R_eci_camera = c.q_camera_eci.toRotationMatrix().transpose();
    camera_eci = -(kEarthRadiusM + kAltitudeM) * (R_eci_camera * c.nadir_camera);
    sun_eci = twins::camera::kAstronomicalUnit * (R_eci_camera * c.sun_camera);
  }
  Vector3 camera_eci, sun_eci;
};

double sun_photons_of(const CameraSettings& camera) {
  return twins::camera::sun_photons(camera.zero_magnitude_photons, twins::camera::kAstronomicalUnit);
}

}  // namespace

CropMaker::CropMaker(const std::filesystem::path& data_directory, const std::string& target, CropKind kind,
                     std::uint64_t seed)
    : kind_(kind),
      seed_(seed),
      camera_(close_range_camera(data_directory)),
      optics_(camera_),
      shape_(TargetShape::load(data_directory, target)),
      model_(twins::camera::load_cad_model(mission::cad_source_of(data_directory, target))),
      renderer_(model_),
      silhouette_(model_),
      sky_(twins::camera::StarSky::load(data_directory / camera_.star_catalogue_file, camera_.zero_magnitude_photons)) {
}

void CropMaker::make(std::int64_t index, LabelledCrop& crop) {
  engine::RandomStream stream(seed_, fmt::format("crops/{}/{}", name_of(kind_), index));
  crop.circumstances = draw_circumstances(camera_, shape_, stream);
  const Circumstances& c = crop.circumstances;
  crop.materials = draw_materials(kind_, model_.materials, stream);
  renderer_.set_materials(crop.materials);
  label(crop);

  CameraSettings camera = camera_;
  camera.exposure_s *= c.exposure;
  camera.optics.point_spread_sigma_px = c.point_spread_sigma_px;
  place_window(c);
  photons_.region = window_;
  photons_.electrons.assign(static_cast<std::size_t>(window_.width) * static_cast<std::size_t>(window_.height), 0.0F);
  draw_earth(c, camera);
  draw_stars(c, camera);
  draw_target(c, camera);
  draw_background(c);
  read_out(index);

  const fsw::imaging::ImageFrame frame{window_.width, window_.height, window_.x, window_.y, camera.detector.bits};
  const fsw::Status status =
      fsw::pose::cut_crop({frame, dn_}, c.region, camera.detector.offset_dn, crop.samples, false);
  if (status != fsw::Status::kOk)
    throw std::runtime_error(fmt::format("crop {} of {} px cannot be cut", index, c.region.side_px));
}

void CropMaker::label(LabelledCrop& crop) const {
  const Circumstances& c = crop.circumstances;
  for (std::size_t k = 0; k < shape_.keypoints.size(); ++k) {
    const auto pixel = optics_.project(c.centre_of_mass_camera + c.R_camera_body * shape_.keypoints[k]);
    crop.counts[k] = pixel.has_value();
    crop.pixels[k] = pixel.value_or(Vector2::Zero());
    crop.cells[k] = c.region.place_of(crop.pixels[k], fsw::pose::kMapSide);
    for (const double cell : crop.cells[k])
      if (!(cell >= -1.0 && cell <= fsw::pose::kMapSide)) crop.counts[k] = false;
  }
}

void CropMaker::place_window(const Circumstances& c) {
  const double wanted = c.region.side_px + 2.0 * kMarginPx;
  int side = kWindowSides.back();
  for (auto i = kWindowSides.rbegin(); i != kWindowSides.rend(); ++i)
    if (*i >= wanted) side = *i;
  const auto first = [&](double centre) { return static_cast<int>(std::lround(centre - 0.5 * (side - 1))); };
  window_ = {first(c.region.centre_px.x()), first(c.region.centre_px.y()), side, side};
}

/// In blocks no larger than a sample of the crop.
void CropMaker::draw_earth(const Circumstances& c, const CameraSettings& camera) {
  const Place place(c);
  const EarthDisc earth(place.camera_eci, place.sun_eci);
  const double half_diagonal = 0.75 * window_.width / optics_.focal_length_px();
  const Vector2 middle(window_.x + 0.5 * window_.width, window_.y + 0.5 * window_.height);
  const double off = std::acos(std::clamp(optics_.direction_of(middle).dot(c.nadir_camera), -1.0, 1.0));
  if (off > earth.angular_radius() + half_diagonal + 0.05) return;

  const double pixel_rad = 1.0 / optics_.focal_length_px();
  const double from_surface = EarthDisc::radiance(sun_photons_of(camera)) * camera.electrons_per_photon_m2() *
                              camera.exposure_s * pixel_rad * pixel_rad;
  const fsw::Matrix3 R_eci_camera = c.q_camera_eci.toRotationMatrix().transpose();
  const int block = std::clamp(static_cast<int>(c.region.side_px / fsw::pose::kCropSide), 1, 4);
  for (int y = 0; y < window_.height; y += block)
    for (int x = 0; x < window_.width; x += block) {
      const double to_middle = 0.5 * (block - 1);
      const Vector2 pixel(window_.x + x + to_middle, window_.y + y + to_middle);
      const Vector3 direction = optics_.direction_of(pixel);
      const twins::camera::EarthSight sight = earth.look(R_eci_camera * direction, block * pixel_rad);
      if (sight.covered == 0.0 || sight.cosine_of_sun <= 0.0) continue;
      const double solid_angle = direction.z() * direction.z() * direction.z();
      const auto electrons = static_cast<float>(sight.covered * sight.cosine_of_sun * from_surface * solid_angle *
                                                optics_.vignetting(pixel));
      for (int j = y; j < std::min(y + block, window_.height); ++j)
        for (int i = x; i < std::min(x + block, window_.width); ++i)
          photons_.at(window_.x + i, window_.y + j) += electrons;
    }
}

void CropMaker::draw_stars(const Circumstances& c, const CameraSettings& camera) {
  const Place place(c);
  const EarthDisc earth(place.camera_eci, place.sun_eci);
  const fsw::Matrix3 R_camera_eci = c.q_camera_eci.toRotationMatrix();
  const twins::camera::Cone cone = optics_.cone_of(window_, kMarginPx);
  twins::camera::PointSpread spread(camera.optics);
  stars_.clear();
  sky_.find(R_camera_eci.transpose() * cone.axis, cone.half_angle, kYearsSinceJ2000, Vector3::Zero(), stars_);
  for (const twins::camera::ApparentStar& star : stars_) {
    const auto pixel = optics_.project(R_camera_eci * star.direction_eci);
    if (!pixel) continue;
    const double passed = 1.0 - earth.look(star.direction_eci, 1.0 / optics_.focal_length_px()).covered;
    const double electrons = passed * star.star->photons_per_m2_s * camera.electrons_per_photon_m2() *
                             camera.exposure_s * optics_.vignetting(*pixel);
    if (electrons > 1.0) spread.add(ImagePoint{*pixel, electrons}, Vector2::Zero(), photons_);
  }
}

/// In front of what was drawn so far.
void CropMaker::draw_target(const Circumstances& c, const CameraSettings& camera) {
  const Place place(c);
  const EarthDisc earth(place.camera_eci, place.sun_eci);
  const double sun_photons = sun_photons_of(camera);
  const Vector3 origin_camera = c.centre_of_mass_camera + c.R_camera_body * shape_.model_origin;
  const Vector3 earth_light = c.q_camera_eci.toRotationMatrix() * earth.light_eci(sun_photons);
  twins::camera::TargetView view;
  view.position_camera = origin_camera;
  view.R_camera_body = c.R_camera_body;
  view.sun_camera = c.sun_camera;
  view.sun_photons_per_m2_s = sun_photons;
  view.sunlit = c.sunlit;
  view.earth_photons_per_m2_s = earth_light.norm();
  view.nadir_camera = earth_light.norm() > 0.0 ? Vector3(earth_light.normalized()) : c.nadir_camera;
  view.earth_half_angle = earth.angular_radius();
  const double distance = (origin_camera + c.R_camera_body * model_.centre).norm();
  const double reach = std::sqrt(distance * distance - model_.radius_m * model_.radius_m);
  view.texel_pitch = 2.01 * model_.radius_m / reach / kTexels;
  const double texel_px = view.texel_pitch * optics_.focal_length_px();
  renderer_.render(view, samples_);

  target_.assign(photons_.electrons.size(), 0.0F);
  const double electrons_per_photon = camera.electrons_per_photon_m2() * camera.exposure_s;
  const int width = window_.width;
  for (const LightSample& sample : samples_) {
    const auto pixel = optics_.project(sample.direction_camera);
    if (!pixel) continue;
    const double x = pixel->x() - window_.x, y = pixel->y() - window_.y;
    if (!(x >= 0.0 && y >= 0.0 && x < width - 1.0 && y < window_.height - 1.0)) continue;
    const auto i = static_cast<int>(x), j = static_cast<int>(y);
    const double u = x - i, v = y - j;
    const double light = sample.photons_per_m2_s * electrons_per_photon * optics_.vignetting(*pixel);
    float* const cell = target_.data() + static_cast<std::ptrdiff_t>(j) * width + i;
    cell[0] += static_cast<float>(light * (1.0 - u) * (1.0 - v));
    cell[1] += static_cast<float>(light * u * (1.0 - v));
    cell[width] += static_cast<float>(light * (1.0 - u) * v);
    cell[width + 1] += static_cast<float>(light * u * v);
  }
  const double spread_px = std::max(c.point_spread_sigma_px, 0.7 * texel_px);
  const double sigma_px = std::sqrt(std::max(0.0, spread_px * spread_px - kPixelVariance));
  soften(sigma_px, width, window_.height, target_);
  halo_ = target_;
  soften(camera.optics.halo_sigma_px, width, window_.height, halo_);
  silhouette_.draw(optics_, origin_camera, c.R_camera_body, window_, covered_);
  soften(sigma_px, width, window_.height, covered_);
  const auto halo = static_cast<float>(camera.optics.halo_fraction);
  for (std::size_t p = 0; p < target_.size(); ++p)
    photons_.electrons[p] = photons_.electrons[p] * (1.0F - covered_[p]) + (1.0F - halo) * target_[p] + halo * halo_[p];
}

/// Stray light covers the whole image.
void CropMaker::draw_background(const Circumstances& c) {
  if (c.glow_electrons == 0.0) return;
  for (int y = 0; y < window_.height; ++y)
    for (int x = 0; x < window_.width; ++x) {
      const Vector2 from_middle((x + 0.5) / window_.width - 0.5, (y + 0.5) / window_.height - 0.5);
      const double glow = c.glow_electrons * c.exposure * (1.0 + 2.0 * c.glow_slope.dot(from_middle));
      photons_.electrons[static_cast<std::size_t>(y) * static_cast<std::size_t>(window_.width) +
                         static_cast<std::size_t>(x)] += static_cast<float>(glow);
    }
}

/// One detector for each size of window, at any position of the window.
twins::camera::Detector& CropMaker::detector() {
  const int side = window_.width;
  const auto found = detectors_.find(side);
  if (found != detectors_.end()) return found->second;
  CameraSettings camera = camera_;
  camera.region = {0, 0, side, side};
  return detectors_.try_emplace(side, camera, seed_, fmt::format("crops/{}", name_of(kind_))).first->second;
}

void CropMaker::read_out(std::int64_t index) {
  const Region at = window_;
  photons_.region = {0, 0, at.width, at.height};
  detector().expose(photons_, index, dn_);
  photons_.region = at;
  // Beyond what crosses the link there is no image.
  const Region& link = camera_.region;
  for (int y = 0; y < at.height; ++y)
    for (int x = 0; x < at.width; ++x) {
      const int column = at.x + x, row = at.y + y;
      const bool is_read =
          column >= link.x && column < link.x + link.width && row >= link.y && row < link.y + link.height;
      if (!is_read)
        dn_[static_cast<std::size_t>(y) * static_cast<std::size_t>(at.width) + static_cast<std::size_t>(x)] =
            fsw::imaging::kMissingPixel;
    }
}

}  // namespace vbar::training
