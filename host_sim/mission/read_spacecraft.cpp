#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "fsw/math/math.h"
#include "host_sim/mission/body_file.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/mission/mission.h"
#include "host_sim/mission/name_search.h"
#include "host_sim/mission/read_attitude.h"
#include "host_sim/mission/read_sections.h"
#include "host_sim/mission/spacecraft_number.h"

namespace vbar::mission {

namespace {

constexpr int kMaxSpacecraft = 10'000;
constexpr double kTurn_deg = 360.0;

}  // namespace

SpacecraftGroup::SpacecraftGroup(const TableReader& section)
    : name_(section.name("name")),
      counted_(section.has("count")),
      count_(static_cast<int>(section.integer("count", 1, kMaxSpacecraft, 1))),
      spacing_(section.table("spacing")) {
  spacing_.rename("spacecraft." + name_ + ".spacing");
  if (section.has("spacing") && !counted_) section.refuse("count", "nothing", "how many spacecraft the spacing is for");
  if (count_ > 1 && section.has("relative"))
    section.refuse("relative", "one place for " + std::to_string(count_) + " spacecraft", "elements, with a spacing");
}

std::string SpacecraftGroup::member_name(int member) const {
  if (!counted_) return name_;
  return fmt::format("{}_{:0{}}", name_, member + 1, std::to_string(count_).size());
}

double SpacecraftGroup::shift(int member, std::string_view key) const {
  constexpr double kLargest = 1e6;
  return member * spacing_.number(key, from_to(-kLargest, kLargest), 0.0);
}

double SpacecraftGroup::number(const TableReader& section, int member, std::string_view key, Range range,
                               std::optional<double> default_value) const {
  const double value = section.number(key, range, default_value) + shift(member, key);
  const bool good = (range.above ? value > range.low : value >= range.low) && value <= range.high;
  if (!good)
    spacing_.refuse(key, fmt::format("{:.10g} for {}", value, member_name(member)), "a number " + text_of(range));
  return value;
}

double SpacecraftGroup::angle_deg(const TableReader& section, int member, std::string_view key) const {
  const double value = section.number(key, from_to(-kTurn_deg, kTurn_deg)) + shift(member, key);
  return std::abs(value) <= kTurn_deg ? value : std::remainder(value, kTurn_deg);
}

namespace {

using fsw::math::kDegree;

// PRISMA's two spacecraft: Mango, the servicer, and Tango, the target (values from the literature, to known digits).
constexpr std::string_view kDefaultBody = "mango";
constexpr std::pair<std::string_view, SurfaceProperties> kKnownBodies[] = {{"mango", {154.0, 1.3, 2.5, 2.5, 1.32}},
                                                                           {"tango", {40.0, 0.38, 2.25, 0.55, 1.2}}};

/// One of the spacecraft of a section.
struct Member {
  const SpacecraftGroup& group;
  int index;

  double number(const TableReader& section, std::string_view key, Range range,
                std::optional<double> default_value = std::nullopt) const {
    return group.number(section, index, key, range, default_value);
  }
  double angle(const TableReader& section, std::string_view key) const {
    return kDegree * group.angle_deg(section, index, key);
  }
};

/// A body of data/bodies by its name, or the absolute path of a body file.
std::string read_body(const TableReader& section, const Mission& mission, const Installation& installation) {
  const std::string text = section.text("body", std::string(kDefaultBody));
  const bool is_name = !text.empty() && text.find('/') == std::string::npos;
  const std::string body = is_name ? text : data_file(section, "body", kDefaultBody, mission).string();
  const std::filesystem::path file = body_file_of(installation.data_directory, body);
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error)) return body;
  const std::vector<std::string> known = body_names(installation.data_directory);
  const std::vector<std::string_view> names(known.begin(), known.end());
  section.refuse("body", "no file " + file.string() + did_you_mean(body, names),
                 (names.empty() ? "a name of data/bodies" : listing_of(names)) +
                     ", or a body file seen from the mission file (./...)");
}

