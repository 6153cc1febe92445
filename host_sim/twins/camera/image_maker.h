#pragma once
// From an exposure to the packets of its image: renderer, detector, tiles. The sensor makes its images with it, and so
// does a replay from the recipes of a log.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host_sim/twins/camera/detector.h"
#include "host_sim/twins/camera/exposure.h"
#include "host_sim/twins/camera/photon_image.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::twins::camera {

/// Fills the image, whose region is set and whose pixels are zero, with expected photo-electrons: a pure function of
/// the exposure.
using Renderer = std::function<void(const Exposure&, PhotonImage&)>;

/// Wall-clock time spent, s.
struct ImagingTime {
  double render_s = 0.0;
  double detector_s = 0.0;
  double packing_s = 0.0;
  std::int64_t images = 0;
};

class ImageMaker {
 public:
  struct Settings {
    CameraSettings camera;
    std::string name;  ///< of the camera, e.g. "servicer/camera": names its random numbers
    std::uint64_t seed = 0;
    std::uint8_t spacecraft = 0;  ///< flight number of the spacecraft whose flight software gets the images
    std::uint8_t unit = 0;        ///< which of its cameras
  };

  /// `renderer` must not be empty.
  ImageMaker(const Settings& settings, Renderer renderer);

  /// The packets of the image: a pure function of the settings and the exposure, whatever was made before.
  std::vector<Packet> packets_of(const Exposure& exposure);

  [[nodiscard]] const Settings& settings() const { return settings_; }
  [[nodiscard]] const Detector& detector() const { return detector_; }
  [[nodiscard]] const ImagingTime& time_spent() const { return time_spent_; }

 private:
  Settings settings_;
  Renderer renderer_;
  Detector detector_;
  PhotonImage photons_;
  std::vector<std::uint16_t> dn_;
  ImagingTime time_spent_;
};

}  // namespace vbar::twins::camera
