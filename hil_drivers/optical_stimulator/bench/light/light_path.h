#pragma once
// Conversion of the counts on the display to the expected photo-electrons on a region of the detector. Every lit pixel
// is spread over the detector at its place; the even black level of the display is added.

#include <cstdint>
#include <span>
#include <vector>

#include "hil_drivers/optical_stimulator/bench/light/bench_optics.h"
#include "hil_drivers/optical_stimulator/bench/light/display_light.h"
#include "hil_drivers/optical_stimulator/bench/light/spread_profile.h"
#include "host_sim/twins/camera/photon_image.h"

namespace vbar::optical_stimulator::bench {

/// Holds what the display shows for a part of an exposure.
struct ShownFrame {
  std::span<const std::uint8_t> counts;  ///< rows from the top
  double fraction = 1.0;                 ///< share of the exposure
};

struct LightPathSettings {
  int display_width = 1920, display_height = 1200;
  DisplayLight light;
  twins::camera::CameraSettings camera;  ///< lens, pupil and sensitivity; not its region
  std::uint64_t seed = 1;
};

class LightPath {
 public:
  /// `optics` outlives this.
  LightPath(const LightPathSettings& settings, const BenchOptics& optics);

  /// Discards results of the optics; to be called after the state of the optics changed.
  void optics_changed();

  /// Computes the light on `image`, whose region is set by the caller. `brightness`: of the display, 1 as in its settings.
  void expose(std::span<const ShownFrame> frames, double exposure_s, double brightness,
              twins::camera::PhotonImage& image);

 private:
  /// Holds a display pixel as it is seen, computed when it is lit first.
  struct Seen {
    float x = 0.0F, y = 0.0F, coma_x = 0.0F, coma_y = 0.0F;
    float electrons = 0.0F;     ///< a second and cd/m^2
    std::uint32_t version = 0;  ///< version of the optics
    std::uint32_t profile = 0;
  };

  const Seen& seen(std::size_t pixel, int u, int v);
  void add_frame(const ShownFrame& frame, double gain, twins::camera::PhotonImage& image);
  void add_pixel(const Seen& seen, float electrons, twins::camera::PhotonImage& image);
  void add_halo(twins::camera::PhotonImage& image);
  void add_black_level(double electrons_per_unit, twins::camera::PhotonImage& image);
  void choose_cells(const twins::camera::Region& region);
  void make_black_level(const twins::camera::Region& region);

  LightPathSettings settings_;
  const BenchOptics* optics_;
  CountTable luminance_;
  PixelEvenness evenness_;
  SpreadProfiles profiles_;
  double electrons_per_lux_s_;
  std::uint32_t version_ = 1;
  std::vector<Seen> seen_;
  // Region of the last exposure.
  twins::camera::Region region_;
  std::uint32_t region_version_ = 0;
  int cell_columns_, cell_rows_;
  std::vector<std::uint8_t> cell_is_near_;
  std::vector<float> black_;  ///< solid angle that sees the display, times transmission
  std::vector<float> work_;
};

}  // namespace vbar::optical_stimulator::bench
