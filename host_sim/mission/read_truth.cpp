#include <algorithm>
#include <array>
#include <string_view>

#include "host_sim/mission/data_file.h"
#include "host_sim/mission/names.h"
#include "host_sim/mission/read_sections.h"

namespace vbar::mission {
namespace {

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

/// The truth model, or a testbed of the mission that supplies the truth.
std::string read_truth_source(const TableReader& section, const TableReader& document,
                              const Installation& installation) {
  std::vector<std::string_view> accepted{kTruthModel};
  for (const TestbedReader* const testbed : installation.testbeds)
    if (testbed->supplies_truth) accepted.push_back(testbed->name);
  const std::string source = section.choice("source", accepted, kTruthModel);
  if (source != kTruthModel && !document.table("testbed").has(source))
    section.refuse_value("source", "model, as the mission has no [testbed." + source + "]");
  return source;
}

}  // namespace

void read_truth(const TableReader& document, Mission& mission, const Installation& installation) {
  const TableReader section = document.table("truth");
  mission.truth_source = read_truth_source(section, document, installation);
  truth::TruthSettings& truth = mission.truth;
  truth.epoch = mission.epoch;
  truth.end = mission.end_time();
  // The degree of the gravity file is checked when it is read; 2190 is the degree of the largest ever published.
  truth.gravity_degree = static_cast<int>(section.integer("gravity_degree", 0, 2190, truth.gravity_degree));
  const int order = std::min(truth.gravity_order, truth.gravity_degree);
  truth.gravity_order = static_cast<int>(section.integer("gravity_order", 0, truth.gravity_degree, order));
  truth.forces = read_forces(section);
  truth.permanent_tide = section.flag("permanent_tide", truth.permanent_tide);
  if (truth.forces.solid_tides && !truth.permanent_tide)
    section.refuse_value("permanent_tide", "true, as truth.solid_tides contains the permanent tide");
  truth.tolerance = section.number(
      "relative_tolerance", from_to(truth::TruthSettings::kSmallestTolerance, truth::TruthSettings::kLargestTolerance),
      truth.tolerance);
  truth.threads = static_cast<int>(section.integer("threads", 1, 256, truth.threads));
  using Settings = truth::TruthSettings;
  constexpr std::array<std::string_view, 2> kOrientationWords{Settings::kBundled, Settings::kNone};
  constexpr std::array<std::string_view, 2> kWeatherWords{Settings::kBundled, Settings::kConstant};
  truth.gravity_file = data_file(section, "gravity_file", truth.gravity_file, mission);
  truth.earth_orientation_file =
      data_file(section, "earth_orientation_file", truth.earth_orientation_file, mission, kOrientationWords);
  truth.space_weather_file = data_file(section, "space_weather_file", truth.space_weather_file, mission, kWeatherWords);
  truth.constant_f107 = section.number("constant_f107", from_to(50.0, 400.0), truth.constant_f107);
  truth.constant_ap = section.number("constant_ap", from_to(0.0, 400.0), truth.constant_ap);
  truth.accept_predictions = section.flag("accept_predictions", truth.accept_predictions);
  section.finish();
}

}  // namespace vbar::mission
