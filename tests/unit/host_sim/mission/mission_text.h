#pragma once
// The smallest mission that loads, and what goes wrong with changes of it.

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "host_sim/sensors/ideal_navigation_kind.h"

namespace vbar::mission::test {

inline constexpr std::string_view kSmallMission = R"(
[mission]
duration_h = 2.0
[[spacecraft]]
name = "servicer"
flight_computer = {}
sensors.navigation = {}
actuators.thruster = {}
[spacecraft.elements]
kind = "osculating"
semi_major_axis_km = 7087.3
ex = 0.0015
ey = 0.0
inclination_deg = 98.18
raan_deg = -90.0
mean_argument_of_latitude_deg = -0.69
[[spacecraft]]
name = "target"
body = "tango"
relative = { to = "servicer", waypoint = 0 }
[[waypoint]]
index = 0
time_h = 0.0
a_roe_m = [0, -1000, 0, 30, 0, 30]
[[waypoint]]
index = 1
time_h = 2.0
a_roe_m = [0, -600, 0, 18, 0, 18]
)";

using sensors::CameraSensor;
using sensors::CameraShared;
using sensors::GnssSensor;
using sensors::GnssShared;
using sensors::load_mission;
using sensors::NavigationSensor;
using sensors::parse_mission;

/// The text with the one occurrence of `what` replaced.
inline std::string changed(std::string text, std::string_view what, std::string_view by) {
  const std::size_t place = text.find(what);
  EXPECT_NE(place, std::string::npos) << what;
  EXPECT_EQ(text.find(what, place + 1), std::string::npos) << "ambiguous: " << what;
  if (place != std::string::npos) text.replace(place, what.size(), by);
  return text;
}

inline Mission small_mission(const std::vector<std::string>& overrides = {}) {
  return parse_mission(kSmallMission, "m.toml", overrides);
}

/// The message that loading ends with; empty if it succeeds.
inline std::string message_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    static_cast<void>(parse_mission(text, "m.toml", overrides));
  } catch (const MissionError& error) {
    return error.what();
  }
  return {};
}

/// The settings of the first sensor of a kind.
template <class Settings>
const Settings& sensor_of(const Mission& mission, std::string_view spacecraft = "servicer") {
  return *find_settings<Settings>(*mission.find_spacecraft(spacecraft));
}

/// A message as a packet: all of its bytes.
template <class Message>
std::vector<twins::Packet> packet_of(const Message& message) {
  sensors::Telecommands telecommands(fsw::GpsTime{}, 1);
  telecommands.add(message);
  return telecommands.packets();
}

/// Line, counted from 1, on which `what` stands in `text`.
inline std::string line_of_text(const std::string& text, std::string_view what) {
  int line = 1;
  for (std::size_t k = 0; k < text.find(what); ++k)
    if (text[k] == '\n') ++line;
  return std::to_string(line);
}

// Which keys a mission's tables accept, and what a mission file shows and says of them.

inline std::string text_of_file(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

inline std::vector<std::string> names_of(const std::vector<AcceptedKey>& keys) {
  std::vector<std::string> names;
  for (const AcceptedKey& key : keys) names.push_back(key.name);
  return names;
}

/// Each key that these tables accept stands in the text, with a value, as a table, or as an alternative in a comment.
inline void expect_all_shown(const std::string& text, const std::string& file, const std::vector<std::string>& tables) {
  const auto accepted = accepted_keys(file, {}, sensors::installation());
  for (const std::string& table : tables) {
    ASSERT_TRUE(accepted.contains(table)) << table;
    const std::vector<AcceptedKey>& keys = accepted.at(table);
    EXPECT_GE(keys.size(), 4U) << table;
    for (const std::string& key : names_of(keys)) {
      const bool is_shown =
          text.find("\n" + key + " = ") != std::string::npos || text.find("\n# " + key + " = ") != std::string::npos ||
          text.find("." + key + "]") != std::string::npos || text.find("\n[" + key + "]") != std::string::npos;
      EXPECT_TRUE(is_shown) << table << '.' << key;
    }
  }
}

}  // namespace vbar::mission::test
