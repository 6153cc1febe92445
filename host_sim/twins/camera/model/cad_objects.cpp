#include "host_sim/twins/camera/model/cad_objects.h"

#include <map>
#include <memory>
#include <stdexcept>
#include <vector>

#include "host_sim/twins/camera/model/cad_model.h"
#include "host_sim/twins/camera/model/target_renderer.h"

namespace vbar::twins::camera {
namespace {

// A camera pixel is drawn by so many texels along a side.
constexpr double kTexelsAPixel = 2.0;

TargetView target_view(const ObjectView& view) {
  TargetView target;
  target.position_camera = view.position_camera;
  target.R_camera_body = view.R_camera_body;
  target.sun_camera = view.sun_direction_camera;
  target.sun_photons_per_m2_s = view.sun_photons_per_m2_s;
  target.nadir_camera = view.earth_direction_camera;
  target.earth_photons_per_m2_s = view.earth_photons_per_m2_s;
  target.texel_pitch = view.pixel_rad / kTexelsAPixel;
  return target;
}

}  // namespace

ObjectRenderer cad_objects(const std::filesystem::path& data_directory, const std::set<std::string>& models) {
  using Renderers = std::map<std::string, TargetRenderer>;
  const auto renderers = std::make_shared<Renderers>();
  for (const std::string& model : models)
    renderers->try_emplace(model, load_cad_model(data_directory / "models" / (model + ".obj")));
  // The work space is the closure's own: it is called by one thread at a time, as it says.
  const auto samples = std::make_shared<std::vector<LightSample>>();
  return [renderers, samples](const ObjectView& view, std::vector<LightSample>& out) {
    const auto found = renderers->find(view.model);
    if (found == renderers->end()) throw std::invalid_argument("no CAD model \"" + view.model + "\" was loaded");
    found->second.render(target_view(view), *samples);
    out.insert(out.end(), samples->begin(), samples->end());
  };
}

}  // namespace vbar::twins::camera
