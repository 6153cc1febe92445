#include "host_sim/truth/force_list.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "host_sim/truth/forces/gravity_coefficients.h"
#include "host_sim/truth/forces/gravity_force.h"
#include "host_sim/truth/forces/radiation_pressure_force.h"
#include "host_sim/truth/forces/relativity_force.h"
#include "host_sim/truth/forces/solid_tides_force.h"
#include "host_sim/truth/forces/third_body_force.h"

namespace vbar::truth {
namespace {

/// The integrator's last step goes beyond the end by up to its length: a minute or two in a low orbit. A longer one, of
/// a high orbit, that overruns the data is refused when it happens.
constexpr std::int64_t kLongestStep_s = 3600;

fsw::GpsTime last_needed(const TruthSettings& settings) {
  return std::max(settings.epoch, settings.end) + fsw::duration_of_seconds(kLongestStep_s);
}

void load_gravity(const TruthSettings& settings, ForceData& data) {
  const std::filesystem::path file = settings.data_directory / settings.gravity_file;
  const auto coefficients = load_gravity_coefficients(file, settings.gravity_degree);
  data.gravity = std::make_shared<const GravityField>(coefficients, settings.gravity_degree, settings.gravity_order);
  if (!settings.forces.solid_tides) return;
  try {
    data.tide_system = tide_system_named(coefficients.tide_system);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(fmt::format("{}: {}", file.string(), error.what()));
  }
}

std::shared_ptr<const EarthOrientationSeries> load_earth_orientation(const TruthSettings& settings) {
  auto series = std::make_shared<const EarthOrientationSeries>(
      EarthOrientationSeries::load(settings.data_directory / settings.earth_orientation_file));
  static_cast<void>(series->at(settings.epoch));
  if (settings.end > settings.epoch) static_cast<void>(series->at(last_needed(settings)));
  return series;
}

/// A force on the surface is that of an area over a mass: without one of them there is none, which nobody asks for.
void require(const SpacecraftSettings& spacecraft, std::string_view force, std::string_view property, double value) {
  if (value > 0.0) return;
  throw std::invalid_argument(fmt::format("spacecraft \"{}\": {} needs {} above 0; it has {}", spacecraft.name, force,
                                          property, value));
}

}  // namespace

ForceData load_force_data(const TruthSettings& settings) {
  ForceData data;
  load_gravity(settings, data);
  data.earth_orientation = load_earth_orientation(settings);
  return data;
}

std::vector<std::unique_ptr<Force>> make_forces(const TruthSettings& settings, const ForceData& data,
                                                const SpacecraftSettings& spacecraft) {
  const ForceModel& model = settings.forces;
  const SurfaceProperties& surface = spacecraft.surface;
  std::vector<std::unique_ptr<Force>> forces;
  forces.push_back(std::make_unique<GravityForce>(data.gravity));
  if (model.radiation_pressure) {
    require(spacecraft, "radiation_pressure", "mass_kg", surface.mass_kg);
    require(spacecraft, "radiation_pressure", "radiation_area_m2", surface.radiation_area_m2);
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
