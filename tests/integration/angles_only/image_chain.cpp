#include "tests/integration/angles_only/image_chain.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>

#include "fsw/orbit/rtn.h"
#include "fsw/packets/messages.h"
#include "fsw/vision/imaging/image_assembly.h"
#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/twins/camera/exposure.h"
#include "tests/support/paths.h"

namespace vbar::test {
namespace {

using fsw::Matrix3;
using fsw::Vector3;
using fsw::orbit::CartesianState;

constexpr double kRadius_m = 7078e3;
const double kRate = std::sqrt(3.986004415e14 / (kRadius_m * kRadius_m * kRadius_m));

fsw::GpsTime time_of(double minutes) {
  return truth::gps_from_utc("2011-07-18T01:00:00Z") + fsw::nearest_duration(60.0 * minutes);
}

/// z along the boresight, -y as near to the zenith as that allows.
Matrix3 camera_axes(const Vector3& boresight_eci, const Vector3& zenith_eci) {
  const Vector3 x = boresight_eci.cross(zenith_eci).normalized();
  Matrix3 R;
  R << x.transpose(), boresight_eci.cross(x).transpose(), boresight_eci.transpose();
  return R;
}

fsw::target_tracking::CameraSettings calibrated(const twins::camera::CameraSettings& camera) {
  fsw::target_tracking::CameraSettings settings;
  settings.frame = {camera.region.width, camera.region.height, camera.region.x, camera.region.y, camera.detector.bits};
  settings.model.focal_length_px.setConstant(camera.focal_length_px());
  settings.model.principal_point_px = {camera.optics.principal_point_px[0], camera.optics.principal_point_px[1]};
  settings.detector.gain_dn_per_electron = camera.detector.gain_dn_per_electron;
  settings.zero_magnitude_dn = camera.zero_magnitude_photons * camera.electrons_per_photon_m2() * camera.exposure_s *
                               camera.detector.gain_dn_per_electron;
  return settings;
}

}  // namespace

CartesianState SceneMaker::servicer_at(double minutes, double behind_m) {
  const double inclination = 98.2 * EIGEN_PI / 180.0;
  const double node = 207.0 * EIGEN_PI / 180.0;
  const double angle = kRate * 60.0 * minutes - behind_m / kRadius_m;
  const Vector3 p(std::cos(node), std::sin(node), 0.0);
  const Vector3 q(-std::sin(node) * std::cos(inclination), std::cos(node) * std::cos(inclination),
                  std::sin(inclination));
  return {kRadius_m * (std::cos(angle) * p + std::sin(angle) * q),
          kRadius_m * kRate * (-std::sin(angle) * p + std::cos(angle) * q)};
}

Vector3 SceneMaker::sun_eci(double minutes) {
  return truth::sun_moon_series(truth::tt_of(time_of(minutes))).sun_eci;
}

Vector3 SceneMaker::moon_eci(double minutes) {
  return truth::sun_moon_series(truth::tt_of(time_of(minutes))).moon_eci;
}

Scene SceneMaker::next(double range_m) {
  const double minutes = made_;
  const CartesianState target = servicer_at(minutes, range_m);
  return make(minutes, target, (target.position_eci - servicer_at(minutes).position_eci).normalized());
}

Scene SceneMaker::looking(double minutes, const Vector3& boresight_eci, const Vector3& target_eci, double range_m) {
  CartesianState target = servicer_at(minutes);
  target.position_eci += range_m * target_eci;
  return make(minutes, target, boresight_eci);
}

Scene SceneMaker::make(double minutes, const CartesianState& target, const Vector3& boresight_eci) {
  Scene scene;
  scene.servicer = servicer_at(minutes);
  scene.target = target;
  scene.R_commanded_eci = camera_axes(boresight_eci, scene.servicer.position_eci.normalized());
  std::normal_distribution<double> normal(0.0, 40.0 * kArcsec);
  const Vector3 error(normal(random_), normal(random_), normal(random_));
  scene.R_camera_eci = Eigen::AngleAxisd(error.norm(), error.normalized()).toRotationMatrix() * scene.R_commanded_eci;

  twins::TruthSnapshot truth;
  truth.time = time_of(minutes);
  truth.spacecraft.resize(2);
  truth.spacecraft[0].name = "servicer";
  truth.spacecraft[0].orbit = scene.servicer;
  const Vector3 rate_eci = kRate * scene.servicer.position_eci.cross(scene.servicer.velocity_eci).normalized();
  truth.spacecraft[0].attitude =
      truth::AttitudeState{Eigen::Quaterniond(scene.R_camera_eci), scene.R_camera_eci * rate_eci};
  truth.spacecraft[1].name = "target";
  truth.spacecraft[1].orbit = scene.target;
  truth.spacecraft[1].attitude = truth::AttitudeState{Eigen::Quaterniond::Identity(), Vector3::Zero()};
  twins::camera::CameraMount mount;
  mount.spacecraft = "servicer";
  mount.models = {{"target", "sphere", Vector3::Zero()}};
  scene.exposure = twins::camera::exposure_of_truth(mount, truth, made_++);
  return scene;
}

ImageChain::ImageChain(std::uint64_t seed)
    : renderer_(camera_, vbar::tests::source_path("data")),
      maker_({camera_, "servicer/camera", seed, 1, 0},
             [this](const twins::camera::Exposure& exposure, twins::camera::PhotonImage& image) {
               renderer_.render(exposure, image);
             }) {
  tracking_->configure(calibrated(camera_));
}

std::vector<image_tile> ImageChain::tiles_of(const Scene& scene, std::span<const std::uint16_t> dn) const {
  std::vector<image_tile> tiles;
  for (const twins::Packet& bytes : twins::camera::packets_of(maker_.settings(), scene.exposure, dn)) {
    const auto packet = fsw::packets::parse_packet(bytes);
    tiles.push_back(fsw::packets::decode<image_tile>(packet.value()).value());
  }
  return tiles;
}

void ImageChain::configure(const twins::camera::CameraSettings& camera, double centroid_floor_px) {
  auto settings = calibrated(camera);
  settings.centroid_floor_px = centroid_floor_px;
  tracking_->configure(settings);
}

const fsw::target_tracking::Sighting& ImageChain::look_at(const Scene& scene, std::span<const std::uint16_t> dn) {
  return process(scene, tiles_of(scene, dn));
}

const fsw::target_tracking::Sighting& ImageChain::look(const Scene& scene, const Spoil& spoil) {
  std::vector<image_tile> tiles = tiles_of(scene, image_of(scene));
  if (spoil) spoil(tiles);
  return process(scene, tiles);
}

const fsw::target_tracking::Sighting& ImageChain::look_at_uniform(const Scene& scene, int dn) {
  return look(scene, [dn](std::vector<image_tile>& tiles) {
    for (image_tile& tile : tiles) {
      const std::vector<std::uint16_t> pixels(static_cast<std::size_t>(tile.pixels), static_cast<std::uint16_t>(dn));
      if (fsw::imaging::pack_pixels(pixels, tile.bits, tile.data) == 0) throw std::runtime_error("pixels do not fit");
    }
  });
}

const fsw::target_tracking::Sighting& ImageChain::process(const Scene& scene, const std::vector<image_tile>& tiles) {
  for (const image_tile& tile : tiles) static_cast<void>(assembly_->take(scene.exposure.time, 0, tile));
  fsw::target_tracking::ImagePriors priors;
  priors.is_orbit_known = true;
  priors.servicer = scene.servicer;
  priors.velocity_over_c_eci = (scene.exposure.earth_velocity_bcrs + scene.servicer.velocity_eci) / 299792458.0;
  priors.R_camera_eci = scene.R_commanded_eci;
  // A thousandth of the range, and a part in a million of it a second.
  const double range = (scene.target.position_eci - scene.servicer.position_eci).norm();
  fsw::Matrix6 covariance = fsw::Matrix6::Zero();
  covariance.diagonal().head<3>().setConstant(1e-6 * range * range);
  covariance.diagonal().tail<3>().setConstant(1e-12 * range * range);
  const auto prediction =
      fsw::target_tracking::prediction_of(fsw::orbit::relative_state_rtn(scene.servicer, scene.target), covariance);
  if (prediction.ok()) priors.target = prediction.value();
  priors.detection_probability = scene.exposure.objects.at(0).sunlit > 0.5 ? 0.95 : 0.0;
  const auto& sighting = tracking_->process(
      {assembly_->image_time(), assembly_->image_number(), assembly_->tiles_missing(), assembly_->view()}, priors);
  if (assembly_->has_image()) assembly_->clear();
  return sighting;
}

}  // namespace vbar::test
