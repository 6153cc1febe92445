#include <algorithm>
#include <memory>
#include <string>

#include "host_sim/mission/mission.h"
#include "host_sim/mission/read_sections.h"

namespace vbar::mission {

namespace {

fsw::Duration longest_compute_latency(const Mission& mission) {
  fsw::Duration longest;
  for (const Spacecraft& spacecraft : mission.spacecraft)
    if (spacecraft.flight_computer) longest = std::max(longest, spacecraft.flight_computer->compute_latency);
  return longest;
}

}  // namespace

// Periods of the control loop are the paper's (its table of control solvers). Where the paper gives none, the defaults
// are the initial values of the flight software (fsw/guidance/management.cpp).
void read_guidance(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("guidance");
  constexpr Range kPeriod_s = from_to(1e-3, 1e6);
  Guidance& guidance = mission.guidance;
  guidance.mode = section.choice<Mode>("mode", kModes, mission.flies() ? Mode::kApproach : Mode::kIdle);
  if (guidance.mode == Mode::kApproach && mission.waypoints.empty())
    section.refuse("mode", "approach without a waypoint", "at least one [[waypoint]], or another mode");
  // PRISMA's mean semi-major axis, the mean of the paper's osculating elements by first-order Brouwer theory.
  guidance.reference_semi_major_axis_m =
      1e3 * section.number("reference_semi_major_axis_km", from_to(6400.0, 1e6), 7078.138944);

  vbar::gnc_configuration& c = guidance.configuration;
  const fsw::Duration latency = longest_compute_latency(mission);
  c.compute_latency_ns = section.span("compute_latency_s", 1.0, from_to(0.0, 3600.0), fsw::seconds(latency)).ns;
  c.closed_form_period_ns = section.span("closed_form_period_s", 1.0, kPeriod_s, 300.0).ns;
  c.koenig_damico_period_ns = section.span("koenig_damico_period_s", 1.0, kPeriod_s, 60.0).ns;
  c.koenig_damico_grid_ns = section.span("koenig_damico_grid_s", 1.0, kPeriod_s, 30.0).ns;
  c.planner_start_ns = (mission.start_time() + section.span("planner_delay_s", 1.0, from_to(0.0, 1e6), 0.0)).ns;
  c.minimum_dv = 1e-3 * section.number("dv_min_mmps", from_to(0.0, 1e3), 1e-3);
  c.maximum_dv = section.number("dv_max_mps", above_to(0.0, 1e3), 10.0);
  c.roe_error_threshold_m = section.number("roe_error_threshold_m", from_to(0.0, 1e6), 0.0);
  c.keep_out_radius_m = section.number("keep_out_radius_m", from_to(0.0, 1e5), 0.0);
  c.safety_horizon_s = section.number("safety_horizon_s", from_to(0.0, 2e5), 6000.0);
  c.station_keeping_deadband_m = section.number("station_keeping_deadband_m", above_to(0.0, 1e5), 1.0);
  c.closed_form_tolerance_m = section.number("closed_form_tolerance_m", above_to(0.0, 1e5), 0.3);
  c.koenig_damico_tolerance_m = section.number("koenig_damico_tolerance_m", above_to(0.0, 1e5), 0.003);
  c.station_keeping_horizon_s = section.number("station_keeping_horizon_s", above_to(0.0, 1e6), 18000.0);
  c.navigation_timeout_s = section.number("navigation_timeout_s", above_to(0.0, 1e6), 600.0);
  section.finish();
  if (c.compute_latency_ns < latency.ns)
    section.refuse_value("compute_latency_s",
                         "at least the flight computer's compute_latency_s, or its burns come too late");
  if (c.maximum_dv <= c.minimum_dv) section.refuse_value("dv_max_mps", "more than dv_min_mmps");
}

namespace {

constexpr double kLargestARoe_m = 1e6;  // limit of the flight software

Waypoint read_waypoint(const TableReader& section, const Mission& mission) {
  Waypoint waypoint;
  waypoint.index = static_cast<int>(section.integer("index", 0, 9999));
  waypoint.time = mission.epoch + section.span("time_h", kHour_s, from_to(0.0, kLongestMission_h));
  // Of a state in RTN the elements follow when all spacecraft are known.
  if (!target_in_rtn(section)) {
    const auto a_roe_m = section.six_numbers("a_roe_m", from_to(-kLargestARoe_m, kLargestARoe_m));
    waypoint.a_roe_m = Eigen::Map<const fsw::Vector6>(a_roe_m.data());
  }
  waypoint.solver = section.choice<Solver>("solver", kSolvers, Waypoint{}.solver);
  if (section.has("keep_out_radius_m"))
    waypoint.keep_out_radius_m = section.number("keep_out_radius_m", from_to(0.0, 1e5));
  section.finish();
  return waypoint;
}

}  // namespace

void read_waypoints(const TableReader& document, Mission& mission) {
  std::vector<TableReader> sections = document.tables("waypoint");
  if (sections.size() > kMaxWaypoints)
    document.refuse("waypoint", std::to_string(sections.size()) + " waypoints",
                    "at most " + std::to_string(kMaxWaypoints));
  for (TableReader& section : sections) {
    const Waypoint waypoint = read_waypoint(section, mission);
    section.rename("waypoint." + std::to_string(waypoint.index));
    if (mission.find_waypoint(waypoint.index) != nullptr)
      section.refuse("index", "a second waypoint " + std::to_string(waypoint.index), "an index used once");
    if (!mission.waypoints.empty() && waypoint.time <= mission.waypoints.back().time) {
      const Waypoint& before = mission.waypoints.back();
      section.refuse_value(
          "time_h", "a time after that of waypoint " + std::to_string(before.index) + ", which stands before it");
    }
    mission.waypoints.push_back(waypoint);
  }
}

// Presence of the table selects retreat and safety monitor. Every key has a default, that of the paper's mission:
// Tango's sphere of 0.73 m and one of 1.3 m around Mango with its panels, errors of a retreat at 7 m, a hold orbit at
// 200 m.
void read_safety(const TableReader& document, Mission& mission) {
  if (!document.has("safety")) return;
  const TableReader section = document.table("safety");
  constexpr Range kDistance_m = above_to(0.0, 1e5);
  vbar::safety_configuration& c = mission.safety.emplace();
  c.contact_distance_m = section.number("contact_distance_m", kDistance_m, 2.0);
  c.horizon_s = 3600.0 * section.number("horizon_h", above_to(0.0, 50.0), 24.0);
  c.retreat_delay_s = section.number("retreat_delay_s", above_to(0.0, 1e5), 600.0);
  c.semi_major_axis_error_m = section.number("semi_major_axis_error_m", from_to(0.0, 1e3), 0.05);
  c.differential_drag = section.number("differential_drag_mps2", from_to(0.0, 1e-3), 1e-9);
  c.maximum_collision_probability = section.number("maximum_collision_probability", above_to(0.0, 1.0), 1e-4);
  c.recession_m = section.number("recession_m", kDistance_m, 1.0);
  c.hold_distance_m = section.number("hold_distance_m", kDistance_m, 200.0);
  c.hold_separation_m = section.number("hold_separation_m", kDistance_m, 6.0);
  c.data_timeout_s = section.number("data_timeout_s", above_to(0.0, 1e6), 2100.0);
  c.data_timeout_range_m = section.number("data_timeout_range_m", kDistance_m, 100.0);
  c.target_size_m = section.number("target_size_m", kDistance_m, 0.69);
  section.finish();
  if (c.hold_distance_m <= c.contact_distance_m)
    section.refuse_value("hold_distance_m", "more than contact_distance_m");
  if (c.hold_separation_m <= c.contact_distance_m)
    section.refuse_value("hold_separation_m", "more than contact_distance_m");
}

void read_burns(const TableReader& document, Mission& mission) {
  for (const TableReader& section : document.tables("burn")) {
    PrescribedBurn burn;
    burn.time = mission.epoch + section.span("time_h", kHour_s, from_to(0.0, kLongestMission_h));
    if (burn.time < mission.start_time() || burn.time > mission.end_time())
      section.refuse_value("time_h", "a time of the run");
    if (!mission.burns.empty() && burn.time <= mission.burns.back().time)
      section.refuse_value("time_h", "a time after the burn before");
    const auto dv_mmps = section.three_numbers("dv_rtn_mmps", from_to(-1e6, 1e6));
    burn.dv_rtn = 1e-3 * fsw::Vector3(dv_mmps[0], dv_mmps[1], dv_mmps[2]);
    section.finish();
    mission.burns.push_back(burn);
  }
}

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

// Process noise of two like spacecraft at 700 km.
constexpr double kPsdStart = 1e-14, kPsdMin = 1e-15, kPsdMax = 1e-11;
constexpr double kAccelerationSigma_nmps2 = 1.0, kAccelerationTime_s = 1500.0, kAngularPsd = 1e-11;

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

std::optional<SurfaceBounds> read_bounds(const TableReader& section, const char* key) {
  if (!section.has(key)) return std::nullopt;
  const std::vector<double> bounds = section.numbers(key, 2, 2, from_to(0.0, 100.0));
  if (bounds[0] > bounds[1]) section.refuse_value(key, "two numbers, the smaller one first");
  return SurfaceBounds{bounds[0], bounds[1]};
}

/// A key that none of the sources of navigation uses, although it differs from its default.
void note_without_effect(const TableReader& section, const Mission& mission, ProcessNoiseKeys& keys) {
  using Use = vbar::navigation_configuration;
  const Navigation& navigation = mission.navigation;
  const bool has_carrier = uses(mission, Use::kUseCarrierPair);
  const bool has_keypoints = uses(mission, Use::kUseKeypoints);
  const bool has_camera = has_keypoints || uses(mission, Use::kUseBearings);
  const vbar::navigation_configuration& c = navigation.configuration;
  const auto note = [&](const char* key, bool is_default, bool is_used, const char* of) {
    if (!section.has(key) || is_default || is_used) return;
    keys.without_effect.push_back(std::string("navigation.") + key +
                                  " has no effect in this mission: it is used with " + of);
  };
  note("acceleration_psd", c.acceleration_psd == kPsdStart, has_camera, "cameras");
  note("acceleration_psd_min", c.acceleration_psd_least == kPsdMin, has_camera, "cameras");
  note("acceleration_psd_max", c.acceleration_psd_most == kPsdMax, has_camera, "cameras");
  constexpr const char* kInstead = "carrier phase (with cameras: acceleration_psd, acceleration_psd_max)";
  note("acceleration_sigma_nmps2", c.acceleration_sigma == 1e-9 * kAccelerationSigma_nmps2, has_carrier, kInstead);
  note("acceleration_correlation_time_s", c.acceleration_time_s == kAccelerationTime_s, has_carrier, kInstead);
  note("angular_acceleration_psd", navigation.angular_acceleration_psd == kAngularPsd, has_keypoints, "keypoints");
}

}  // namespace

