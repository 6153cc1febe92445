// SP3 as published: the precise orbit of Swarm A (ESA, TU Delft), from which data/orbits was made, and the positions of
// a satellite alone.

#include <array>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/orbit_files/orbit_file.h"
#include "tests/support/paths.h"

namespace vbar::orbit_files {
namespace {

using fsw::Vector3;
using testing::HasSubstr;

std::string text_of(const std::string& file) {
  std::ifstream stream(vbar::tests::source_path(file));
  EXPECT_TRUE(stream) << file;
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

const std::string& published() {
  static const std::string text = text_of("tests/data/formats/swarm_a_2022_excerpt.sp3");
  return text;
}

std::string error_of(std::string text, std::string_view what = "", std::string_view with = "") {
  if (!what.empty()) text.replace(text.find(what), what.size(), with);
  try {
    static_cast<void>(read_orbits(text, "orbit.sp3"));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(Sp3, HoldsTheBundledOrbit) {
  const OrbitFile file = tracks_of(read_orbits(published(), "swarm.sp3"), "L47");
  ASSERT_EQ(file.tracks.size(), 1U);
  const Track& track = file.tracks[0];
  EXPECT_EQ(track.frame, Frame::kItrf);
  ASSERT_EQ(track.states.size(), 30U);
  std::istringstream table(text_of("data/orbits/swarm_a_2022_001.csv"));
  std::size_t k = 0;
  for (std::string line; std::getline(table, line) && k < track.states.size();) {
    if (line.starts_with('#') || line.starts_with("gps")) continue;
    std::istringstream fields(line);
    std::array<double, 7> v{};
    for (double& value : v) {
      std::string field;
      std::getline(fields, field, ',');
      value = std::stod(field);
    }
    const TimedState& one = track.states[k++];
    EXPECT_EQ(one.time.ns, static_cast<std::int64_t>(v[0]) * 1'000'000'000);
    EXPECT_LT((one.state.position_eci - Vector3(v[1], v[2], v[3])).norm(), 1e-8);
    EXPECT_LT((one.state.velocity_eci - Vector3(v[4], v[5], v[6])).norm(), 1e-10);
  }
  EXPECT_EQ(k, track.states.size());
}

// Every second state left out and found again: from velocities, and from positions alone.
TEST(Sp3, InterpolationFindsTheStatesLeftOut) {
  OrbitFile file = tracks_of(read_orbits(published(), "swarm.sp3"), "");
  const Track all = file.tracks[0];
  Track& thin = file.tracks[0];
  thin.states.clear();
  for (std::size_t k = 0; k < all.states.size(); k += 2) thin.states.push_back(all.states[k]);
  thin.largest_step_s = 200.0;
  for (const bool has_velocities : {true, false}) {
    thin.has_velocities = has_velocities;
    const TimedState& expected = all.states[15];
    const FramedState found = state_at(file, expected.time);
    // 120 s apart: the differences of the real field from a smooth curve remain, some mm and cm.
    EXPECT_LT((found.state.position_eci - expected.state.position_eci).norm(), has_velocities ? 0.01 : 0.1);
    EXPECT_LT((found.state.velocity_eci - expected.state.velocity_eci).norm(), has_velocities ? 1e-4 : 1e-3);
  }
  thin.states.erase(thin.states.begin() + 7);
  EXPECT_THROW(static_cast<void>(state_at(file, all.states[15].time)), std::out_of_range);
}

TEST(Sp3, TimesThatReachTheNextMinuteOrHour) {
  const auto plain = read_orbits(published(), "swarm.sp3").tracks.at(0).states;
  for (const char* time : {"00 00 60.00000000", "00 00 60.0000    "}) {
    std::string text = published();
    const std::string_view minute = "*  2022 01 01 00 01 00.00000000";
    text.replace(text.find(minute), minute.size(), std::string("*  2022 01 01 ") + time);
    const auto carried = read_orbits(text, "swarm.sp3").tracks.at(0).states;
    ASSERT_EQ(carried.size(), plain.size());
    EXPECT_EQ(carried[1].time, plain[1].time);
  }
}

// A velocity of 0 is a missing one (Hilla 2016): the positions alone determine the orbit then, to centimetres.
TEST(Sp3, AMissingVelocityLeavesThePositions) {
  std::string text = published();
  const std::size_t at = text.find("VL47", text.find("*  2022 01 01 00 15"));
  text.replace(at + 4, 42, "      0.000000      0.000000      0.000000");
  const OrbitFile file = read_orbits(text, "swarm.sp3"), complete = read_orbits(published(), "swarm.sp3");
  EXPECT_FALSE(file.tracks.at(0).has_velocities);
  const TimedState& expected = complete.tracks.at(0).states.at(15);
  const FramedState found = state_at(file, expected.time);
  EXPECT_LT((found.state.position_eci - expected.state.position_eci).norm(), 1e-6);
  EXPECT_LT((found.state.velocity_eci - expected.state.velocity_eci).norm(), 1e-3);
  EXPECT_THAT(error_of(published(), "-17433.3412225", "-97433.3412225"), HasSubstr("0.01 to 12 km/s"));
}

TEST(Sp3, InvalidFilesAreRefusedWithALine) {
  EXPECT_EQ(error_of(published()), "");
  EXPECT_THAT(error_of(published(), "EOF", ""), HasSubstr("expected EOF in its last line"));
  EXPECT_THAT(error_of(published(), "%c M  cc GPS", "%c M  cc GLO"),
              HasSubstr("orbit.sp3:13: found the time system \"GLO\""));
  EXPECT_THAT(error_of(published(), "*  2022 01 01 00 02", "*  2022 01 01 00 01"),
              HasSubstr("epochs in ascending order"));
  EXPECT_THAT(error_of(published(), "VL47-17433", "VL48-17433"),
              HasSubstr("a velocity behind the satellite's position"));
  EXPECT_THAT(error_of(published(), "  6594.4386928", "  65X4.4386928"), HasSubstr("expected x in columns 5 to 18"));
  EXPECT_THAT(error_of(published(), " 00 02 00.00000000", " 00 02 0"), HasSubstr("the seconds in columns 21 to 31"));
}

}  // namespace
}  // namespace vbar::orbit_files
