#pragma once
// Charge beyond the full well of a pixel.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/photon_image.h"

namespace vbar::twins::camera {

struct BloomingSettings {
  double full_well_electrons = 0.0;
  double spilled_fraction =
      0.0;  ///< share of the charge beyond the full well that spills to the four neighbours; the rest is drained
};

/// Spills and drains what exceeds the full well in `charge` (rows of `width`, electrons), in rounds, each of all pixels
/// at once, so that no direction is preferred: a quarter of what spills goes to each neighbour, over the image's edge
/// it is lost. Afterwards no pixel holds more than the full well. The rounds end when no pixel exceeds it;
/// after kBloomingRounds the excess is drained. Returns the electrons drained or lost: these and those kept add up to
/// the input.
double bloom(const BloomingSettings& settings, int width, int height, std::vector<float>& charge);

inline constexpr int kBloomingRounds = 200;

// The detector: from expected photo-electrons to the numbers that are read.
//
//   charge = Poisson(response * photo-electrons + dark electrons)      shot noise of light and dark current together
//   charge beyond the full well spills to the neighbours or is drained (bloom())
//   DN     = round(offset + gain * (charge + read noise)), cut off at 0 and 2^bits - 1
//
// Response and dark current are of the pixel (fixed pattern, hot pixels); their values are drawn from the seed and are
// the same for the whole run. The noise of an exposure is a pure function of (seed, camera, exposure number, pixel).
// The model is that of the EMVA standard 1288, with blooming added.

/// A pixel whose dark current is far above the others'.
struct HotPixel {
  int x = 0, y = 0;  ///< on the detector
  double electrons_per_s = 0.0;
};

/// Draws places and sizes of the hot pixels of a region, from the seed.
[[nodiscard]] std::vector<HotPixel> draw_hot_pixels(const DetectorSettings& detector, const Region& region,
                                                    std::uint64_t seed, std::string_view camera_name);

class Detector {
 public:
  /// Makes a detector. The region of `settings` must not be empty. `camera_name` names the detector's random numbers.
  Detector(const CameraSettings& settings, std::uint64_t seed, std::string_view camera_name);

  /// Makes a detector whose hot pixels are known, so that all its regions have the same ones: those of `hot_pixels`
  /// that are in the region.
  Detector(const CameraSettings& settings, std::uint64_t seed, std::string_view camera_name,
           std::span<const HotPixel> hot_pixels);

  /// Exposes and reads the region: `dn` gets its pixels, rows from the top. Throws std::invalid_argument for an image
  /// of another region. Negative and NaN expected electrons count as zero. Without a duration it is that of the
  /// settings.
  void expose(const PhotonImage& image, std::int64_t exposure_number, std::vector<std::uint16_t>& dn,
              std::optional<double> duration_s = std::nullopt);

  [[nodiscard]] std::span<const HotPixel> hot_pixels() const { return hot_pixels_; }
  /// Returns the charge lost by blooming in the last exposure, electrons.
  [[nodiscard]] double drained_electrons() const { return drained_electrons_; }

 private:
  void draw_fixed_pattern(std::uint64_t seed, std::string_view camera_name);
  void add_hot_pixels();
  void collect(const PhotonImage& image, std::uint64_t exposure, float dark_share);
  void read_out(std::uint64_t exposure, std::vector<std::uint16_t>& dn) const;

  CameraSettings settings_;
  std::size_t pixels_;
  std::uint64_t noise_key_;
  std::vector<HotPixel> hot_pixels_;
  double drained_electrons_ = 0.0;
  // A value a pixel, filled up to whole chunks.
  std::vector<float> response_;        // relative to the mean pixel
  std::vector<float> dark_electrons_;  // expected, of an exposure as in the settings
  std::vector<float> charge_;
};

}  // namespace vbar::twins::camera
