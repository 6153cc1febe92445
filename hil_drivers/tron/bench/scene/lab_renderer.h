#pragma once
// Images of the emulated laboratory, in the radiometric units of the digital twin: OpenGL on the processor for the
// light, the twin's model of the detector for the numbers.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "hil_drivers/tron/bench/scene/lab_view.h"
#include "host_sim/twins/camera/photon_image.h"

namespace vbar::tron::bench {

class LabRenderer {
 public:
  /// Reads data_directory/models. Throws std::runtime_error if a model cannot be read or there is no OpenGL.
  LabRenderer(const BenchFile& bench, const GapSettings& gap, std::uint64_t seed,
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
