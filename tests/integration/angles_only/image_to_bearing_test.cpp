// From light to bearing, without an orbit in between: images as the digital camera makes them, through tiles, into
// angles-only tracking, which is told the servicer's orbit and an expected place of the target. What it says is compared
// with where camera and target truly were.

#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "fsw/angles_only/angles_only_tracking.h"
#include "fsw/imaging/image_assembly.h"
#include "fsw/orbit/rtn.h"
#include "fsw/packets/messages.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/twins/camera/exposure_of_truth.h"
#include "host_sim/twins/camera/image_maker.h"
#include "host_sim/twins/camera/scene.h"

namespace vbar::test {
namespace {

using fsw::Matrix3;
using fsw::Vector3;
using twins::camera::CameraSettings;
using twins::camera::Exposure;

constexpr double kArcsec = 3.14159265358979323846 / 648000.0;

CameraSettings quiet_camera() {
  CameraSettings camera;
  camera.detector.hot_pixels = 20;
  return camera;
}

fsw::angles_only::CameraSettings calibrated(const CameraSettings& camera) {
  fsw::angles_only::CameraSettings settings;
  settings.frame = {camera.region.width, camera.region.height, camera.region.x, camera.region.y, camera.detector.bits};
  settings.model.focal_length_px.setConstant(camera.focal_length_px());
  settings.model.principal_point_px = {camera.optics.principal_point_px[0], camera.optics.principal_point_px[1]};
  settings.detector.gain_dn_per_electron = camera.detector.gain_dn_per_electron;
  settings.zero_magnitude_dn = camera.zero_magnitude_photons * camera.electrons_per_photon_m2() * camera.exposure_s *
                               camera.detector.gain_dn_per_electron;
  settings.R_camera_body.setIdentity();
  return settings;
}

/// A servicer on a circular orbit of 98 degrees, its camera looking back along its path at a target that follows.
struct Scene {
  fsw::GpsTime time;
  fsw::orbit::CartesianState servicer;
  fsw::orbit::CartesianState target;
  Matrix3 R_camera_eci = Matrix3::Identity();  ///< true
  Exposure exposure;
};

Scene scene_at(double minutes, double range_m, std::mt19937& random, std::int64_t number) {
  Scene scene;
  std::normal_distribution<double> normal;
  scene.time = truth::gps_from_utc("2011-07-18T01:00:00Z") + fsw::nearest_duration(60.0 * minutes);
  const double radius = 7078e3;
  const double rate = std::sqrt(3.986004415e14 / (radius * radius * radius));
  const double inclination = 98.2 * M_PI / 180.0;
  const double node = 207.0 * M_PI / 180.0;
  const auto state_at = [&](double angle) {
    const Vector3 p(std::cos(node), std::sin(node), 0.0);
    const Vector3 q(-std::sin(node) * std::cos(inclination), std::cos(node) * std::cos(inclination),
                    std::sin(inclination));
    return fsw::orbit::CartesianState{radius * (std::cos(angle) * p + std::sin(angle) * q),
                                      radius * rate * (-std::sin(angle) * p + std::cos(angle) * q)};
  };
  const double angle = rate * 60.0 * minutes;
  scene.servicer = state_at(angle);
  scene.target = state_at(angle - range_m / radius);
  const Vector3 z = (scene.target.position_eci - scene.servicer.position_eci).normalized();
  const Vector3 x = z.cross(scene.servicer.position_eci).normalized();
  Matrix3 ideal;
  ideal << x.transpose(), z.cross(x).transpose(), z.transpose();
  const Vector3 error = 60.0 * kArcsec * Vector3(normal(random), normal(random), normal(random));
  scene.R_camera_eci = Eigen::AngleAxisd(error.norm(), error.normalized()).toRotationMatrix() * ideal;

  twins::TruthSnapshot truth;
  truth.time = scene.time;
  truth.spacecraft.resize(2);
  truth.spacecraft[0].name = "servicer";
  truth.spacecraft[0].orbit = scene.servicer;
  const Vector3 rate_eci = rate * scene.servicer.position_eci.cross(scene.servicer.velocity_eci).normalized();
  truth.spacecraft[0].attitude =
      truth::AttitudeState{Eigen::Quaterniond(scene.R_camera_eci), scene.R_camera_eci * rate_eci};
  truth.spacecraft[1].name = "target";
  truth.spacecraft[1].orbit = scene.target;
  truth.spacecraft[1].attitude = truth::AttitudeState{Eigen::Quaterniond::Identity(), Vector3::Zero()};
  twins::camera::CameraMount mount;
  mount.spacecraft = "servicer";
  mount.models = {{"target", "sphere", Vector3::Zero()}};
  scene.exposure = twins::camera::exposure_of_truth(mount, truth, number);
  return scene;
}

class Chain {
 public:
  Chain() : renderer_(camera_, VBAR_SOURCE_DIR "/data"), maker_({camera_, "camera", 1, 1, 0}, [this](const Exposure& e, twins::camera::PhotonImage& image) { renderer_.render(e, image); }) {
    tracking_->configure(calibrated(camera_));
  }

