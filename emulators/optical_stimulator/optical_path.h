#pragma once
// One exposure of the emulator, from what is on the screen to the numbers of the camera: optics, light and
// detector without sockets or processes.

#include <array>
#include <cstdint>
#include <list>
#include <span>
#include <vector>

#include "emulators/optical_stimulator/fault_list.h"
#include "emulators/optical_stimulator/light_path.h"
#include "emulators/optical_stimulator/screen.h"
#include "emulators/optical_stimulator/settings.h"
#include "host_sim/twins/camera/detector.h"
#include "host_sim/twins/camera/photon_image.h"

namespace vbar::optical_stimulator::bench {

// Displacement of the display between days and in a session.

struct Displacement {
  std::array<double, 2> um{};
  double scale_ppm = 0.0;
};

/// Returns the displacement after a number of exposures; constant over kDriftStep of them.
[[nodiscard]] Displacement drift_at(const DriftSettings& drift, std::uint64_t seed, std::uint64_t frame);

inline constexpr std::uint64_t kDriftStep = 64;

// Detector of the emulated camera: from expected photo-electrons to the numbers of the region that is read.

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

/// Holds the true places of the carriages.
struct RailPlaces {
  double lens_mm = 40.0;     ///< between the lenses
  double display_mm = 34.3;  ///< display behind lens 2
};

struct ExposureRequest {
  twins::camera::Region region;
  ReadOut read_out;
};

class OpticalPath {
 public:
  OpticalPath(const BenchSettings& settings, const twins::camera::CameraSettings& camera);

  /// Exposes exposure number `frame` of a panel that shows `pictures`.
  void expose(const Pictures& pictures, const ExposureRequest& request, const RailPlaces& rails,
              const ExposureFaults& faults, std::uint64_t frame, std::vector<std::uint16_t>& dn);

  /// Displaces the display, from the next exposure on.
  void bump(double x_um, double y_um);

  [[nodiscard]] const BenchOptics& optics() const { return optics_; }
  [[nodiscard]] const CameraHead& camera() const { return camera_; }
  /// Returns the expected photo-electrons of the last exposure.
  [[nodiscard]] const twins::camera::PhotonImage& light() const { return image_; }

 private:
  void set_state(const RailPlaces& rails, std::uint64_t frame);

  BenchSettings settings_;
  ErrorField field_;
  BenchOptics optics_;
  LightPath light_;
  CameraHead camera_;
  std::array<double, 2> bumped_um_{};
  twins::camera::PhotonImage image_;
};

}  // namespace vbar::optical_stimulator::bench