/// Keys that are missing have the values of the body; they are required for other bodies.
SurfaceProperties read_surface(const TableReader& section, const Member& member, std::string_view body) {
  const auto known = std::ranges::find(kKnownBodies, body, [](const auto& entry) { return entry.first; });
  const auto default_of = [&](double SurfaceProperties::*value) {
    return known == std::end(kKnownBodies) ? std::nullopt : std::optional(known->second.*value);
  };
  using S = SurfaceProperties;
  S surface;
  surface.mass_kg = member.number(section, "mass_kg", above_to(0.0, 1e6), default_of(&S::mass_kg));
  surface.drag_area_m2 = member.number(section, "drag_area_m2", from_to(0.0, 1e4), default_of(&S::drag_area_m2));
  surface.drag_coefficient =
      member.number(section, "drag_coefficient", from_to(0.0, 10.0), default_of(&S::drag_coefficient));
  surface.radiation_area_m2 =
      member.number(section, "radiation_area_m2", from_to(0.0, 1e4), default_of(&S::radiation_area_m2));
  surface.radiation_coefficient =
      member.number(section, "radiation_coefficient", from_to(0.0, 10.0), default_of(&S::radiation_coefficient));
  return surface;
}

OrbitByElements read_elements(const TableReader& section, const Member& member) {
  OrbitByElements orbit;
  orbit.kind = section.choice<ElementsKind>("kind", kElementsKinds);
  fsw::orbit::QnsElements& elements = orbit.elements;
  elements.a = 1e3 * member.number(section, "semi_major_axis_km", from_to(6400.0, 1e6));
  elements.ex = member.number(section, "ex", from_to(-0.9, 0.9));
  elements.ey = member.number(section, "ey", from_to(-0.9, 0.9));
  if (elements.ex * elements.ex + elements.ey * elements.ey >= 0.81)
    section.refuse("ey", "an eccentricity of 0.9 or more", "ex and ey with ex^2 + ey^2 below 0.81");
  // Quasi-nonsingular elements need a node.
  elements.i = kDegree * member.number(section, "inclination_deg", from_to(0.01, 179.99));
  elements.raan = member.angle(section, "raan_deg");
  elements.u = member.angle(section, "mean_argument_of_latitude_deg");
  return orbit;
}

using Orbit = decltype(Spacecraft::orbit);

Orbit read_relative(const TableReader& section, const Mission& mission) {
  const std::string to = section.name("to");
  // Only a preceding one, so that the orbits can be computed in order.
  if (mission.find_spacecraft(to) == nullptr)
    section.refuse_value("to", "the name of a spacecraft further up in the file");
  if (section.has("a_roe_m")) {
    if (section.has("waypoint")) section.refuse("a_roe_m", "both waypoint and a_roe_m", "one of them");
    const auto a_roe_m = section.six_numbers("a_roe_m", from_to(-1e6, 1e6));
    return OrbitByRoe{to, Eigen::Map<const fsw::Vector6>(a_roe_m.data())};
  }
  OrbitByWaypoint orbit{to, static_cast<int>(section.integer("waypoint", 0, 9999))};
  if (mission.find_waypoint(orbit.waypoint_index) == nullptr)
    section.refuse_value("waypoint", "the index of a waypoint");
  return orbit;
}

Orbit read_orbit(const TableReader& section, const Member& member, const Mission& mission) {
  const int given = int{section.has("elements")} + int{section.has("relative")} + int{section.has("orbit_file")};
  if (given != 1)
    section.refuse(
        "",
        given == 0 ? "none of elements, relative and orbit_file" : "more than one of elements, relative and orbit_file",
        "exactly one of them");
  if (section.has("elements")) return read_elements(section.table("elements"), member);
  if (section.has("orbit_file"))
    return OrbitByFile{data_file(section, "orbit_file", "", mission), section.text("orbit_object", "")};
  return read_relative(section.table("relative"), mission);
}

// Default of the budget of a step is the largest one of the missions of this repository (206 million instructions,
// docs/board_bringup.md) and a fifth; at 4 cycles an instruction and 667 MHz these are 1.5 s. The minimum is more than
// a board needs to start the flight software.
constexpr std::int64_t kStepBudgetInstructions = 270'000'000;
constexpr std::int64_t kStepBudgetCycles = 4 * kStepBudgetInstructions;
constexpr std::int64_t kMinStepBudget = 100'000;
constexpr std::int64_t kGreatestStepBudget = 10'000'000'000;

