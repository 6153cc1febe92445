#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "fsw/core/gps_time.h"
#include "host_sim/mission/body_file.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/truth/forces/radiation_pressure.h"
#include "host_sim/twins/camera/model/cad_model.h"
#include "host_sim/view/embedded_table.h"
#include "host_sim/view/view_page.h"

namespace vbar::view {

namespace {

using nlohmann::json;
using twins::camera::CadModel;

template <class Number>
std::string bytes_of(const std::vector<Number>& numbers) {
  std::string bytes(numbers.size() * sizeof(Number), '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

json triple(const fsw::Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

json materials_of(const CadModel& model) {
  json materials = json::array();
  for (const twins::camera::Material& material : model.materials)
    materials.push_back({{"name", material.name},
                         {"diffuse", material.diffuse},
                         {"specular", material.specular},
                         {"exponent", material.exponent}});
  return materials;
}

/// Corners as float32 in metres, normals in 127ths, a byte each, and a material a triangle: exact enough to be looked
/// at.
json shape_of(const CadModel& model) {
  std::vector<float> corners;
  std::vector<std::int8_t> normals;
  std::vector<std::uint8_t> materials;
  for (const twins::camera::Triangle& triangle : model.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        corners.push_back(static_cast<float>(triangle.corners[k][axis]));
        normals.push_back(static_cast<std::int8_t>(std::lround(127.0 * triangle.normals[k][axis])));
      }
    }
    materials.push_back(static_cast<std::uint8_t>(triangle.material));
  }
  return {{"triangles", model.triangles.size()},     {"radius_m", model.radius_m},
          {"corners", packed(bytes_of(corners))},    {"normals", packed(bytes_of(normals))},
          {"material", packed(bytes_of(materials))}, {"materials", materials_of(model)}};
}

json camera_of(const mission::Sensor& sensor, const sensors::CameraSensor& camera) {
  const auto& detector = camera.settings.detector;
  const double focal_px = camera.settings.focal_length_px();
  const Eigen::Quaterniond& q = camera.q_camera_body;
  return {{"name", sensor.name},
          {"q_camera_body", {q.w(), q.x(), q.y(), q.z()}},
          {"position_body_m", triple(camera.position_body_m)},
          {"focal_length_px", focal_px},
          {"principal_point_px", camera.settings.optics.principal_point_px},
          {"tan_half_width", 0.5 * detector.width / focal_px},
          {"tan_half_height", 0.5 * detector.height / focal_px}};
}

/// From the origin of the body frame, where the file of the body states it.
fsw::Vector3 centre_of_mass_of(const mission::Spacecraft& craft, const std::filesystem::path& data_directory) {
  if (craft.body.empty()) return fsw::Vector3::Zero();
  return mission::load_body(mission::body_file_of(data_directory, craft.body)).centre_of_mass_m;
}

const mission::Spacecraft* servicer_of(const mission::Mission& mission) {
  const auto found = std::ranges::find_if(
      mission.spacecraft, [](const mission::Spacecraft& craft) { return craft.flight_computer.has_value(); });
  return found != mission.spacecraft.end() ? &*found : nullptr;
}

}  // namespace

json scene_of(const mission::Mission& mission, const report::RunRecord& record,
              const std::filesystem::path& data_directory) {
  json scene{{"epoch_utc", truth::format_utc(mission.epoch)}, {"notes", json::array()}};
  json& shapes = scene["shapes"] = json::object();
  json& bodies = scene["bodies"] = json::object();
  const auto add_body = [&](const char* role, const mission::Spacecraft* craft) {
    if (craft == nullptr) return;
    json& body = bodies[role] = {{"name", craft->name}, {"model", ""}, {"cameras", json::array()}};
    for (const mission::Sensor& sensor : craft->sensors)
      if (const auto* const camera = dynamic_cast<const sensors::CameraSensor*>(sensor.settings.get()))
        body["cameras"].push_back(camera_of(sensor, *camera));
    if (craft->model.empty()) return;
    try {
      body["centre_of_mass_m"] = triple(centre_of_mass_of(*craft, data_directory));
      if (!shapes.contains(craft->model))
        shapes[craft->model] =
            shape_of(twins::camera::load_cad_model(mission::cad_source_of(data_directory, craft->model)));
      body["model"] = craft->model;
    } catch (const std::runtime_error& error) {
      scene["notes"].push_back(error.what());
    }
  };
  add_body("servicer", servicer_of(mission));
  add_body("target", mission.find_spacecraft(record.summary.target));

  const double keep_out_m = mission.guidance.configuration.keep_out_radius_m;
  scene["keep_out_m"] = keep_out_m;
  json& waypoints = scene["waypoints"] = json::array();
  for (const mission::Waypoint& waypoint : mission.waypoints)
    waypoints.push_back({{"index", waypoint.index},
                         {"time_s", fsw::seconds(waypoint.time - mission.epoch)},
                         {"keep_out_m", waypoint.keep_out_radius_m.value_or(keep_out_m)}});
  return scene;
}

namespace {

double sunlit_fraction(const fsw::Vector3& position, const fsw::Vector3& sun) {
  const truth::SkyDisks disks = truth::sky_disks(position, sun, {});
  if (truth::penumbra_outer_edge(disks) >= 0.0) return 1.0;
  return truth::penumbra_inner_edge(disks) > 0.0 ? truth::penumbra_sunlit_fraction(disks)
                                                 : truth::inner_sunlit_fraction(disks);
}

}  // namespace

CellTable sunlight_of(const mission::Mission& mission, const report::RunRecord& record) {
  constexpr std::size_t kMaxInstants = 4000;
  CellTable table{"",
                  {{"time_s", "s, since the epoch of the mission", {}},
                   {"sun_eci_x", "unit vector from the Earth to the Sun", {}},
                   {"sun_eci_y", "unit vector from the Earth to the Sun", {}},
                   {"sun_eci_z", "unit vector from the Earth to the Sun", {}},
                   {"servicer_sunlit", "fraction of the Sun's disk that the servicer sees", {}}},
                  "sunlight"};
  truth::SunMoonInterpolator ephemeris;
  const std::size_t stride = 1 + record.truth.size() / kMaxInstants;
  for (std::size_t k = 0; k < record.truth.size(); k += stride) {
    const report::TruthRow& row = record.truth[k];
    const fsw::Vector3 sun = ephemeris.at(truth::tt_of(mission.epoch, row.time_s)).sun_eci;
    const fsw::Vector3 position(row.servicer_position_eci.data());
    const fsw::Vector3 direction = sun.normalized();
    const std::array values{direction.x(), direction.y(), direction.z(), sunlit_fraction(position, sun)};
    table.columns[0].cells.push_back(fmt::format("{}", row.time_s));
    for (std::size_t value = 0; value < values.size(); ++value)
      table.columns[value + 1].cells.push_back(fmt::format("{:.6g}", values[value]));
  }
  return table;
}

}  // namespace vbar::view
