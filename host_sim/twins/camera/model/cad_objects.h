#pragma once
// The fraction of each pixel that the target covers, for occultation of the background.

#include <map>
#include <span>
#include <string>
#include <vector>

#include "fsw/core/types.h"
#include "host_sim/twins/camera/model/cad_model.h"
#include "host_sim/twins/camera/object_view.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::twins::camera {

class Silhouette {
 public:
  explicit Silhouette(const CadModel& model);

  /// Draws covered fractions, 0 to 1 in quarters (2 x 2 points a pixel), rows of `region`. `origin_camera`: origin of
  /// the model, m; the whole model is in front of the camera.
  void draw(const Projection& optics, const fsw::Vector3& origin_camera, const fsw::Matrix3& R_camera_body,
            const Region& region, std::vector<float>& covered);

 private:
  void fill(const std::array<fsw::Vector2, 3>& corners);

  std::vector<fsw::Vector3> corners_body_;  // three a triangle
  std::vector<unsigned char> points_;       // work space, as all below
  int points_across_ = 0, points_down_ = 0;
};

// Spacecraft rendered from their CAD files, for the scene renderer.

/// Models by the names that views refer to.
using CadSources = std::map<std::string, CadSource>;

/// Loads the CAD file of every model; throws std::runtime_error as load_cad_model and TargetRenderer do. The returned
/// renderer throws std::invalid_argument for an unknown model, and for a camera inside the sphere around a body. Copies
/// of the renderer share the models; one call at a time among all copies.
ObjectRenderer cad_objects(const CadSources& models);

/// Loads the outlines of the models; throws as cad_objects().
ObjectCover cad_covers(const CadSources& models);

}  // namespace vbar::twins::camera
