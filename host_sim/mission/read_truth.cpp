#include <algorithm>
#include <filesystem>
#include <string>

#include "host_sim/mission/names.h"
#include "host_sim/mission/read_sections.h"

namespace vbar::mission {
namespace {

/// A data file: of the data folder, or, if it is absolute or begins with "./" or "../", relative to the mission file.
std::filesystem::path read_file(const TableReader& section, std::string_view key,
                                const std::filesystem::path& default_value, const Mission& mission) {
  const std::string text = section.text(key, default_value.string());
  if (text.empty()) section.refuse_value(key, "a file of the data folder, or one seen from the mission file (./...)");
  if (!text.starts_with("./") && !text.starts_with("../")) return text;
  return std::filesystem::absolute(mission.file).parent_path() / text;
}

/// A force that acts if its key is true; the default is the truth model of the paper.
truth::ForceModel read_forces(const TableReader& section) {
  truth::ForceModel forces;
  forces.drag = section.flag("drag", forces.drag);
  forces.geomagnetic_index =
      section.choice<truth::GeomagneticIndex>("geomagnetic_index", kGeomagneticIndices, forces.geomagnetic_index);
  forces.radiation_pressure = section.flag("radiation_pressure", forces.radiation_pressure);
  forces.shadow = section.choice<truth::Shadow>("shadow", kShadows, forces.shadow);
  forces.sun = section.flag("sun", forces.sun);
  forces.moon = section.flag("moon", forces.moon);
  forces.solid_tides = section.flag("solid_tides", forces.solid_tides);
  forces.relativity = section.flag("relativity", forces.relativity);
  return forces;
}

}  // namespace

void read_truth(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("truth");
  truth::TruthSettings& truth = mission.truth;
  truth.epoch = mission.epoch;
  truth.end = mission.end_time();
  // The degree of the gravity file is checked when it is read; 2190 is the degree of the largest ever published.
  truth.gravity_degree = static_cast<int>(section.integer("gravity_degree", 0, 2190, truth.gravity_degree));
  const int order = std::min(truth.gravity_order, truth.gravity_degree);
  truth.gravity_order = static_cast<int>(section.integer("gravity_order", 0, truth.gravity_degree, order));
  truth.forces = read_forces(section);
  truth.tolerance = section.number(
      "relative_tolerance", from_to(truth::TruthSettings::kSmallestTolerance, truth::TruthSettings::kLargestTolerance),
      truth.tolerance);
  truth.threads = static_cast<int>(section.integer("threads", 1, 256, truth.threads));
  truth.gravity_file = read_file(section, "gravity_file", truth.gravity_file, mission);
  truth.earth_orientation_file = read_file(section, "earth_orientation_file", truth.earth_orientation_file, mission);
  truth.space_weather_file = read_file(section, "space_weather_file", truth.space_weather_file, mission);
  section.finish();
}

}  // namespace vbar::mission
