#pragma once
// From a frame of the testbed to the image that a camera in orbit would deliver, and what its light says of the lamps.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hil_drivers/tron/image/background.h"
#include "hil_drivers/tron/image/light_level.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::tron {

struct FinishedImage {
  std::vector<std::uint16_t> dn;
  std::optional<double> light_level;  ///< light of the target, relative to the prediction; none if it is unlit
  /// What is left without the light predicted of the Earth, relative to the prediction of sunlight by the diffuse part
  /// of the surfaces: a glint depends on the gloss of the mock-up, a face that is not black does not. None where that
  /// prediction is faint.
  std::optional<double> sunlight_level;
};

class ImageFinish {
 public:
  /// Takes `camera` as calibrated, binned by two as the image. `dark`: a frame of single pixels without light. `key`:
  /// key of the noise.
  ImageFinish(const twins::camera::CameraSettings& camera, const twins::camera::CadModel& model,
              const std::vector<std::uint16_t>& dark, std::uint64_t key);

  /// Finishes `frame` of single pixels. `T_C_B`: body at full scale as measured.
  [[nodiscard]] FinishedImage finish(const std::vector<std::uint16_t>& frame, std::int64_t image,
                                     const Eigen::Isometry3d& T_C_B, const std::optional<TargetLight>& light);

  [[nodiscard]] const DarkLevel& dark() const { return dark_; }

 private:
  [[nodiscard]] std::vector<std::uint16_t> binned(const std::vector<std::uint16_t>& frame) const;

  twins::camera::CameraSettings camera_;
  twins::camera::Optics lens_;
  twins::camera::Silhouette silhouette_;
  ExpectedLight expected_, expected_diffuse_;
  DarkLevel dark_;
  std::uint64_t key_;
};

}  // namespace vbar::tron