void read_navigation(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("navigation");
  vbar::navigation_configuration& navigation = mission.navigation.configuration;
  constexpr Range kPsd = above_to(0.0, 1e-3);
  navigation.acceleration_psd = section.number("acceleration_psd", kPsd, kPsdStart);
  navigation.acceleration_psd_least = section.number("acceleration_psd_min", kPsd, kPsdMin);
  navigation.acceleration_psd_most = section.number("acceleration_psd_max", kPsd, kPsdMax);
  navigation.acceleration_sigma =
      1e-9 * section.number("acceleration_sigma_nmps2", above_to(0.0, 1e6), kAccelerationSigma_nmps2);
  navigation.acceleration_time_s =
      section.number("acceleration_correlation_time_s", above_to(0.0, 1e6), kAccelerationTime_s);
  vbar::thruster_configuration& thruster = mission.navigation.thruster;
  thruster.sigma_mps = 1e-3 * section.number("maneuver_sigma_mmps", above_to(0.0, 1e3), 0.002);
  thruster.sigma_relative = 1e-2 * section.number("maneuver_sigma_percent", from_to(0.0, 100.0), 0.2);
  mission.navigation.angular_acceleration_psd = section.number("angular_acceleration_psd", kPsd, kAngularPsd);
  const auto keys = std::make_shared<ProcessNoiseKeys>();
  keys->are_stated = section.has("acceleration_psd") || section.has("acceleration_psd_max");
  keys->target_drag = read_bounds(section, "target_drag_m2_per_kg");
  keys->target_radiation = read_bounds(section, "target_radiation_m2_per_kg");
  note_without_effect(section, mission, *keys);
  mission.shared.push_back(keys);
  read_apriori(section, mission);
  section.finish();
  if (navigation.acceleration_psd < navigation.acceleration_psd_least ||
      navigation.acceleration_psd > navigation.acceleration_psd_most)
    section.refuse("acceleration_psd", "an initial value outside its limits",
                   "a number from acceleration_psd_min to acceleration_psd_max");
}

}  // namespace vbar::mission
