#include "host_sim/twins/camera/model/cad_objects.h"

#include <map>
#include <memory>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "host_sim/twins/camera/model/target_renderer.h"

namespace vbar::twins::camera {
namespace {

struct Models {
  std::map<std::string, TargetRenderer, std::less<>> renderers;
  std::vector<LightSample> samples;  // work space
};

void render(Models& models, const ObjectView& view, std::vector<LightSample>& out) {
  const auto found = models.renderers.find(view.model);
  if (found == models.renderers.end())
    throw std::invalid_argument(fmt::format("no CAD model \"{}\" was loaded for the camera", view.model));
  TargetView target;
  target.position_camera = view.position_camera;
  target.R_camera_body = view.R_camera_body;
  target.sun_camera = view.sun_direction_camera;
  target.sun_photons_per_m2_s = view.sun_photons_per_m2_s;
  target.nadir_camera = view.earth_direction_camera;
  target.earth_photons_per_m2_s = view.earth_photons_per_m2_s;
  target.earth_half_angle = view.earth_half_angle;
  target.texel_pitch = 0.5 * view.pixel_rad;
  found->second.render(target, models.samples);
  out.insert(out.end(), models.samples.begin(), models.samples.end());
}

}  // namespace

ObjectRenderer cad_objects(const std::filesystem::path& data_directory, std::span<const std::string> models) {
  const auto loaded = std::make_shared<Models>();
  for (const std::string& model : models)
    if (!loaded->renderers.contains(model))
      loaded->renderers.try_emplace(model, load_cad_model(data_directory / "models" / (model + ".obj")));
  return [loaded](const ObjectView& view, std::vector<LightSample>& out) { render(*loaded, view, out); };
}

}  // namespace vbar::twins::camera
