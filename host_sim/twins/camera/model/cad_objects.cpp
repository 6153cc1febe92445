#include "host_sim/twins/camera/model/cad_objects.h"

#include <map>
#include <memory>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "host_sim/twins/camera/model/silhouette.h"
#include "host_sim/twins/camera/model/target_renderer.h"

namespace vbar::twins::camera {
namespace {

struct Models {
  std::map<std::string, TargetRenderer, std::less<>> renderers;
  std::vector<LightSample> samples;  // work space
};

template <class Map>
auto loaded_model(Map& models, const std::string& name) {
  const auto found = models.find(name);
  if (found == models.end())
    throw std::invalid_argument(fmt::format("no CAD model \"{}\" was loaded for the camera", name));
  return found;
}

void render(Models& models, const ObjectView& view, std::vector<LightSample>& out) {
  const auto found = loaded_model(models.renderers, view.model);
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

ObjectRenderer cad_objects(const CadSources& models) {
  const auto loaded = std::make_shared<Models>();
  for (const auto& [name, source] : models) loaded->renderers.try_emplace(name, load_cad_model(source));
  return [loaded](const ObjectView& view, std::vector<LightSample>& out) { render(*loaded, view, out); };
}

ObjectCover cad_covers(const CadSources& models) {
  using Silhouettes = std::map<std::string, Silhouette, std::less<>>;
  const auto loaded = std::make_shared<Silhouettes>();
  for (const auto& [name, source] : models) loaded->try_emplace(name, load_cad_model(source));
  return [loaded](const ObjectView& view, const Projection& optics, const Region& region, std::vector<float>& covered) {
    loaded_model(*loaded, view.model)->second.draw(optics, view.position_camera, view.R_camera_body, region, covered);
  };
}

}  // namespace vbar::twins::camera