FlightComputer read_flight_computer(const TableReader& section) {
  FlightComputer computer;
  computer.target = section.choice<FlightTarget>("target", kFlightTargets, FlightTarget::kInProcess);
  computer.link = section.choice<FlightLink>("link", kFlightLinks, FlightLink::kSerial);
  computer.library = section.text("library", "");
  if (!computer.library.empty() && computer.target != FlightTarget::kInProcess)
    section.refuse_value("library", "nothing, unless target is in_process");
  computer.image = section.text("image", "");
  const bool starts_image = computer.target != FlightTarget::kInProcess && computer.target != FlightTarget::kBoard;
  if (!computer.image.empty() && !starts_image)
    section.refuse_value("image", "nothing, unless target is zynq_qemu, zynq_linux_qemu or host_process");
  computer.compute_latency = section.span("compute_latency_s", 1.0, from_to(0.0, 3600.0), 1.0);
  computer.device = section.text("device", "");
  if (section.has("baud")) computer.baud = static_cast<int>(section.integer("baud", 1200, 4000000));
  computer.address = section.text("address", "");
  computer.port = static_cast<int>(section.integer("port", 0, 65535, 0));
  const std::int64_t step_budget =
      computer.target == FlightTarget::kBoard ? kStepBudgetCycles : kStepBudgetInstructions;
  computer.step_budget = section.integer("step_budget", kMinStepBudget, kGreatestStepBudget, step_budget);
  computer.telecommand_key_file = section.text("telecommand_key_file", "");
  if (computer.target == FlightTarget::kBoard) {
    if (computer.link == FlightLink::kSerial && computer.device.empty())
      section.refuse("device", "nothing", "the tty of the board, e.g. /dev/ttyUSB0");
    if (computer.link == FlightLink::kUdp && computer.address.empty())
      section.refuse("address", "nothing", "the address of the board, e.g. 127.0.0.1");
    if (computer.link == FlightLink::kUdp && computer.port == 0)
      section.refuse("port", "nothing", "the UDP port of the board");
  }
  return computer;
}

constexpr std::array kFiniteKeys = {"specific_impulse_s", "propellant_kg", "minimum_impulse_mns",
                                    "maximum_on_time_s",  "rise_s",        "fall_s"};

/// Reads a thruster whose burns have a duration.
twins::ThrusterProperties read_finite_thruster(const TableReader& section, double mass_kg) {
  twins::ThrusterProperties finite;
  finite.thrust_n = section.number("thrust_n", above_to(0.0, 1e6), 0.0);
  for (const char* const required : {"specific_impulse_s", "propellant_kg"})
    if (!section.has(required)) section.refuse(required, "nothing", "a number: thrust_n is stated");
  finite.specific_impulse_s = section.number("specific_impulse_s", from_to(1.0, 1e5), 0.0);
  finite.propellant_kg = section.number("propellant_kg", above_to(0.0, 1e6), 0.0);
  if (!(finite.propellant_kg < mass_kg))
    section.refuse("propellant_kg", fmt::format("{} kg of a spacecraft of {} kg", finite.propellant_kg, mass_kg),
                   "less than mass_kg, which includes it");
  finite.minimum_impulse_ns = 1e-3 * section.number("minimum_impulse_mns", from_to(0.0, 1e9), 0.0);
  finite.maximum_on_time_s = section.number("maximum_on_time_s", above_to(0.0, 3600.0), 300.0);
  finite.rise_s = section.number("rise_s", from_to(0.0, 100.0), 0.0);
  finite.fall_s = section.number("fall_s", from_to(0.0, 100.0), 0.0);
  const double longest_ns = finite.thrust_n * finite.maximum_on_time_s;
  if (longest_ns < finite.minimum_impulse_ns)
    section.refuse("maximum_on_time_s", fmt::format("{} s, {} N s", finite.maximum_on_time_s, longest_ns),
                   "a time in which thrust_n gives minimum_impulse_mns");
  if (section.has("max_thrust_n")) section.refuse("max_thrust_n", "a second thrust", "thrust_n alone");
  return finite;
}

Thruster read_thruster(const TableReader& section, double mass_kg) {
  Thruster thruster;
  thruster.magnitude_error = 1e-2 * section.number("magnitude_error_percent", from_to(0.0, 20.0), 0.0);
  thruster.pointing_error_rad = kDegree * section.number("pointing_error_deg", from_to(0.0, 30.0), 0.0);
  thruster.max_thrust_n = section.number("max_thrust_n", from_to(0.0, 1e6), 0.0);
  if (section.has("thrust_n")) {
    thruster.finite = read_finite_thruster(section, mass_kg);
  } else {
    for (const char* const key : kFiniteKeys)
      if (section.has(key))
        section.refuse(key, "a key of burns with a duration", "it with thrust_n: burns are impulses");
  }
  return thruster;
}

/// Names of the spacecraft of all sections, and the place in the mission of the owner of each number.
struct Fleet {
  std::vector<std::string> names;
  std::unordered_set<std::string> known_names;
  std::array<std::optional<std::size_t>, kMaxSpacecraftNumber + 1> owner_of_number{};
};

