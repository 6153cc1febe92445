#pragma once
// Blur of an image by a lens: two passes of a sampled Gaussian.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "host_sim/training/circumstances.h"
#include "host_sim/twins/camera/detector.h"
#include "host_sim/twins/camera/model/cad_objects.h"
#include "host_sim/twins/camera/model/target_renderer.h"
#include "host_sim/twins/camera/optics.h"
#include "host_sim/twins/camera/star_sky.h"

namespace vbar::training {

/// Blurs `picture` (rows of `width`) in place by a Gaussian with this standard deviation in pixels; light beyond the
/// edge is lost. A deviation below 0.05 px changes nothing.
void soften(double sigma_px, int width, int height, std::vector<float>& picture);

// Crops for training: rendered, illuminated, exposed and read as by the camera twin, cut by the flight software.
//
// The light of the target, the sky, the Earth and the detector are the twin's. Only the lens differs, for speed: light
// is gathered on whole pixels and softened there, the target on one and a half to three texels a sample of the crop.

/// A crop and its labels.
struct LabelledCrop {
  fsw::pose::CropSamples samples;  ///< not standardised
  Circumstances circumstances;
  std::vector<twins::camera::Material> materials;
  std::array<fsw::Vector2, fsw::pose::kKeypoints> pixels;  ///< places of the keypoints on the detector
  std::array<fsw::Vector2, fsw::pose::kKeypoints> cells;   ///< the same in cells of a map
  std::array<bool, fsw::pose::kKeypoints> counts;          ///< no more than half a cell outside the map
};

class CropMaker {
 public:
  /// Makes crops of a target of data/bodies. Throws std::runtime_error if a file of `data_directory` cannot be read.
  CropMaker(const std::filesystem::path& data_directory, const std::string& target, CropKind kind, std::uint64_t seed);

  /// Makes crop `index` of the seed, independent of the crops made before (on the same processor).
  void make(std::int64_t index, LabelledCrop& crop);

  [[nodiscard]] const twins::camera::CameraSettings& camera() const { return camera_; }
  [[nodiscard]] const TargetShape& shape() const { return shape_; }

 private:
  void label(LabelledCrop& crop) const;
  void place_window(const Circumstances& c);
  void draw_background(const Circumstances& c);
  void draw_earth(const Circumstances& c, const twins::camera::CameraSettings& camera);
  void draw_stars(const Circumstances& c, const twins::camera::CameraSettings& camera);
  void draw_target(const Circumstances& c, const twins::camera::CameraSettings& camera);
  void read_out(std::int64_t index);
  twins::camera::Detector& detector();

  CropKind kind_;
  std::uint64_t seed_;
  twins::camera::CameraSettings camera_;
  twins::camera::Optics optics_;
  TargetShape shape_;
  twins::camera::CadModel model_;
  twins::camera::TargetRenderer renderer_;
  twins::camera::Silhouette silhouette_;
  twins::camera::StarSky sky_;
  std::map<int, twins::camera::Detector> detectors_;  // by the side of their window

  // Work space: the square of the detector that is drawn.
  twins::camera::Region window_;
  twins::camera::PhotonImage photons_;
  std::vector<float> background_, target_, covered_, halo_;
  std::vector<twins::camera::LightSample> samples_;
  std::vector<twins::camera::ApparentStar> stars_;
  std::vector<std::uint16_t> dn_;
};

}  // namespace vbar::training
