#include "host_sim/truth/force_list.h"

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "host_sim/truth/earth_data.h"
#include "host_sim/truth/forces/drag_force.h"
#include "host_sim/truth/forces/gravity_coefficients.h"
#include "host_sim/truth/forces/gravity_force.h"
#include "host_sim/truth/forces/radiation_pressure_force.h"
#include "host_sim/truth/forces/relativity_force.h"
#include "host_sim/truth/forces/solid_tides_force.h"
#include "host_sim/truth/forces/third_body_force.h"

namespace vbar::truth {
namespace {

constexpr const char* kAtmosphereFile = "atmosphere/nrlmsise00.csv";

/// Returns the note on a tide-free model without the force of the tides.
std::string note_on_permanent_tide(const std::string& model, bool is_added) {
  constexpr std::string_view kSize =
      "some 18 m along the track of a low orbit in a day: programs that use the file's C20 differ by that";
  if (is_added)
    return fmt::format(
        "The gravity model {} is tide-free: the permanent deformation of the Earth, {:.2e} of C20 (IERS Conventions "
        "2010, 6.2.2), is added, {}; truth.permanent_tide = false leaves it out.",
        model, permanent_tide_c20(), kSize);
  return fmt::format(
      "The gravity model {} is tide-free and used as published: the permanent deformation of the Earth, {:.2e} of C20 "
      "(IERS Conventions 2010, 6.2.2), acts on no spacecraft, an error of some 18 m along the track of a low orbit in "
      "a "
      "day.",
      model, permanent_tide_c20());
}

void load_gravity(const TruthSettings& settings, ForceData& data) {
  const std::filesystem::path file = settings.data_directory / settings.gravity_file;
  GravityCoefficients coefficients = load_gravity_coefficients(file, settings.gravity_degree);
  // Without the force of the tides nothing else adds the permanent deformation.
  if (!settings.forces.solid_tides && settings.gravity_degree >= 2 && coefficients.tide_system == "tide_free") {
    if (settings.permanent_tide) coefficients.c[GravityCoefficients::index(2, 0)] += permanent_tide_c20();
    data.notes.push_back(note_on_permanent_tide(coefficients.model, settings.permanent_tide));
  }
  data.gravity = std::make_shared<const GravityField>(coefficients, settings.gravity_degree, settings.gravity_order);
  if (!settings.forces.solid_tides) return;
  try {
    data.tide_system = tide_system_named(coefficients.tide_system);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(fmt::format("{}: {}", file.string(), error.what()));
  }
}

/// A force on the surface is proportional to area over mass: both are required, or the force would vanish silently.
void require(const SpacecraftSettings& spacecraft, std::string_view force, std::string_view property, double value) {
  if (value > 0.0) return;
  throw std::invalid_argument(
      fmt::format("spacecraft \"{}\": {} needs {} above 0; it has {}", spacecraft.name, force, property, value));
}

}  // namespace

void load_atmosphere(const TruthSettings& settings, ForceData& data) {
  if (data.atmosphere) return;
  data.atmosphere =
      std::make_shared<const Nrlmsise00Tables>(load_nrlmsise00_tables(settings.data_directory / kAtmosphereFile));
  load_space_weather(settings, data);
}

ForceData load_force_data(const TruthSettings& settings) {
  ForceData data;
  load_gravity(settings, data);
  load_earth_orientation(settings, data);
  if (settings.forces.drag) load_atmosphere(settings, data);
  return data;
}

std::vector<std::unique_ptr<Force>> make_forces(const TruthSettings& settings, const ForceData& data,
                                                const SpacecraftSettings& spacecraft) {
  const ForceModel& model = settings.forces;
  const SurfaceProperties& surface = spacecraft.surface;
  std::vector<std::unique_ptr<Force>> forces;
  forces.push_back(std::make_unique<GravityForce>(data.gravity));
  if (model.drag) {
    require(spacecraft, "drag", "mass_kg", surface.mass_kg);
    require(spacecraft, "drag", "drag_area_m2", surface.drag_area_m2);
    require(spacecraft, "drag", "drag_coefficient", surface.drag_coefficient);
    forces.push_back(std::make_unique<DragForce>(surface, data.atmosphere, data.space_weather, model.geomagnetic_index,
                                                 settings.epoch));
  }
  if (model.radiation_pressure) {
    require(spacecraft, "radiation_pressure", "mass_kg", surface.mass_kg);
    require(spacecraft, "radiation_pressure", "radiation_area_m2", surface.radiation_area_m2);
    require(spacecraft, "radiation_pressure", "radiation_coefficient", surface.radiation_coefficient);
    forces.push_back(std::make_unique<RadiationPressureForce>(surface, model.shadow));
  }
  if (model.sun) forces.push_back(std::make_unique<ThirdBodyForce>(ThirdBodyForce::Body::kSun));
  if (model.moon) forces.push_back(std::make_unique<ThirdBodyForce>(ThirdBodyForce::Body::kMoon));
  if (model.solid_tides) {
    forces.push_back(std::make_unique<SolidTidesForce>(data.gravity->gm(), data.gravity->radius(), data.tide_system,
                                                       settings.epoch, data.earth_orientation));
  }
  if (model.relativity) forces.push_back(std::make_unique<RelativityForce>(data.gravity->gm()));
  return forces;
}

}  // namespace vbar::truth
