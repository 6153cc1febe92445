// Which telecommands of navigation a mission sends: sources by its sensors, one packet per property, the unit of each
// camera; and what the flight software says of each camera's images goes to that camera.

#include "host_sim/installation/navigation_telecommands.h"

#include <map>

#include <gmock/gmock.h>

#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/camera/camera_rows.h"
#include "host_sim/twins/packet_encoder.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::sensors {
namespace {

using fsw::packets::Apid;
using mission::test::changed;
using testing::ElementsAre;
using testing::UnorderedElementsAre;
using Use = navigation_configuration;

constexpr std::int32_t sum(std::initializer_list<std::int32_t> uses) {
  std::int32_t all = 0;
  for (const std::int32_t use : uses) all += use;
  return all;
}

/// The small mission with these sensors of the servicer, and a target with a receiver that cameras see.
mission::Mission mission_of(const std::string& sensors, const std::vector<std::string>& overrides = {}) {
  std::string text = changed(std::string(mission::test::kSmallMission), "sensors.navigation = {}",
                             "attitude = { profile = \"commanded\" }\n" + sensors);
  text = changed(text, "relative = {",
                 "model = \"tango\"\nattitude = { profile = \"tumble\" }\nsensors.gnss = {}\nrelative = {");
  return parse_mission(text, "m.toml", overrides);
}

const std::string kPair = "sensors.gnss = { partner = \"target\" }\n", kReceiver = "sensors.gnss = {}\n",
                  kTrueStates = "sensors.navigation = {}\n",
                  kFar = "sensors.far = { kind = \"camera\", navigation = \"angles_only\" }\n",
                  kClose = "sensors.close = { kind = \"camera\", camera = \"tron\", navigation = \"pose\" }\n",
                  kAnotherClose = "sensors.aft = { kind = \"camera\", camera = \"tron\", navigation = \"pose\" }\n",
                  kWatching = "sensors.alone = { kind = \"camera\", navigation = \"none\" }\n",
                  kLidar = "sensors.lidar = { kind = \"range_finder\", used_by_navigation = true }\n",
                  kUnusedLidar = "sensors.lidar = { kind = \"range_finder\" }\n";

std::int32_t sources_of(const std::string& sensors) {
  return vbar::sensors::sources_of(mission_of(sensors).spacecraft[0]);
}

TEST(NavigationSources, AreTheUnionOverTheSensors) {
  EXPECT_EQ(sources_of(kPair), sum({Use::kUseOwnGnss, Use::kUseCarrierPair}));
  EXPECT_EQ(sources_of(kPair + kLidar), sum({Use::kUseOwnGnss, Use::kUseCarrierPair, Use::kUseRangeFinder}));
  EXPECT_EQ(sources_of(kPair + kUnusedLidar + kWatching), sources_of(kPair));
  EXPECT_EQ(sources_of(kReceiver + kFar), sum({Use::kUseOwnGnss, Use::kUseBearings}));
  EXPECT_EQ(sources_of(kReceiver + kClose + kLidar), sum({Use::kUseOwnGnss, Use::kUseKeypoints, Use::kUseRangeFinder}));
  EXPECT_EQ(sources_of(kReceiver + kClose + kFar), sum({Use::kUseOwnGnss, Use::kUseBearings, Use::kUseKeypoints}));
  EXPECT_EQ(sources_of(kPair + kClose + kFar),
            sum({Use::kUseOwnGnss, Use::kUseCarrierPair, Use::kUseBearings, Use::kUseKeypoints}));
}

TEST(NavigationSources, TrueStatesStandAlone) {
  EXPECT_EQ(sources_of(kTrueStates), std::int32_t{Use::kUseIdeal});
  EXPECT_EQ(sources_of(kTrueStates + kLidar), std::int32_t{Use::kUseIdeal});
}

/// All telecommands as (APID, unit).
std::vector<std::pair<Apid, int>> sent_by(const mission::Mission& mission) {
  static const auto orientation =
      truth::EarthOrientationSeries::load(vbar::tests::source_path("data/earth/eop_2009_2013.csv"));
  const fsw::orbit::CartesianState own{{7.0e6, 0.0, 0.0}, {0.0, 100.0, 7546.0}};
  const fsw::orbit::CartesianState target{own.position_eci + fsw::Vector3(1.0, 8.0, 3.0), own.velocity_eci};
  std::vector<std::pair<Apid, int>> sent;
  for (const twins::Packet& packet :
       telecommands_of({mission, mission.spacecraft[0], vbar::tests::source_path("data"), orientation,
                        [&](std::string_view spacecraft) { return spacecraft == "servicer" ? own : target; }})) {
    const fsw::packets::PacketHeader header = fsw::packets::parse_packet(packet).value().header;
    EXPECT_EQ(header.time, mission.start_time()) << "the epoch of an a-priori orbit, too";
    sent.emplace_back(header.apid, header.unit);
  }
  return sent;
}

TEST(NavigationTelecommands, OfAGnssPair) {
  using enum Apid;
  EXPECT_THAT(sent_by(mission_of(kPair + kLidar)),
              UnorderedElementsAre(std::pair(kGncConfiguration, 0), std::pair(kNavigationConfiguration, 0),
                                   std::pair(kEarthConfiguration, 0), std::pair(kThrusterConfiguration, 0),
                                   std::pair(kReceiverConfiguration, 0), std::pair(kCarrierConfiguration, 0),
                                   std::pair(kRangeConfiguration, 0), std::pair(kWaypointTable, 0),
                                   std::pair(kModeCommand, 0)));
}

TEST(NavigationTelecommands, OfTwoCamerasHaveTheirUnitsAndOneTarget) {
  using enum Apid;
  // By name: aft, far; the camera that navigation does not use comes first and counts last.
  EXPECT_THAT(sent_by(mission_of(kReceiver + kWatching + kFar + kAnotherClose)),
              UnorderedElementsAre(
                  std::pair(kGncConfiguration, 0), std::pair(kNavigationConfiguration, 0),
                  std::pair(kEarthConfiguration, 0), std::pair(kThrusterConfiguration, 0), std::pair(kTargetApriori, 0),
                  std::pair(kTargetModel, 0), std::pair(kReceiverConfiguration, 0), std::pair(kCameraConfiguration, 0),
                  std::pair(kPoseConfiguration, 0), std::pair(kCameraConfiguration, 1),
                  std::pair(kAnglesOnlyConfiguration, 1), std::pair(kWaypointTable, 0), std::pair(kModeCommand, 0)));
  EXPECT_THAT(sent_by(mission_of(kReceiver + kClose + kAnotherClose)),
              UnorderedElementsAre(std::pair(kGncConfiguration, 0), std::pair(kNavigationConfiguration, 0),
                                   std::pair(kEarthConfiguration, 0), std::pair(kThrusterConfiguration, 0),
                                   std::pair(kTargetModel, 0), std::pair(kReceiverConfiguration, 0),
                                   std::pair(kCameraConfiguration, 0), std::pair(kPoseConfiguration, 0),
                                   std::pair(kCameraConfiguration, 1), std::pair(kPoseConfiguration, 1),
                                   std::pair(kWaypointTable, 0), std::pair(kModeCommand, 0)))
      << "no a-priori orbit";
}

TEST(NavigationTelecommands, NoneForTrueStates) {
  using enum Apid;
  EXPECT_THAT(sent_by(mission_of(kTrueStates)),
              ElementsAre(std::pair(kGncConfiguration, 0), std::pair(kWaypointTable, 0), std::pair(kModeCommand, 0)));
}

// Burns that last: navigation and guidance know the acceleration, with true states too.
TEST(NavigationTelecommands, OfAThrusterStateItsAcceleration) {
  using enum Apid;
  const std::string thruster = "spacecraft.servicer.actuators.thruster.";
  const auto with_thrust = [&](const std::string& sensors, const std::string& newtons) {
    return mission_of(sensors, {thruster + "thrust_n=" + newtons, thruster + "specific_impulse_s=65",
                                thruster + "propellant_kg=0.5", thruster + "rise_s=0.1", thruster + "fall_s=0.3"});
  };
  const mission::Mission mission = with_thrust(kTrueStates, "0.02");
  EXPECT_THAT(sent_by(mission), UnorderedElementsAre(std::pair(kGncConfiguration, 0), std::pair(kWaypointTable, 0),
                                                     std::pair(kModeCommand, 0), std::pair(kThrusterConfiguration, 0)));
  const auto configuration = thruster_configuration_of(mission, mission.spacecraft[0]);
  EXPECT_DOUBLE_EQ(configuration.thrust_acceleration, 0.02 / mission.spacecraft[0].surface.mass_kg);
  EXPECT_DOUBLE_EQ(configuration.pause_s, 0.4);
  EXPECT_EQ(thruster_configuration_of(mission_of(kPair), mission_of(kPair).spacecraft[0]).thrust_acceleration, 0.0);
  const mission::Mission weak = with_thrust(kTrueStates, "1e-6");
  EXPECT_THAT([&] { static_cast<void>(thruster_configuration_of(weak, weak.spacecraft[0])); },
              testing::ThrowsMessage<std::runtime_error>(testing::MatchesRegex(
                  "spacecraft \"servicer\": actuators.thruster.thrust_n: found 1e-06 N on .* kg, .* m/s\\^2; accepted: "
                  "1e-07 to 1000 m/s\\^2")));
}

// Mean ROE times the servicer's own mean a: of a target 5 m behind along track, with sigmas that do not matter beside.
TEST(NavigationTelecommands, AprioriOfPrecedingNavigationIsByRoe) {
  const mission::Mission mission =
      mission_of(kReceiver + kClose, {"navigation.apriori.kind=roe", "navigation.apriori.sigma_a_da_m=1e-6",
                                      "navigation.apriori.sigma_a_dlambda_m=1e-6",
                                      "navigation.apriori.sigma_a_de_m=1e-6", "navigation.apriori.sigma_a_di_m=1e-6"});
  const double speed = std::sqrt(3.986004415e14 / 7.1e6);
  const fsw::orbit::CartesianState own{{7.1e6, 0.0, 0.0}, {0.0, 0.1 * speed, std::sqrt(0.99) * speed}};
  const fsw::Vector3 along = own.velocity_eci.normalized(), up = fsw::Vector3::UnitX();
  const double angle = -5.0 / 7.1e6;
  const fsw::orbit::CartesianState target{7.1e6 * (std::cos(angle) * up + std::sin(angle) * along),
                                          speed * (std::cos(angle) * along - std::sin(angle) * up)};
  const auto apriori = target_apriori_of(mission, mission.spacecraft[0], own, target);
  EXPECT_EQ(apriori.kind, target_apriori::kKindRoe);
  EXPECT_NEAR(apriori.mean_a_roe_m[1], -5.0, 0.1);
  for (const int k : {0, 2, 3, 4, 5}) EXPECT_NEAR(apriori.mean_a_roe_m[k], 0.0, 0.1) << k;
  for (const double sigma : apriori.sigma_a_roe_m) EXPECT_EQ(sigma, 1e-6);
  EXPECT_THAT(apriori.position_eci, ElementsAre(0, 0, 0)) << "of the other kind";
}

TEST(CameraEvaluations, AreToldOfTheirOwnImagesOnly) {
  const mission::Mission mission = mission_of(kReceiver + kFar + kAnotherClose);
  report::RunRecord record;
  record.extensions = extensions();
  std::map<std::string, std::unique_ptr<Evaluation>> evaluations;
  for (NamedEvaluation& one : make_evaluations(mission, mission.spacecraft[0], record))
    evaluations[one.source] = std::move(one.evaluation);
  ASSERT_TRUE(evaluations.contains("servicer/aft") && evaluations.contains("servicer/far"));
  twins::PacketEncoder of_aft(1, 0), of_far(1, 1);
  telemetry_pose pose{};
  pose.image = 3;
  telemetry_image image{};
  image.image = 4;
  const twins::Packet told[] = {of_aft.encode(mission.start_time(), pose).value(),
                                of_far.encode(mission.start_time(), image).value()};
  std::vector<fsw::packets::PacketView> answer;
  for (const twins::Packet& packet : told) answer.push_back(fsw::packets::parse_packet(packet).value());
  evaluations.at("servicer/aft")->on_answer(mission.start_time(), answer);
  EXPECT_EQ(record.tables.rows<PoseRow>().size(), 1U);
  EXPECT_TRUE(record.tables.rows<ImageRow>().empty());
  evaluations.at("servicer/far")->on_answer(mission.start_time(), answer);
  EXPECT_EQ(record.tables.rows<PoseRow>().size(), 1U);
  EXPECT_EQ(record.tables.rows<ImageRow>().size(), 1U);
}

}  // namespace
}  // namespace vbar::sensors
