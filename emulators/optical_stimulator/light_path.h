#pragma once
// Conversion of the counts on the display to the expected photo-electrons on a region of the detector. Every lit pixel
// is spread over the detector at its place; the even black level of the display is added.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "emulators/optical_stimulator/optics.h"
#include "host_sim/twins/camera/photon_image.h"

namespace vbar::optical_stimulator::bench {

// Light of a point in the pixels of a row: a Gaussian, integrated over the width of each pixel.

/// Spreads the light of a point with one width. The sum over the pixels is 1, and the centroid is the place, for every
/// place.
class SpreadProfile {
 public:
  explicit SpreadProfile(double sigma_px);

  /// Returns the number of pixels before and behind the nearest one.
  [[nodiscard]] int radius() const { return radius_; }
  /// Computes the weights of the 2 radius + 1 pixels for a point that is `offset` (-0.5 to 0.5) behind the centre of
  /// the middle one; offsets up to 1 are accepted.
  void weights(double offset, std::span<float> weights) const;

 private:
  int radius_;
  std::size_t stride_;
  std::vector<float> table_;
};

/// Holds the profiles of all widths, to 0.01 px, made when they are first asked for.
class SpreadProfiles {
 public:
  SpreadProfiles();
  /// Returns the profile of a width; widths beyond the widest count as the widest.
  [[nodiscard]] std::size_t index_of(double sigma_px) const;
  [[nodiscard]] const SpreadProfile& at(std::size_t index);

  static constexpr double kStep_px = 0.01;
  static constexpr double kWidest_px = 15.0;

 private:
  std::vector<const SpreadProfile*> known_;
  std::deque<SpreadProfile> profiles_;
};

// Wide halo of a camera's lens, from the image of its core.

/// Takes `fraction` of the light of every pixel and spreads it by a Gaussian of `sigma_px` (2 px or more: the halo is
/// computed on sums of 4 x 4 pixels). The light that leaves the image is lost. `work` is reused between calls.
void spread_halo(double fraction, double sigma_px, twins::camera::PhotonImage& image, std::vector<float>& work);

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

  /// Computes the light on `image`, whose region is set by the caller. `brightness`: of the display, 1 as in its
  /// settings.
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