  const fsw::angles_only::Sighting& look(const Scene& scene) {
    for (const twins::Packet& bytes : maker_.packets_of(scene.exposure)) {
      const auto packet = fsw::packets::parse_packet(bytes);
      const auto tile = fsw::packets::decode<image_tile>(packet.value());
      EXPECT_EQ(assembly_->take(packet.value().header.time, 0, tile.value()), fsw::Status::kOk);
    }
    fsw::angles_only::Circumstances circumstances;
    circumstances.is_orbit_known = true;
    circumstances.servicer = scene.servicer;
    circumstances.velocity_over_c_eci =
        (scene.exposure.earth_velocity_bcrs + scene.servicer.velocity_eci) / 299792458.0;
    const Vector3 z = (scene.target.position_eci - scene.servicer.position_eci).normalized();
    const Vector3 x = z.cross(scene.servicer.position_eci).normalized();
    Matrix3 commanded;
    commanded << x.transpose(), z.cross(x).transpose(), z.transpose();
    circumstances.R_camera_eci = commanded;
    fsw::Matrix6 covariance = fsw::Matrix6::Identity();
    const double range = (scene.target.position_eci - scene.servicer.position_eci).norm();
    covariance.topLeftCorner<3, 3>() *= std::pow(1e-3 * range, 2);
    covariance.bottomRightCorner<3, 3>() *= std::pow(1e-6 * range, 2);
    const auto relative = fsw::orbit::relative_state_rtn(scene.servicer, scene.target);
    circumstances.target = fsw::tracking::prediction_of(relative, covariance).value();
    const auto& sighting = tracking_->process({assembly_->image_time(), assembly_->image_number(), assembly_->tiles_missing(), assembly_->view()}, circumstances);
    assembly_->clear();
    return sighting;
  }
  [[nodiscard]] std::span<const fsw::imaging::DetectedObject> objects() const { return tracking_->objects(); }

 private:
  CameraSettings camera_ = quiet_camera();
  twins::camera::SceneRenderer renderer_;
  twins::camera::ImageMaker maker_;
  std::unique_ptr<fsw::imaging::ImageAssembly> assembly_ = std::make_unique<fsw::imaging::ImageAssembly>();
  std::unique_ptr<fsw::angles_only::AnglesOnlyTracking> tracking_ = std::make_unique<fsw::angles_only::AnglesOnlyTracking>();
};

TEST(ImageToBearing, KnowsWhereItLooksAndWhereTheTargetIs) {
  std::mt19937 random(1);
  Chain chain;
  int bearings = 0;
  double noise2 = 0.0, attitude2 = 0.0;
  int attitudes = 0;
  Vector3 mean = Vector3::Zero();
  for (int k = 0; k < 100; ++k) {
    const Scene scene = scene_at(k, 60e3, random, k);
    const auto& sighting = chain.look(scene);
    const double attitude_error = Eigen::AngleAxisd(sighting.R_camera_eci * scene.R_camera_eci.transpose()).angle();
    const Vector3 boresight_error = sighting.R_camera_eci.row(2) - scene.R_camera_eci.row(2);
    const Vector3 truth = (scene.target.position_eci - scene.servicer.position_eci).normalized();
    const Vector3 error = scene.R_camera_eci * (sighting.bearing.direction_eci - truth);
    if (std::getenv("VBAR_PRINT"))
    printf("%3d status %d method %d objects %d stars %d target %d  bg %.1f noise %.2f  att %.1f (roll incl %.1f) sigma %.1f  err %.1f %.1f sigma %.1f\n", k, int(sighting.status), int(sighting.star_method), sighting.objects, sighting.stars, sighting.target, sighting.background_dn, sighting.noise_dn, boresight_error.norm() / kArcsec, attitude_error / kArcsec, sighting.attitude_sigma / kArcsec, error.x() / kArcsec, error.y() / kArcsec, sighting.bearing.sigma / kArcsec);
    if (sighting.stars > 0) { attitude2 += boresight_error.squaredNorm(); ++attitudes; }
    if (sighting.status != fsw::angles_only::SightingStatus::kBearing) continue;
    ++bearings;
    mean += error;
    noise2 += error.squaredNorm() / 2.0;
  }
  printf("bearings %d of 100, rms %.2f arcsec each axis, bias %.2f %.2f; attitudes %d, boresight rms %.2f\n", bearings, std::sqrt(noise2 / bearings) / kArcsec, mean.x() / bearings / kArcsec, mean.y() / bearings / kArcsec, attitudes, std::sqrt(attitude2 / attitudes) / kArcsec);
}

}  // namespace
}  // namespace vbar::test
