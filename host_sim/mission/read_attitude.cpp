#include "host_sim/mission/read_attitude.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "fsw/math/math.h"
#include "host_sim/truth/attitude/rigid_body.h"

namespace vbar::mission {
namespace {

using fsw::Vector3;
using fsw::math::kDegree;
using truth::Direction;
using truth::TorqueKind;

template <class Enum, std::size_t N>
using Names = std::array<std::pair<std::string_view, Enum>, N>;

enum class Profile { kNone, kTumble, kInertial, kZenith, kNadir, kAlongTrack, kTarget, kCommanded };
constexpr Names<Profile, 8> kProfiles{{{"none", Profile::kNone},
                                       {"tumble", Profile::kTumble},
                                       {"inertial", Profile::kInertial},
                                       {"zenith", Profile::kZenith},
                                       {"nadir", Profile::kNadir},
                                       {"along_track", Profile::kAlongTrack},
                                       {"target", Profile::kTarget},
                                       {"commanded", Profile::kCommanded}}};
// Those that follow another profile: functions of the spacecraft's own orbit alone.
constexpr Names<Profile, 4> kLaterProfiles{{{"inertial", Profile::kInertial},
                                            {"zenith", Profile::kZenith},
                                            {"nadir", Profile::kNadir},
                                            {"along_track", Profile::kAlongTrack}}};
constexpr Names<Direction, 5> kSecondDirections{{{"orbit_normal", Direction::kOrbitNormal},
                                                 {"along_track", Direction::kAlongTrack},
                                                 {"zenith", Direction::kZenith},
                                                 {"nadir", Direction::kNadir},
                                                 {"sun", Direction::kSun}}};
constexpr Names<TorqueKind, 3> kTorques{{{"gravity_gradient", TorqueKind::kGravityGradient},
                                         {"aerodynamic", TorqueKind::kAerodynamic},
                                         {"radiation", TorqueKind::kRadiation}}};

// Largest rate is ten revolutions per second: integrating hours of such a motion takes minutes.
constexpr double kFastest_degps = 3600.0;
// The tumble rates of the experiments with a non-cooperative target.
constexpr double kDefaultRateMin_degps = 0.3;
constexpr double kDefaultRateMax_degps = 1.5;

Vector3 vector(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

void read_rate(const TableReader& section, Tumble& tumble) {
  if (section.has("rate_degps") && section.has("tumble_rate_degps"))
    section.refuse("rate_degps", "both rate_degps and tumble_rate_degps", "at most one of them");
  if (section.has("rate_degps")) {
    tumble.rate_body = kDegree * vector(section.three_numbers("rate_degps", from_to(-kFastest_degps, kFastest_degps)));
    return;
  }
  std::vector<double> range{kDefaultRateMin_degps, kDefaultRateMax_degps};
  if (section.has("tumble_rate_degps"))
    range = section.numbers("tumble_rate_degps", 2, 2, from_to(0.0, kFastest_degps));
  if (range[1] < range[0])
    section.refuse("tumble_rate_degps", "a range that ends below its start", "[slowest, fastest]");
  tumble.slowest_radps = kDegree * range[0];
  tumble.fastest_radps = kDegree * range[1];
}

Tumble read_tumble(const TableReader& section, const std::string& body) {
  Tumble tumble;
  tumble.q_body_eci = read_quaternion(section, "q_body_eci");
  read_rate(section, tumble);
  tumble.body = body;
  tumble.inertia_kgm2 = read_inertia(section);
  tumble.torques = section.choices<TorqueKind>("torques", kTorques);
  return tumble;
}

Direction boresight_of(Profile profile) {
  switch (profile) {
    case Profile::kNadir:
      return Direction::kNadir;
    case Profile::kAlongTrack:
      return Direction::kAlongTrack;
    case Profile::kTarget:
      return Direction::kSpacecraft;
    default:
      return Direction::kZenith;
  }
}

truth::PointingSettings read_pointing(const TableReader& section, Profile profile) {
  truth::PointingSettings pointing;
  const Range component = from_to(-1.0, 1.0);
  pointing.boresight_to = boresight_of(profile);
  pointing.boresight_body = vector(section.three_numbers("boresight_body", component, {{0.0, 0.0, 1.0}}));
  pointing.second_body = vector(section.three_numbers("secondary_axis_body", component, {{0.0, 1.0, 0.0}}));
  pointing.second_to = section.choice<Direction>("secondary_direction", kSecondDirections, Direction::kOrbitNormal);
  if (!truth::are_two_axes(pointing.boresight_body, pointing.second_body))
    section.refuse(section.has("boresight_body") ? "boresight_body" : "secondary_axis_body",
                   "an axis along the other one", "boresight_body and secondary_axis_body in two different directions");
  if (truth::are_one_line(pointing.boresight_to, pointing.second_to))
    section.refuse("secondary_direction", "the line that the boresight follows", "another direction");
  return pointing;
}

truth::PointedSettings read_pointed(const TableReader& section, Profile profile, const std::string& own,
                                    const std::vector<std::string>& names) {
  truth::PointedSettings pointed;
  if (profile == Profile::kTarget) pointed.spacecraft = read_other_spacecraft(section, own, names);
  pointed.pointing = read_pointing(section, profile);
  return pointed;
}

constexpr double kArcsecond = kDegree / 3600.0;

Commanded read_commanded(const TableReader& section) {
  Commanded commanded;
  commanded.control_error = kArcsecond * section.number("control_error_arcsec", from_to(0.0, 36000.0), 30.0);
  const Range component = from_to(-1.0, 1.0);
  truth::CommandedAxes& axes = commanded.axes;
  axes.initial_boresight_rtn = vector(section.three_numbers("initial_boresight_rtn", component, {{0.0, -1.0, 0.0}}));
  axes.boresight_body = vector(section.three_numbers("boresight_body", component, {{0.0, 0.0, 1.0}}));
  axes.second_body = vector(section.three_numbers("secondary_axis_body", component, {{0.0, -1.0, 0.0}}));
  if (!truth::are_two_axes(axes.boresight_body, axes.second_body))
    section.refuse(section.has("boresight_body") ? "boresight_body" : "secondary_axis_body",
                   "an axis along the other one", "boresight_body and secondary_axis_body in two different directions");
  if (!truth::leaves_zenith_clear(axes.initial_boresight_rtn, Vector3::Zero()))
    section.refuse("initial_boresight_rtn", "a zero boresight, or one at the zenith or the nadir",
                   "a direction [R, T, N] that leaves the second axis a zenith to keep near to");
  return commanded;
}

}  // namespace

std::optional<fsw::Matrix3> read_inertia(const TableReader& section) {
  if (!section.has("inertia_kgm2")) return std::nullopt;
  const std::vector<double> j = section.numbers("inertia_kgm2", 3, 6, from_to(-1e9, 1e9));
  if (j.size() != 3 && j.size() != 6) section.refuse_value("inertia_kgm2", "[xx, yy, zz] or [xx, yy, zz, xy, xz, yz]");
  fsw::Matrix3 inertia = Vector3(j[0], j[1], j[2]).asDiagonal();
  if (j.size() == 6) {
    inertia(0, 1) = inertia(1, 0) = j[3];
    inertia(0, 2) = inertia(2, 0) = j[4];
    inertia(1, 2) = inertia(2, 1) = j[5];
  }
  try {
    truth::check_inertia(inertia);
  } catch (const std::invalid_argument& error) {
    section.refuse("inertia_kgm2", std::string("an invalid inertia: ") + error.what(),
                   "principal moments above 0, none above the sum of the other two");
  }
  return inertia;
}

std::optional<Eigen::Quaterniond> read_quaternion(const TableReader& section, std::string_view key) {
  if (!section.has(key)) return std::nullopt;
  const std::vector<double> q = section.numbers(key, 4, 4, from_to(-1.0, 1.0));
  const Eigen::Quaterniond quaternion(q[0], q[1], q[2], q[3]);
  if (std::abs(quaternion.norm() - 1.0) > 1e-3)
    section.refuse(key, "a quaternion whose length is not 1", "[w, x, y, z] of length 1, to 0.001");
  return quaternion.normalized();
}

std::string read_other_spacecraft(const TableReader& section, const std::string& own,
                                  const std::vector<std::string>& names) {
  const std::string target = section.name("target", "target");
  std::vector<std::string_view> others;
  for (const std::string& name : names)
    if (name != own) others.push_back(name);
  if (std::find(others.begin(), others.end(), target) == others.end())
    section.refuse("target", "the spacecraft \"" + target + "\"",
                   others.empty() ? "a mission with another spacecraft" : listing_of(others));
  return target;
}

std::optional<Attitude> read_attitude(const TableReader& section, const std::string& own, const std::string& body,
                                      const std::vector<std::string>& names) {
  const auto profile = section.choice<Profile>("profile", kProfiles, Profile::kNone);
  switch (profile) {
    case Profile::kNone:
      return std::nullopt;
    case Profile::kTumble:
      return read_tumble(section, body);
    case Profile::kInertial:
      return Inertial{read_quaternion(section, "q_body_eci")};
    case Profile::kCommanded:
      return read_commanded(section);
    default:
      return read_pointed(section, profile, own, names);
  }
}

std::vector<LaterAttitude> read_later_attitudes(const TableReader& section, const std::optional<Attitude>& first) {
  constexpr double kHour_s = 3600.0;
  std::vector<LaterAttitude> later;
  if (!first || std::holds_alternative<Commanded>(*first)) return later;
  for (const TableReader& table : section.tables("then")) {
    LaterAttitude one;
    one.from_s = kHour_s * table.number("from_h", from_to(0.0, 1e5));
    one.slew_s = table.number("slew_s", above_to(0.0, 1e5), 600.0);
    const auto profile = table.choice<Profile>("profile", kLaterProfiles);
    if (profile == Profile::kInertial) {
      one.profile = Inertial{read_quaternion(table, "q_body_eci")};
    } else {
      one.profile = truth::PointedSettings{read_pointing(table, profile), ""};
    }
    if (!later.empty() && one.from_s < later.back().from_s + later.back().slew_s)
      table.refuse_value("from_h", "a time at which the slew of the profile before has ended");
    table.finish();
    later.push_back(std::move(one));
  }
  return later;
}

}  // namespace vbar::mission
