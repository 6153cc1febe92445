#pragma once
// Detector of the emulated camera: from expected photo-electrons to the numbers of the region that is read.

#include <cstdint>
#include <list>
#include <span>
#include <vector>

#include "hil_drivers/optical_stimulator/bench/bench_settings.h"
#include "host_sim/twins/camera/detector.h"
#include "host_sim/twins/camera/photon_image.h"

namespace vbar::optical_stimulator::bench {

struct ReadOut {
  double exposure_s = 0.2;
  double gain_db = 0.0;
  double black_level_dn = 64.0;
};

class CameraHead {
 public:
  /// `camera`: its own figures, camera_of().
  CameraHead(const twins::camera::CameraSettings& camera, std::uint64_t seed, bool has_noise);

  /// Exposes; `number` of the exposure is the key of its noise.
  void expose(const twins::camera::PhotonImage& image, const ReadOut& read_out, std::uint64_t number,
              std::vector<std::uint16_t>& dn);

  [[nodiscard]] std::span<const twins::camera::HotPixel> hot_pixels() const { return hot_pixels_; }
  [[nodiscard]] const twins::camera::CameraSettings& settings() const { return camera_; }

 private:
  struct Configured {
    twins::camera::CameraSettings settings;
    twins::camera::Detector detector;
  };
  [[nodiscard]] twins::camera::CameraSettings settings_for(const twins::camera::Region& region,
                                                           const ReadOut& read_out) const;
  twins::camera::Detector& detector_for(const twins::camera::CameraSettings& settings);

  twins::camera::CameraSettings camera_;
  std::uint64_t seed_;
  bool has_noise_;
  std::vector<twins::camera::HotPixel> hot_pixels_;
  std::list<Configured> detectors_;  ///< the last used first
};

}  // namespace vbar::optical_stimulator::bench
