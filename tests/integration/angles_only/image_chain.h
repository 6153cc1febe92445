#pragma once
// From light to bearing without an orbit in between: images as the digital camera makes them, through tiles, into
// angles-only tracking, which is given the servicer's orbit, the commanded pointing and an expected place of the
// target.

#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include "fsw/vision/imaging/image_assembly.h"
#include "fsw/vision/target_tracking/angles_only_tracking.h"
#include "host_sim/twins/camera/exposure.h"
#include "host_sim/twins/camera/image_maker.h"
#include "host_sim/twins/camera/scene.h"

namespace vbar::test {

inline constexpr double kArcsec = 3.14159265358979323846 / 648000.0;

/// Servicer and target as they truly are, and the exposure.
struct Scene {
  fsw::orbit::CartesianState servicer;
  fsw::orbit::CartesianState target;
  fsw::Matrix3 R_camera_eci = fsw::Matrix3::Identity();  ///< true
  fsw::Matrix3 R_commanded_eci = fsw::Matrix3::Identity();
  twins::camera::Exposure exposure;

  [[nodiscard]] fsw::Vector3 target_direction() const {
    return (target.position_eci - servicer.position_eci).normalized();
  }
};

/// A servicer on a circular orbit of 98 degrees and its target, a matt sphere of 0.7 m.
class SceneMaker {
 public:
  explicit SceneMaker(unsigned seed = 1) : random_(seed) {}

  /// The target `range_m` behind, a minute after the last scene; pointing errs by 40 arcsec about each axis.
  Scene next(double range_m);
  /// The camera commanded to look at `boresight_eci` and the target `range_m` away in direction `target_eci`.
  Scene looking(double minutes, const fsw::Vector3& boresight_eci, const fsw::Vector3& target_eci, double range_m);

  /// Geocentric, m, at a scene's time.
  static fsw::Vector3 sun_eci(double minutes);
  static fsw::Vector3 moon_eci(double minutes);
  static fsw::orbit::CartesianState servicer_at(double minutes, double behind_m = 0.0);

 private:
  Scene make(double minutes, const fsw::orbit::CartesianState& target, const fsw::Vector3& boresight_eci);

  std::mt19937 random_;
  int made_ = 0;
};

/// Camera and flight software.
class ImageChain {
 public:
  /// `seed`: of the camera's hot pixels and noise.
  explicit ImageChain(std::uint64_t seed = 1);

  using Spoil = std::function<void(std::vector<image_tile>&)>;

  /// `spoil` may change the tiles on their way.
  const fsw::target_tracking::Sighting& look(const Scene& scene, const Spoil& spoil = {});
  /// The same of an image of the same value in all pixels.
  const fsw::target_tracking::Sighting& look_at_uniform(const Scene& scene, int dn);

  /// The same of pixels that another camera has taken.
  const fsw::target_tracking::Sighting& look_at(const Scene& scene, std::span<const std::uint16_t> dn);
  /// The flight software is configured for that camera from now on; its centroids err by `centroid_floor_px`.
  void configure(const twins::camera::CameraSettings& camera, double centroid_floor_px);
  /// The pixels of the digital camera.
  std::vector<std::uint16_t> image_of(const Scene& scene) { return maker_.take(scene.exposure).dn; }

  [[nodiscard]] std::span<const fsw::imaging::DetectedObject> objects() const { return tracking_->objects(); }
  [[nodiscard]] const twins::camera::CameraSettings& camera() const { return camera_; }

 private:
  [[nodiscard]] std::vector<image_tile> tiles_of(const Scene& scene, std::span<const std::uint16_t> dn) const;
  const fsw::target_tracking::Sighting& process(const Scene& scene, const std::vector<image_tile>& tiles);

  twins::camera::CameraSettings camera_;
  twins::camera::SceneRenderer renderer_;
  twins::camera::ImageMaker maker_;
  std::unique_ptr<fsw::imaging::ImageAssembly> assembly_ = std::make_unique<fsw::imaging::ImageAssembly>();
  std::unique_ptr<fsw::target_tracking::AnglesOnlyTracking> tracking_ =
      std::make_unique<fsw::target_tracking::AnglesOnlyTracking>();
};

}  // namespace vbar::test
