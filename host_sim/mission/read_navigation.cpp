#include <algorithm>

#include "host_sim/mission/names.h"
#include "host_sim/mission/read_sections.h"

namespace vbar::mission {
namespace {

/// 1 sigma of mean ROE times the reference semi-major axis, m: of a, lambda, each component of e, each of i.
struct RoeSigmas {
  double a, lambda, e, i;
};
// The mission's choice: a relative state of two-line-element quality, 1 km along track and 200 m across.
constexpr RoeSigmas kTwoLineElements{30.0, 1000.0, 200.0, 200.0};
// What angles-only navigation has reached at 100 m.
constexpr RoeSigmas kAfterAnglesOnly{0.05, 0.5, 0.1, 0.1};

bool uses(const Mission& mission, std::int32_t use) {
  return std::ranges::any_of(mission.spacecraft, [&](const Spacecraft& spacecraft) {
    return std::ranges::any_of(spacecraft.sensors,
                               [&](const Sensor& sensor) { return (sensor.settings->navigation & use) != 0; });
  });
}

/// Bearings alone do not find an orbit; keypoints do.
void read_apriori(const TableReader& navigation, Mission& mission) {
  const bool has_bearings = uses(mission, vbar::navigation_configuration::kUseBearings);
  const bool has_table = navigation.has("apriori");
  const TableReader section = navigation.table("apriori");
  const Apriori of_sensors = has_bearings ? Apriori::kOrbit : has_table ? Apriori::kRoe : Apriori::kNone;
  mission.navigation.apriori = section.choice<Apriori>("kind", kAprioris, of_sensors);
  const RoeSigmas& usual = mission.navigation.apriori == Apriori::kRoe ? kAfterAnglesOnly : kTwoLineElements;
  const Range sigma_m = above_to(0.0, 1e5);
  const double a = section.number("sigma_a_da_m", sigma_m, usual.a);
  const double lambda = section.number("sigma_a_dlambda_m", sigma_m, usual.lambda);
  const double e = section.number("sigma_a_de_m", sigma_m, usual.e);
  const double i = section.number("sigma_a_di_m", sigma_m, usual.i);
  mission.navigation.apriori_sigma_a_roe_m << a, lambda, e, e, i, i;
  section.finish();
}

}  // namespace

void read_navigation(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("navigation");
  vbar::navigation_configuration& navigation = mission.navigation.configuration;
  constexpr Range kPsd = above_to(0.0, 1e-3);
  navigation.acceleration_psd = section.number("acceleration_psd", kPsd, 1e-14);
  navigation.acceleration_psd_least = section.number("acceleration_psd_min", kPsd, 1e-15);
  navigation.acceleration_psd_most = section.number("acceleration_psd_max", kPsd, 1e-11);
  navigation.acceleration_sigma = 1e-9 * section.number("acceleration_sigma_nmps2", above_to(0.0, 1e6), 1.0);
  navigation.acceleration_time_s = section.number("acceleration_correlation_time_s", above_to(0.0, 1e6), 1500.0);
  vbar::thruster_configuration& thruster = mission.navigation.thruster;
  thruster.sigma_mps = 1e-3 * section.number("maneuver_sigma_mmps", above_to(0.0, 1e3), 0.002);
  thruster.sigma_relative = 1e-2 * section.number("maneuver_sigma_percent", from_to(0.0, 100.0), 0.2);
  mission.navigation.angular_acceleration_psd = section.number("angular_acceleration_psd", kPsd, 1e-11);
  read_apriori(section, mission);
  section.finish();
  if (navigation.acceleration_psd < navigation.acceleration_psd_least ||
      navigation.acceleration_psd > navigation.acceleration_psd_most)
    section.refuse("acceleration_psd", "an initial value outside its limits",
                   "a number from acceleration_psd_min to acceleration_psd_max");
}

}  // namespace vbar::mission
