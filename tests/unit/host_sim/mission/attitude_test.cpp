// [spacecraft.attitude]: what each profile reads, what is drawn from the seed, and what is refused.

#include "host_sim/mission/attitude.h"

#include <cmath>

#include <gmock/gmock.h>

#include "tests/support/figures.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {
namespace {

using Eigen::Quaterniond;
using fsw::Vector3;
using testing::ElementsAre;
using testing::HasSubstr;
using truth::Direction;
using truth::TorqueKind;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

/// The small mission with these lines in [spacecraft.attitude] of the servicer or the target.
std::string with_attitude(const std::string& lines, bool of_target = true) {
  const std::string text(kSmallMission);
  const std::string table = "[spacecraft.attitude]\n" + lines + "\n";
  if (of_target) return changed(text, "[[waypoint]]\nindex = 0", table + "[[waypoint]]\nindex = 0");
  return changed(text, "[spacecraft.elements]", table + "[spacecraft.elements]");
}

Attitude attitude_of(const std::string& lines, bool of_target = true) {
  const Mission mission = parse_mission(with_attitude(lines, of_target), "m.toml", {});
  const auto& attitude = mission.spacecraft[of_target ? 1 : 0].attitude;
  EXPECT_TRUE(attitude.has_value());
  return attitude.value_or(Attitude{});
}

TEST(AttitudeKeys, NoTableAndProfileNoneMeanNoAttitude) {
  EXPECT_FALSE(small_mission().spacecraft[0].attitude);
  EXPECT_FALSE(small_mission({"spacecraft.target.attitude.profile=none"}).spacecraft[1].attitude);
}

TEST(AttitudeKeys, LaterProfilesHaveTheirTimesAndKeys) {
  const std::string lines =
      "profile = \"tumble\"\n"
      "[[spacecraft.attitude.then]]\nfrom_h = 1.5\nprofile = \"zenith\"\nboresight_body = [0, 1, 0]\n"
      "secondary_axis_body = [1, 0, 0]\n"
      "[[spacecraft.attitude.then]]\nfrom_h = 2.0\nslew_s = 60\nprofile = \"inertial\"";
  const Mission mission = parse_mission(with_attitude(lines), "m.toml", {});
  const std::vector<LaterAttitude>& later = mission.spacecraft[1].later_attitudes;
  ASSERT_EQ(later.size(), 2U);
  EXPECT_TRUE(std::holds_alternative<Tumble>(*mission.spacecraft[1].attitude));
  EXPECT_DOUBLE_EQ(later[0].from_s, 5400.0);
  EXPECT_DOUBLE_EQ(later[0].slew_s, 600.0) << "the default";
  EXPECT_EQ(std::get<truth::PointedSettings>(later[0].profile).pointing.boresight_to, Direction::kZenith);
  EXPECT_EQ(std::get<truth::PointedSettings>(later[0].profile).pointing.boresight_body, Vector3::UnitY());
  EXPECT_DOUBLE_EQ(later[1].slew_s, 60.0);
  EXPECT_FALSE(std::get<Inertial>(later[1].profile).q_body_eci);
  EXPECT_TRUE(mission.spacecraft[0].later_attitudes.empty());
}

TEST(AttitudeKeys, TumbleLeavesItsStartToTheSeed) {
  const auto tumble = std::get<Tumble>(attitude_of("profile = \"tumble\""));
  EXPECT_FALSE(tumble.q_body_eci);
  EXPECT_FALSE(tumble.rate_body);
  EXPECT_DOUBLE_EQ(tumble.slowest_radps, 0.3 * kDegree);
  EXPECT_DOUBLE_EQ(tumble.fastest_radps, 1.5 * kDegree);
  EXPECT_EQ(tumble.body, "tango");
  EXPECT_FALSE(tumble.inertia_kgm2);
  EXPECT_TRUE(tumble.torques.empty());
  EXPECT_EQ(std::get<Tumble>(attitude_of("profile = \"tumble\"", false)).body, "mango");
}

TEST(AttitudeKeys, TumbleAsToldInEveryKey) {
  const auto tumble = std::get<Tumble>(
      attitude_of("profile = \"tumble\"\nq_body_eci = [0.6, 0.0, 0.0, 0.8]\nrate_degps = [1, -2, 0.5]\n"
                  "inertia_kgm2 = [2, 3, 4, 0.1, -0.2, 0.3]\ntorques = [\"radiation\", \"gravity_gradient\"]"));
  EXPECT_TRUE(tumble.q_body_eci->isApprox(Quaterniond(0.6, 0.0, 0.0, 0.8), 1e-15));
  EXPECT_TRUE(tumble.rate_body->isApprox(kDegree * Vector3(1.0, -2.0, 0.5), 1e-15));
  EXPECT_EQ(tumble.body, "tango");
  fsw::Matrix3 inertia;
  inertia << 2.0, 0.1, -0.2, 0.1, 3.0, 0.3, -0.2, 0.3, 4.0;
  EXPECT_EQ(*tumble.inertia_kgm2, inertia);
  EXPECT_THAT(tumble.torques, ElementsAre(TorqueKind::kRadiation, TorqueKind::kGravityGradient));
  const truth::AttitudeState start = start_of(tumble, 5, "target");
  EXPECT_EQ(start.q_body_eci.coeffs(), tumble.q_body_eci->coeffs());
  EXPECT_EQ(start.rate_body, *tumble.rate_body);
}

TEST(AttitudeKeys, InertialIsToldOrDrawn) {
  EXPECT_FALSE(std::get<Inertial>(attitude_of("profile = \"inertial\"")).q_body_eci);
  EXPECT_TRUE(std::get<Inertial>(attitude_of("profile = \"inertial\"\nq_body_eci = [0, 1, 0, 0]"))
                  .q_body_eci->isApprox(Quaterniond(0.0, 1.0, 0.0, 0.0), 1e-15));
}

TEST(AttitudeKeys, PointingProfiles) {
  const auto pointed = [](const std::string& lines) {
    return std::get<truth::PointedSettings>(attitude_of(lines, false));
  };
  const auto zenith = pointed("profile = \"zenith\"");
  EXPECT_EQ(zenith.pointing.boresight_to, Direction::kZenith);
  EXPECT_EQ(zenith.pointing.boresight_body, Vector3::UnitZ());
  EXPECT_EQ(zenith.pointing.second_to, Direction::kOrbitNormal);
  EXPECT_EQ(zenith.pointing.second_body, Vector3::UnitY());
  EXPECT_EQ(zenith.spacecraft, "");
  EXPECT_EQ(pointed("profile = \"nadir\"").pointing.boresight_to, Direction::kNadir);
  EXPECT_EQ(pointed("profile = \"along_track\"").pointing.boresight_to, Direction::kAlongTrack);
  const auto target = pointed(
      "profile = \"target\"\nboresight_body = [1, 0, 0]\nsecondary_axis_body = [0, 0, -1]\nsecondary_direction = "
      "\"sun\"");
  EXPECT_EQ(target.pointing.boresight_to, Direction::kSpacecraft);
  EXPECT_EQ(target.pointing.boresight_body, Vector3::UnitX());
  EXPECT_EQ(target.pointing.second_body, Vector3(0.0, 0.0, -1.0));
  EXPECT_EQ(target.pointing.second_to, Direction::kSun);
  EXPECT_EQ(target.spacecraft, "target");
}

TEST(AttitudeDraws, DependOnSeedAndSpacecraftOnly) {
  EXPECT_EQ(drawn_attitude(1, "target").coeffs(), drawn_attitude(1, "target").coeffs());
  EXPECT_NE(drawn_attitude(1, "target").coeffs(), drawn_attitude(2, "target").coeffs());
  EXPECT_NE(drawn_attitude(1, "target").coeffs(), drawn_attitude(1, "servicer").coeffs());
  EXPECT_EQ(drawn_rate(1, "target", 0.1, 0.2), drawn_rate(1, "target", 0.1, 0.2));
  EXPECT_NE(drawn_rate(1, "target", 0.1, 0.2), drawn_rate(2, "target", 0.1, 0.2));
  // The axis is the same whatever the range of rates.
  const Vector3 slow = drawn_rate(3, "target", 0.1, 0.1), fast = drawn_rate(3, "target", 1.0, 2.0);
  EXPECT_LT(slow.normalized().cross(fast.normalized()).norm(), 1e-15);
  EXPECT_NEAR(slow.norm(), 0.1, 1e-16);
}

TEST(AttitudeDraws, AreUniform) {
  // 4,000 seeds: means of numbers with known variances, to four standard deviations.
  constexpr int kCount = 4000;
  const double four_sigma = 4.0 / std::sqrt(1.0 * kCount);
  Vector3 axis_sum = Vector3::Zero(), axis_squares = Vector3::Zero();
  fsw::Matrix3 rotation_sum = fsw::Matrix3::Zero();
  double rate_sum = 0.0, trace_squares = 0.0;
  for (int seed = 0; seed < kCount; ++seed) {
    const Vector3 rate = drawn_rate(static_cast<std::uint64_t>(seed), "target", 1.0, 3.0);
    ASSERT_GE(rate.norm(), 1.0);
    ASSERT_LE(rate.norm(), 3.0);
    const Vector3 axis = rate.normalized();
    axis_sum += axis;
    axis_squares += axis.cwiseAbs2();
    rate_sum += rate.norm();
    const Quaterniond q = drawn_attitude(static_cast<std::uint64_t>(seed), "target");
    ASSERT_NEAR(q.norm(), 1.0, 1e-15);
    rotation_sum += q.toRotationMatrix();
    trace_squares += std::pow(q.toRotationMatrix().trace(), 2);
  }
  // A component of a uniform unit vector has variance 1/3, its square 4/45; so has an element of a uniform rotation.
  // The trace of a uniform rotation has mean square 1 and mean fourth power 3 (moments of the character of SO(3)).
  EXPECT_LT(accuracy::largest_entry(axis_sum) / kCount, std::sqrt(1.0 / 3.0) * four_sigma);
  EXPECT_LT(accuracy::largest_entry(axis_squares / kCount - Vector3::Constant(1.0 / 3.0)),
            std::sqrt(4.0 / 45.0) * four_sigma);
  EXPECT_LT(accuracy::largest_entry(rotation_sum) / kCount, std::sqrt(1.0 / 3.0) * four_sigma);
  EXPECT_NEAR(trace_squares / kCount, 1.0, std::sqrt(2.0) * four_sigma);
  EXPECT_NEAR(rate_sum / kCount, 2.0, 2.0 / std::sqrt(12.0) * four_sigma);
}

// Appendix A: 0.04 kg, 1 sigma. The mean square of 4000 draws is within 10 % (4 sigma and more).
TEST(DrawnMass, HasItsSigma) {
  constexpr int kDraws = 4000;
  double square = 0.0;
  for (std::uint64_t seed = 0; seed < kDraws; ++seed)
    square += std::pow(drawn_mass_error_kg(seed, "servicer", 0.04), 2);
  EXPECT_NEAR(square / kDraws / 0.0016, 1.0, 0.1);
  EXPECT_EQ(drawn_mass_error_kg(1, "servicer", 0.0), 0.0);
}

struct BadAttitude {
  std::string_view label;
  std::string_view lines;
  std::string_view message;  ///< after "spacecraft.target.attitude"
};

void PrintTo(const BadAttitude& bad, std::ostream* out) {
  *out << bad.label;
}

class BadAttitudeTest : public testing::TestWithParam<BadAttitude> {};

TEST_P(BadAttitudeTest, EndsWithOneMessage) {
  const std::string message = message_of(with_attitude(std::string(GetParam().lines)));
  EXPECT_THAT(message, HasSubstr(": spacecraft.target.attitude" + std::string(GetParam().message)));
  EXPECT_THAT(message, testing::StartsWith("m.toml:"));
}

INSTANTIATE_TEST_SUITE_P(
    OneValue, BadAttitudeTest,
    testing::Values(
        BadAttitude{"UnknownProfile", "profile = \"zenit\"",
                    ".profile: found the text \"zenit\" (did you mean zenith?); accepted: none, tumble, inertial, "
                    "zenith, nadir, along_track, target or commanded"},
        BadAttitude{"KeyOfAnotherProfile", "profile = \"zenith\"\ninertia_kgm2 = [1, 1, 1]",
                    ".inertia_kgm2: found an unknown key; accepted: profile, boresight_body, secondary_axis_body, "
                    "secondary_direction or then"},
        BadAttitude{"KeyWithoutProfile", "boresight_body = [1, 0, 0]",
                    ".boresight_body: found an unknown key; accepted: profile"},
        BadAttitude{"LaterOfNone", "[[spacecraft.attitude.then]]\nfrom_h = 1\nprofile = \"zenith\"",
                    ".then: found an unknown key; accepted: profile"},
        BadAttitude{"LaterWithoutHour", "profile = \"tumble\"\n[[spacecraft.attitude.then]]\nprofile = \"zenith\"",
                    ".then.0.from_h: found nothing; accepted: a number"},
        BadAttitude{"LaterTumble",
                    "profile = \"zenith\"\n[[spacecraft.attitude.then]]\nfrom_h = 1\nprofile = \"tumble\"",
                    ".then.0.profile: found the text \"tumble\"; accepted: inertial, zenith, nadir or along_track"},
        BadAttitude{"LaterWithoutASlew",
                    "profile = \"tumble\"\n[[spacecraft.attitude.then]]\nfrom_h = 1\nslew_s = 0\nprofile = \"zenith\"",
                    ".then.0.slew_s: found the integer 0; accepted: a number above 0"},
        BadAttitude{"LaterDuringASlew",
                    "profile = \"tumble\"\n[[spacecraft.attitude.then]]\nfrom_h = 1\nslew_s = 3600\nprofile = "
                    "\"zenith\"\n[[spacecraft.attitude.then]]\nfrom_h = 1.5\nprofile = \"nadir\"",
                    ".then.1.from_h: found the number 1.5; accepted: a time at which the slew of the profile before"},
        BadAttitude{"NoUnitQuaternion", "profile = \"inertial\"\nq_body_eci = [0.5, 0.5, 0, 0]",
                    ".q_body_eci: found a quaternion whose length is not 1; accepted: [w, x, y, z] of length 1, to "
                    "0.001"},
        BadAttitude{"ShortQuaternion", "profile = \"inertial\"\nq_body_eci = [1, 0, 0]",
                    ".q_body_eci: found an array of 3; accepted: an array of 4 numbers from -1 to 1"},
        BadAttitude{"TwoRates", "profile = \"tumble\"\nrate_degps = [1, 0, 0]\ntumble_rate_degps = [1, 2]",
                    ".rate_degps: found both rate_degps and tumble_rate_degps; accepted: at most one of them"},
        BadAttitude{"RateThatIsNoNumber", "profile = \"tumble\"\nrate_degps = [1, nan, 0]",
                    ".rate_degps[1]: found nan; accepted: a number from -3600 to 3600"},
        BadAttitude{"RangeBackwards", "profile = \"tumble\"\ntumble_rate_degps = [1.5, 0.3]",
                    ".tumble_rate_degps: found a range that ends below its start; accepted: [slowest, fastest]"},
        BadAttitude{"FiveInertias", "profile = \"tumble\"\ninertia_kgm2 = [1, 1, 1, 0, 0]",
                    ".inertia_kgm2: found an array of 5; accepted: [xx, yy, zz] or [xx, yy, zz, xy, xz, yz]"},
        BadAttitude{"InertiaOfNoBody", "profile = \"tumble\"\ninertia_kgm2 = [1, 1, 3]",
                    ".inertia_kgm2: found an invalid inertia: no body has a principal moment of inertia above "
                    "the sum of the other two; accepted: "},
        BadAttitude{"UnknownTorque", "profile = \"tumble\"\ntorques = [\"gravity_gradient\", \"magnetic\"]",
                    ".torques: found the text \"magnetic\"; accepted: an array of distinct names out of "
                    "gravity_gradient, aerodynamic or radiation"},
        BadAttitude{"TorqueTwice", "profile = \"tumble\"\ntorques = [\"radiation\", \"radiation\"]",
                    ".torques: found the text \"radiation\"; accepted: an array of distinct names"},
        BadAttitude{"TorquesThatAreNoArray", "profile = \"tumble\"\ntorques = \"radiation\"",
                    ".torques: found the text \"radiation\"; accepted: an array of distinct names"},
        BadAttitude{"BodyOfTheSpacecraft", "profile = \"tumble\"\nbody = \"tango\"", ".body: found an unknown key"},
        BadAttitude{"PointsAtItself", "profile = \"target\"",
                    ".target: found the spacecraft \"target\"; accepted: servicer"},
        BadAttitude{"PointsAtNobody", "profile = \"target\"\ntarget = \"moon\"",
                    ".target: found the spacecraft \"moon\"; accepted: servicer"},
        BadAttitude{"OneAxisTwice", "profile = \"nadir\"\nboresight_body = [0, -1, 0]",
                    ".boresight_body: found an axis along the other one; accepted: boresight_body and "
                    "secondary_axis_body in two "
                    "different directions"},
        BadAttitude{"NoAxis", "profile = \"nadir\"\nsecondary_axis_body = [0, 0, 0]",
                    ".secondary_axis_body: found an axis along the other one; accepted: boresight_body and "
                    "secondary_axis_body in two "
                    "different directions"},
        BadAttitude{"OneDirectionTwice", "profile = \"nadir\"\nsecondary_direction = \"zenith\"",
                    ".secondary_direction: found the line that the boresight follows; accepted: another direction"},
        BadAttitude{"UnknownDirection", "profile = \"nadir\"\nsecondary_direction = \"moon\"",
                    ".secondary_direction: found the text \"moon\"; accepted: orbit_normal, along_track, zenith, nadir "
                    "or sun"}),
    [](const auto& test) { return std::string(test.param.label); });

}  // namespace
}  // namespace vbar::mission::test
