#pragma once
// Images of the emulated laboratory, in the radiometric units of the digital twin: OpenGL on the processor for the
// light, the twin's model of the detector for the numbers.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "emulators/tron/scene/lab_view.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/photon_image.h"

namespace vbar::tron::bench {

// Blur of a whole image: the lens's point-spread function (Gaussian core and wide halo) and defocus.

inline constexpr double kFocusDistanceM = 3.5;

/// Returns the diameter of the circle of confusion on the detector, px, of a thin lens focused at kFocusDistanceM.
[[nodiscard]] double defocus_diameter_px(const twins::camera::CameraSettings& settings, double distance_m);

/// Holds a grid of floats, rows from the top.
struct Plane {
  int width = 0, height = 0;
  std::vector<float> values;
};

inline constexpr int kCoarseStep = 4;  ///< px a cell of a coarse plane

/// Computes fine = keep * fine + share * coarse, linear between the middles of the coarse plane's cells.
void mix_coarse(const Plane& coarse, float keep, float share, Plane& fine);

class LensBlur {
 public:
  /// Replaces `plane` by its blurred image; the plane beyond its edges counts as black. A uniform disc of the
  /// defocus's diameter has the variance d^2/16 along each axis, which is added to the core's.
  void blur(const twins::camera::OpticsSettings& optics, double defocus_px, Plane& plane);

 private:
  Plane across_, coarse_, coarse_half_;
};

/// Returns weights of a Gaussian at whole steps whose sum is 1 and whose variance is sigma^2, the middle one first.
[[nodiscard]] std::vector<float> gaussian_taps(double sigma);

class LabRenderer {
 public:
  /// Reads data_directory/models. Throws std::runtime_error if a model cannot be read or there is no OpenGL.
  LabRenderer(const TestbedDesign& bench, const GapSettings& gap, std::uint64_t seed,
              const std::filesystem::path& data_directory);
  ~LabRenderer();
  LabRenderer(const LabRenderer&) = delete;
  LabRenderer& operator=(const LabRenderer&) = delete;

  /// Returns expected photo-electrons of the region that is read; valid until the next call. Same bits for the same
  /// view on the same processor. From any thread, one call at a time. Throws std::invalid_argument, naming what is
  /// wrong, if a number is not finite or not possible, a pose is not a rigid one, or the camera is inside the sphere
  /// around the target.
  const twins::camera::PhotonImage& expected(const LabView& view);

  /// Returns the region as the detector reads it, rows from the top. Throws as expected().
  std::vector<std::uint16_t> expose(const LabView& view);

 private:
  struct Stage;
  std::unique_ptr<Stage> stage_;
};

}  // namespace vbar::tron::bench