/// The default is the place in the file, as far as packet headers can state it.
std::uint8_t read_number(const TableReader& section, const Member& member, const Mission& mission, Fleet& fleet) {
  const std::size_t place = mission.spacecraft.size() + 1;
  std::int64_t number = place <= kMaxSpacecraftNumber ? static_cast<std::int64_t>(place) : kNoSpacecraftNumber;
  if (section.has("number")) number = section.integer("number", 1, kMaxSpacecraftNumber) + member.index;
  if (number > kMaxSpacecraftNumber)
    section.refuse("number", std::to_string(number) + " for " + member.group.member_name(member.index),
                   "numbers up to " + std::to_string(kMaxSpacecraftNumber));
  if (number == kNoSpacecraftNumber) {
    if (section.has("flight_computer") || section.has("sensors"))
      section.refuse("number", fmt::format("nothing for spacecraft {} of the file, whose packets need a number", place),
                     fmt::format("a number from 1 to {} that is used once", kMaxSpacecraftNumber));
    return kNoSpacecraftNumber;
  }
  std::optional<std::size_t>& owner = fleet.owner_of_number[static_cast<std::size_t>(number)];
  if (owner)
    section.refuse("number", fmt::format("the number {} of {}", number, mission.spacecraft[*owner].name),
                   "a number used once");
  owner = mission.spacecraft.size();
  return static_cast<std::uint8_t>(number);
}

Spacecraft read_one(TableReader& section, const Member& member, Fleet& fleet, const Mission& mission,
                    const Installation& installation) {
  Spacecraft spacecraft;
  spacecraft.name = member.group.member_name(member.index);
  spacecraft.number = read_number(section, member, mission, fleet);
  spacecraft.body = read_body(section, mission, installation);
  spacecraft.surface = read_surface(section, member, spacecraft.body);
  spacecraft.mass_sigma_kg = section.number("mass_sigma_kg", from_to(0.0, 1e3), 0.0);
  if (section.has("model")) spacecraft.model = section.name("model");
  spacecraft.orbit = read_orbit(section, member, mission);
  const TableReader attitude = section.table("attitude");
  spacecraft.attitude = read_attitude(attitude, spacecraft.name, spacecraft.body, fleet.names);
  spacecraft.later_attitudes = read_later_attitudes(attitude, spacecraft.attitude);
  if (section.has("flight_computer"))
    spacecraft.flight_computer = read_flight_computer(section.table("flight_computer"));

  spacecraft.sensors = read_sensors(section.table("sensors"), {mission, installation, spacecraft.name, fleet.names});
  const TableReader actuators = section.table("actuators");
  if (actuators.has("thruster"))
    spacecraft.thruster = read_thruster(actuators.table("thruster"), spacecraft.surface.mass_kg);
  return spacecraft;
}

void read_section(TableReader& section, const SpacecraftGroup& group, Fleet& fleet, Mission& mission,
                  const Installation& installation) {
  for (int index = 0; index < group.count(); ++index)
    mission.spacecraft.push_back(read_one(section, {group, index}, fleet, mission, installation));
  section.finish();
}

void add_names(const TableReader& section, const SpacecraftGroup& group, Fleet& fleet) {
  if (const std::size_t total = fleet.names.size() + static_cast<std::size_t>(group.count()); total > kMaxSpacecraft)
    section.refuse("count", fmt::format("{} spacecraft up to here", total),
                   fmt::format("up to {} in a mission", kMaxSpacecraft));
  for (int index = 0; index < group.count(); ++index) {
    const std::string name = group.member_name(index);
    if (!fleet.known_names.insert(name).second)
      section.refuse("name", "a second spacecraft \"" + name + "\"", "a name used once");
    fleet.names.push_back(name);
  }
}

}  // namespace

void read_spacecraft(const TableReader& document, Mission& mission, const Installation& installation) {
  std::vector<TableReader> sections = document.tables("spacecraft");
  if (sections.empty()) document.refuse("spacecraft", "nothing", "at least one [[spacecraft]]");
  // All names, before anything else: a sensor may look at a spacecraft further down.
  std::vector<SpacecraftGroup> groups;
  Fleet fleet;
  for (TableReader& section : sections) {
    const SpacecraftGroup& group = groups.emplace_back(section);
    add_names(section, group, fleet);
    section.rename("spacecraft." + group.name());
  }
  for (std::size_t k = 0; k < sections.size(); ++k) read_section(sections[k], groups[k], fleet, mission, installation);
  auto spacecraft = mission.spacecraft.cbegin();
  for (std::size_t k = 0; k < sections.size(); ++k)
    for (int index = 0; index < groups[k].count(); ++index)
      check_sensors(sections[k].table("sensors"), *spacecraft++, mission, installation);
}

}  // namespace vbar::mission
