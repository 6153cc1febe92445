#pragma once
// One exposure of the emulator, from what is on the screen to the numbers of the camera: optics, light and
// detector without sockets or processes.

#include <cstdint>
#include <vector>

#include "hil_drivers/optical_stimulator/bench/bench_settings.h"
#include "hil_drivers/optical_stimulator/bench/camera/camera_head.h"
#include "hil_drivers/optical_stimulator/bench/faults/fault_list.h"
#include "hil_drivers/optical_stimulator/bench/light/light_path.h"
#include "hil_drivers/optical_stimulator/bench/screen/panel.h"

namespace vbar::optical_stimulator::bench {

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
