// The keys of a camera and of angles-only navigation: what arrives in SI units, what is telecommanded, what is refused.

#include <cmath>

#include <gmock/gmock.h>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "fsw/packets/messages.h"
#include "host_sim/installation/navigation_telecommands.h"
#include "host_sim/sensors/settings/camera_file.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {
namespace {

using sensors::camera_configuration_of;
using sensors::load_camera;
using sensors::navigation_configuration_of;
using sensors::target_apriori_of;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

/// The small mission with a camera and a receiver instead of ideal navigation, and a decoy.
std::string camera_mission() {
  std::string text = changed(std::string(kSmallMission), "sensors.navigation = {}",
                             "attitude = { profile = \"commanded\" }\nsensors.gnss = {}\nsensors.camera = {}");
  text = changed(text, "relative = { to = \"servicer\", waypoint = 0 }",
                 "model = \"tango\"\nattitude = { profile = \"tumble\" }\n"
                 "relative = { to = \"servicer\", waypoint = 0 }\n[[spacecraft]]\nname = \"decoy\"\nmodel = \"tango\"\n"
                 "relative = { to = \"servicer\", a_roe_m = [1, -9000, 2, 3, 4, 5] } # decoy");
  return text;
}

Mission mission_with(const std::vector<std::string>& overrides = {}) {
  return parse_mission(camera_mission(), "m.toml", overrides);
}

TEST(CameraKeys, DefaultIsTheOpticalStimulator) {
  const Mission mission = mission_with();
  const CameraSensor& camera = sensor_of<CameraSensor>(mission);
  EXPECT_EQ(camera.camera, "optical_stimulator");
  EXPECT_EQ(camera.observed, "target");
  EXPECT_EQ(mission.spacecraft[0].observes(), "target");
  EXPECT_EQ(camera.images, mission.step);
  EXPECT_EQ(camera.readout, fsw::duration_of_seconds(2));
  EXPECT_EQ(camera.q_camera_body.coeffs(), Eigen::Quaterniond::Identity().coeffs());
  // The paper's camera: 18.3 deg across, 500 x 800 of 1920 x 1200 pixels; 35 mm over 5.86 um.
  EXPECT_NEAR(camera.settings.focal_length_px(), 5972.7, 0.05);
  EXPECT_NEAR(2.0 * std::atan(960.0 / camera.settings.focal_length_px()) / kDegree, 18.3, 0.05);
  EXPECT_EQ(camera.settings.region, (twins::camera::Region{710, 200, 500, 800}));
  EXPECT_EQ(mission.spacecraft[1].model, "tango");
  EXPECT_EQ(mission.spacecraft[0].model, "");
}

// What a camera file leaves out is the Optical Stimulator's: its own file says nothing else.
TEST(CameraKeys, AFieldOfViewStatesTheFocalLength) {
  // 1920 pixels of 5.86 um: 11.2512 mm of detector; 5.6256 mm over tan 6 deg.
  const std::string optics = "spacecraft.servicer.sensors.camera.optics.";
  const auto focal_length_mm = [](const Mission& mission) {
    return sensor_of<CameraSensor>(mission).settings.optics.focal_length_mm;
  };
  const std::string file = vbar::tests::source_path("missions/experiment1.toml").string();
  EXPECT_NEAR(focal_length_mm(load_mission(file, {{optics + "field_of_view_deg=12"}})), 53.5240, 1e-3);
  EXPECT_EQ(focal_length_mm(load_mission(file, {{optics + "field_of_view_deg=12"}, {optics + "focal_length_mm=20"}})),
            20.0);
}

TEST(CameraKeys, TheOpticalStimulatorsFileIsTheDefault) {
  const auto file = load_camera(vbar::tests::source_path("data/cameras/optical_stimulator.toml")).settings();
  const twins::camera::CameraSettings usual;
  EXPECT_EQ(file.optics.principal_point_px, usual.optics.principal_point_px);
  EXPECT_EQ(file.optics.distortion, usual.optics.distortion);
  EXPECT_EQ(file.region, usual.region);
  const auto numbers = [](const twins::camera::CameraSettings& s) {
    const auto& o = s.optics;
    const auto& d = s.detector;
    return std::vector<double>{s.exposure_s,
                               s.zero_magnitude_photons,
                               o.focal_length_mm,
                               o.f_number,
                               o.transmission,
                               o.point_spread_sigma_px,
                               o.halo_fraction,
                               o.halo_sigma_px,
                               o.vignetting,
                               o.sun_exclusion_deg,
                               o.stray_light_electrons,
                               1.0 * d.width,
                               1.0 * d.height,
                               d.pixel_pitch_um,
                               d.quantum_efficiency,
                               d.full_well_electrons,
                               d.gain_dn_per_electron,
                               1.0 * d.bits,
                               d.offset_dn,
                               d.read_noise_electrons,
                               d.dark_electrons_per_s,
                               d.dark_nonuniformity,
                               d.photo_response_nonuniformity,
                               1.0 * d.hot_pixels,
                               d.hot_pixel_electrons_per_s,
                               d.blooming_fraction};
  };
  EXPECT_EQ(numbers(file), numbers(usual));
}

TEST(CameraKeys, ACameraOfTwoUsesHasTwoExposures) {
  const Mission mission =
      mission_with({"camera.navigation=[\"angles_only\", \"pose\"]", "camera.exposure_s=0.2",
                    "camera.exposure_keypoints_s=1e-5", "camera.period_s=[[0.0, 60.0], [36.0, 20.0]]"});
  const CameraSensor& camera = sensor_of<CameraSensor>(mission);
  EXPECT_TRUE(camera.changes_use());
  EXPECT_EQ(camera.settings.exposure_s, 0.2);
  EXPECT_EQ(camera.keypoint_exposure_s, 1e-5);
  ASSERT_EQ(camera.images.parts().size(), 2U);
  EXPECT_EQ(camera.images.parts()[1].from, mission.epoch + fsw::duration_of_seconds(36 * 3600));
}

TEST(CameraKeys, UntilHEndsTheImages) {
  const Mission mission = mission_with({"camera.period_s=60", "camera.until_h=2"});
  const CameraSensor& camera = sensor_of<CameraSensor>(mission);
  const fsw::GpsTime last = mission.epoch + fsw::duration_of_seconds(2 * 3600);
  EXPECT_EQ(camera.next_image(last - fsw::duration_of_seconds(1)), last);
  EXPECT_EQ(camera.next_image(last + fsw::Duration{1}), std::nullopt);
}

TEST(CameraKeys, EveryKeyArrives) {
  const Mission mission = mission_with({"camera.camera=tron", "camera.period_s=30", "camera.readout_s=1.5",
                                        "camera.exposure_s=0.1", "camera.region_px=[10, 20, 300, 400]",
                                        "camera.q_camera_body=[0, 1, 0, 0]", "camera.position_body_m=[0.1, 0.2, 0.3]",
                                        "camera.optics.f_number=2.8", "camera.detector.hot_pixels=7",
                                        "camera.target=decoy", "spacecraft.decoy.attitude.profile=inertial"});
  const CameraSensor& camera = sensor_of<CameraSensor>(mission);
  EXPECT_NEAR(camera.settings.focal_length_px(), 2901.0, 0.1) << "of TRON's 17 mm";
  EXPECT_EQ(camera.settings.optics.distortion[0], -0.22383);
  EXPECT_EQ(camera.images, engine::Cadence(mission.start_time(), fsw::duration_of_seconds(30)));
  EXPECT_EQ(camera.readout.ns, 1500000000);
  EXPECT_EQ(camera.settings.exposure_s, 0.1);
  EXPECT_EQ(camera.settings.region, (twins::camera::Region{10, 20, 300, 400}));
  EXPECT_EQ(camera.q_camera_body.coeffs(), Eigen::Quaterniond(0, 1, 0, 0).coeffs());
  EXPECT_EQ(camera.position_body_m, fsw::Vector3(0.1, 0.2, 0.3));
  EXPECT_EQ(camera.settings.optics.f_number, 2.8);
  EXPECT_EQ(camera.settings.detector.hot_pixels, 7);
  EXPECT_EQ(camera.observed, "decoy");
}

// Two by two of TRON's pixels: 2 x 5.86 um, a quarter of them; the corner of the detector stays where it is.
TEST(CameraKeys, BinnedPixelsAreTheCamerasPixels) {
  const Mission mission = mission_with({"camera.camera=tron", "camera.detector.binning=2", "camera.detector.bits=12",
                                        "camera.detector.offset_dn=64", "camera.detector.gain_dn_per_electron=0.03",
                                        "camera.region_px=[80, 50, 800, 500]"});
  const twins::camera::CameraSettings& settings = sensor_of<CameraSensor>(mission).settings;
  EXPECT_EQ(settings.detector.width, 960);
  EXPECT_EQ(settings.detector.height, 600);
  EXPECT_EQ(settings.region, (twins::camera::Region{80, 50, 800, 500}));
  EXPECT_EQ(settings.detector.gain_dn_per_electron, 0.03);
  EXPECT_EQ(settings.detector.full_well_electrons, 128000.0);
  const vbar::camera_configuration c = camera_configuration_of(sensor_of<CameraSensor>(mission));
  EXPECT_NEAR(c.focal_length_px[0], 17.0 / 11.72e-3, 1e-9);
  EXPECT_EQ(c.principal_point_px[0], 479.5);
  EXPECT_EQ(c.principal_point_px[1], 299.5);
  EXPECT_EQ(c.point_spread_sigma_px, 0.3);
  EXPECT_EQ(c.gain_dn_per_electron, 0.03);
  EXPECT_EQ(c.width, 800);
  EXPECT_NEAR(c.saturation_dn, 64.0 + 0.03 * 128000.0, 50.0);
}

TEST(CameraKeys, BinningTakesGainAndRegionOfTheCameraFileAlong) {
  const auto settings =
      sensor_of<CameraSensor>(mission_with({"camera.camera=tron", "camera.detector.binning=4"})).settings;
  EXPECT_EQ(settings.region, (twins::camera::Region{165, 75, 150, 150}));
  EXPECT_DOUBLE_EQ(settings.detector.gain_dn_per_electron, 0.0078 / 16.0);
  EXPECT_DOUBLE_EQ(settings.optics.principal_point_px[0], 239.5);
}

TEST(CameraKeys, ADecoyHasItsOwnElements) {
  const auto orbit = std::get<OrbitByRoe>(mission_with().spacecraft[2].orbit);
  EXPECT_EQ(orbit.to, "servicer");
  EXPECT_THAT(orbit.a_roe_m, ElementsAre(1, -9000, 2, 3, 4, 5));
}

TEST(CameraKeys, AnglesOnlyDefaultsAndUnits) {
  const Mission mission = mission_with();
  const auto& shared = shared_settings<CameraShared>(mission);
  const vbar::angles_only_configuration& navigation = shared.angles_only;
  EXPECT_EQ(navigation.detection_sigmas, 5.0);
  EXPECT_EQ(navigation.centroid_floor_px, 0.05);
  EXPECT_DOUBLE_EQ(navigation.pointing_tolerance, 600.0 / 3600.0 * kDegree);
  EXPECT_EQ(navigation.brightness_offset_m, 0.15);
  EXPECT_EQ(navigation.centroid_noise_m, 0.08);
  EXPECT_DOUBLE_EQ(navigation.bearing_bias, 3.0 / 3600.0 * kDegree);
  EXPECT_EQ(navigation.batch_images, 30);
}

TEST(CameraKeys, NavigationDefaultsAndUnits) {
  const Mission mission = mission_with();
  const vbar::navigation_configuration& navigation = mission.navigation.configuration;
  EXPECT_EQ(navigation.acceleration_psd, 1e-14);
  EXPECT_EQ(navigation.acceleration_psd_least, 1e-15);
  EXPECT_EQ(navigation.acceleration_psd_most, 1e-11);
  EXPECT_DOUBLE_EQ(navigation.acceleration_sigma, 1e-9);
  EXPECT_EQ(navigation.acceleration_time_s, 1500.0);
  EXPECT_DOUBLE_EQ(mission.navigation.thruster.sigma_mps, 2e-6);
  EXPECT_DOUBLE_EQ(mission.navigation.thruster.sigma_relative, 2e-3);
  EXPECT_EQ(mission.navigation.apriori, Apriori::kOrbit) << "bearings need one";
  EXPECT_THAT(mission.navigation.apriori_sigma_a_roe_m, ElementsAre(30, 1000, 200, 200, 200, 200));
  EXPECT_EQ(mission.navigation.angular_acceleration_psd, 1e-11);
}

TEST(CameraTelecommands, CameraIsAsCalibrated) {
  const Mission mission = mission_with({"camera.q_camera_body=[0.6, 0.8, 0, 0]"});
  const vbar::camera_configuration c = camera_configuration_of(sensor_of<CameraSensor>(mission));
  EXPECT_EQ(c.width, 500);
  EXPECT_EQ(c.height, 800);
  EXPECT_EQ(c.origin_x, 710);
  EXPECT_EQ(c.origin_y, 200);
  EXPECT_EQ(c.bits, 12);
  EXPECT_NEAR(c.focal_length_px[1], 5972.696, 1e-3);
  EXPECT_EQ(c.principal_point_px[0], 959.5);
  // By hand: 2.6e10 / (m^2 s), 0.2 s, an aperture of 35 mm / 1.9 (2.66513e-4 m^2), 0.9 of it let through, 0.7 detected,
  // an eighth of a number each.
  EXPECT_NEAR(c.zero_magnitude_dn, 3.1e10 * 0.2 * 2.66513e-4 * 0.9 * 0.7 / 8.0, 2e4 * 1e-1);
  EXPECT_NEAR(c.saturation_dn, 64.0 + 4000.0, 50.0) << "a full well, less some noise";
  EXPECT_LT(c.saturation_dn, 64.0 + 4000.0 - 10.0);
  EXPECT_THAT(c.q_camera_body, ElementsAre(0.6, 0.8, 0, 0));
}

TEST(CameraTelecommands, NavigationIsByCameraWithoutAPartner) {
  const auto orientation =
      truth::EarthOrientationSeries::load(vbar::tests::source_path("data/earth/eop_2009_2013.csv"));
  const Mission mission = mission_with({"gnss.body_frame.antenna_in_body_m=[0, -0.3, 0]"});
  using Use = vbar::navigation_configuration;
  EXPECT_EQ(navigation_configuration_of(mission, mission.spacecraft[0]).sources,
            std::int32_t{Use::kUseOwnGnss} + Use::kUseBearings);
  EXPECT_EQ(sensors::receiver_configuration_of(mission.spacecraft[0]).antenna_body_m[1], -0.3);
  EXPECT_NEAR(sensors::earth_configuration_of(mission, orientation).ut1_minus_gps_s, -15.0 - 0.285, 0.01)
      << "2011-07-18: UT1-UTC about -0.285 s, 15 leap seconds";
}

/// Mean ROE of the a-priori target less those of the true one, in metres.
fsw::Vector6 apriori_error_m(std::uint64_t seed) {
  const Mission mission = mission_with({"mission.seed=" + std::to_string(seed)});
  const fsw::orbit::QnsElements chief{7078000.0, 0.001, 2e-5, 98.2 * kDegree, 1.0, 0.5};
  const double a = mission.guidance.reference_semi_major_axis_m;
  fsw::Vector6 roe;
  roe << -2000.0, -75000.0, 100.0, 0.0, -50.0, 0.0;
  roe /= a;
  const auto state = [](const fsw::orbit::QnsElements& mean) {
    return fsw::orbit::cartesian_from_qns(fsw::orbit::osculating_from_mean(mean).value()).value();
  };
  const auto apriori =
      target_apriori_of(mission, mission.spacecraft[0], state(chief), state(fsw::orbit::qns_from_roe(chief, roe)));
  const fsw::orbit::CartesianState told{Eigen::Map<const fsw::Vector3>(apriori.position_eci),
                                        Eigen::Map<const fsw::Vector3>(apriori.velocity_eci)};
  const auto mean = fsw::orbit::mean_from_osculating(fsw::orbit::qns_from_cartesian(told).value()).value();
  return a * (fsw::orbit::roe_from_qns(chief, mean) - roe);
}

// 400 seeds: the sum of squares of each over its variance is chi-square with 400 degrees; six of them inside 400 +- 113
// (four standard deviations).
TEST(CameraTelecommands, AprioriErrsByItsSigmas) {
  constexpr int kSeeds = 400;
  const double sigma_m[6] = {30, 1000, 200, 200, 200, 200};
  fsw::Vector6 squares = fsw::Vector6::Zero(), sum = fsw::Vector6::Zero();
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const fsw::Vector6 error = apriori_error_m(static_cast<std::uint64_t>(seed));
    for (int k = 0; k < 6; ++k) {
      squares(k) += std::pow(error(k) / sigma_m[k], 2);
      sum(k) += error(k) / sigma_m[k];
    }
  }
  for (int k = 0; k < 6; ++k) {
    EXPECT_NEAR(squares(k), 400.0, 4.0 * std::sqrt(2.0 * 400.0)) << k;
    EXPECT_NEAR(sum(k), 0.0, 4.0 * std::sqrt(400.0)) << k;
  }
  EXPECT_EQ(apriori_error_m(5), apriori_error_m(5));
  EXPECT_NE(apriori_error_m(5), apriori_error_m(6));
}

TEST(CameraTelecommands, ArePackets) {
  const Mission mission = mission_with();
  std::array<std::uint8_t, fsw::packets::kMaxPacketBytes> buffer{};
  EXPECT_TRUE(fsw::packets::encode({}, camera_configuration_of(sensor_of<CameraSensor>(mission)), buffer).ok());
  EXPECT_TRUE(fsw::packets::encode({}, shared_settings<CameraShared>(mission).angles_only, buffer).ok());
}

struct BadOverride {
  const char* label;
  std::vector<std::string> overrides;
  const char* message;
};

void PrintTo(const BadOverride& bad, std::ostream* out) {
  *out << bad.label;
}

class BadCameraMission : public testing::TestWithParam<BadOverride> {};

TEST_P(BadCameraMission, EndsWithOneMessage) {
  EXPECT_THAT(message_of(camera_mission(), GetParam().overrides), HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    OneValue, BadCameraMission,
    testing::Values(
        BadOverride{"UnknownSource",
                    {"camera.source=tron"},
                    "camera.source: found the text \"tron\"; accepted: digital or recorded"},
        BadOverride{"UnknownCamera",
                    {"camera.camera=optical_simulator"},
                    "camera.camera: found the text \"optical_simulator\" (did you mean optical_stimulator?); accepted: "
                    "optical_stimulator or tron, or the path of a camera file (./...)"},
        BadOverride{
            "UnknownKey", {"camera.optics.fnumber=2"}, "optics.fnumber: found an unknown key (did you mean f_number?)"},
        BadOverride{"RegionOffTheDetector",
                    {"camera.region_px=[1500, 0, 500, 800]"},
                    "camera.region_px: found a region that does not lie on the detector; accepted: [x, y, width, "
                    "height] inside 1920 x 1200 pixels"},
        BadOverride{"RegionTooLarge",
                    {"camera.region_px=[0, 0, 1920, 1200]"},
                    "camera.region_px: found 2304000 pixels; accepted: at most the 400000 that the flight software "
                    "holds"},
        BadOverride{"RegionOfPartsOfPixels",
                    {"camera.region_px=[0, 0.5, 500, 800]"},
                    "camera.region_px: found a number that is no integer"},
        BadOverride{"ThreeByThree",
                    {"camera.detector.binning=3"},
                    "detector.binning: found the integer 3; accepted: 1, 2 or 4"},
        BadOverride{"RegionOfSinglePixels",
                    {"camera.detector.binning=4", "camera.region_px=[400, 0, 300, 200]"},
                    "camera.region_px: found a region that does not lie on the detector; accepted: [x, y, width, "
                    "height] inside 480 x 300 pixels"},
        BadOverride{"TenBits", {"camera.detector.bits=10"}, "detector.bits: found the integer 10; accepted: 8 or 12"},
        BadOverride{"OffsetOfEightBits",
                    {"camera.detector.bits=8", "camera.detector.offset_dn=200"},
                    "detector.offset_dn: found an offset that leaves no room for light"},
        BadOverride{"FasterThanItReads",
                    {"camera.period_s=2"},
                    "camera.period_s: found images that come faster than one is exposed and read"},
        BadOverride{"TwoUsesOfOneExposure",
                    {"camera.navigation=[\"angles_only\", \"pose\"]"},
                    "exposure_keypoints_s: found nothing; accepted: a number from 1e-06 to 0.2"},
        BadOverride{"TwoExposuresOfOneUse",
                    {"camera.exposure_keypoints_s=1e-5"},
                    "camera.exposure_keypoints_s: found an unknown key"},
        BadOverride{"PeriodsOutOfOrder",
                    {"camera.period_s=[[1.0, 60.0], [1.0, 20.0]]"},
                    "camera.period_s: found an array of 2; accepted: hours in increasing order"},
        BadOverride{"NoRotation", {"camera.q_camera_body=[1, 1, 0, 0]"}, "camera.q_camera_body: found a quaternion"},
        BadOverride{"LooksForNobody",
                    {"camera.target=moon"},
                    "camera.target: found the spacecraft \"moon\"; accepted: target or decoy"},
        BadOverride{"LooksForTheUnseen",
                    {"camera.target=decoy"},
                    "camera.target: found the spacecraft \"decoy\" without an attitude; accepted: a spacecraft with a "
                    "model and an attitude"},
        BadOverride{"PartnerOtherThanTheTargetOfTheCamera",
                    {"gnss.partner=decoy", "spacecraft.decoy.sensors.gnss.period_s=10",
                     "spacecraft.decoy.attitude.profile=zenith"},
                    "camera.target: found the spacecraft \"target\" beside a GNSS receiver with the partner \"decoy\"; "
                    "accepted: the partner"},
        BadOverride{
            "NoAttitude", {"spacecraft.servicer.attitude.profile=none"}, "camera: found a camera without an attitude"},
        BadOverride{"PsdOutsideItsLimits",
                    {"navigation.acceleration_psd=1e-10"},
                    "navigation.acceleration_psd: found an initial value outside its limits"},
        BadOverride{"NoBatch",
                    {"navigation.angles_only.batch_images=2"},
                    "navigation.angles_only.batch_images: found the integer 2"},
        BadOverride{"AprioriWithoutError",
                    {"navigation.apriori.sigma_a_da_m=0"},
                    "navigation.apriori.sigma_a_da_m: found the integer 0; accepted: a number above 0"}),
    [](const auto& test) { return std::string(test.param.label); });

TEST(BadCameraMission, SensorsThatDoNotGoTogether) {
  EXPECT_THAT(message_of(changed(camera_mission(), "sensors.gnss = {}\n", "")),
              HasSubstr("sensors.camera: found a camera without a GNSS receiver; accepted: a GNSS receiver too"));
  EXPECT_THAT(message_of(changed(camera_mission(), "flight_computer = {}\n", "")),
              HasSubstr("sensors.camera: found a camera without a flight computer"));
  EXPECT_THAT(message_of(changed(camera_mission(), ", a_roe_m = [1", ", waypoint = 0, a_roe_m = [1")),
              HasSubstr("decoy.relative.a_roe_m: found both waypoint and a_roe_m; accepted: one of them"));
  EXPECT_THAT(message_of(changed(camera_mission(), "[1, -9000, 2, 3, 4, 5]", "[1, -9000]")),
              HasSubstr("decoy.relative.a_roe_m: found an array of 2; accepted: an array of 6 numbers"));
}

TEST(CommandedProfile, KeysAndDefaults) {
  const auto usual = std::get<Commanded>(*mission_with().spacecraft[0].attitude);
  EXPECT_DOUBLE_EQ(usual.control_error, 30.0 / 3600.0 * kDegree);
  EXPECT_EQ(usual.axes.initial_boresight_rtn, fsw::Vector3(0, -1, 0));
  EXPECT_EQ(usual.axes.boresight_body, fsw::Vector3(0, 0, 1));
  EXPECT_EQ(usual.axes.second_body, fsw::Vector3(0, -1, 0));
  const auto told = std::get<Commanded>(*mission_with({"spacecraft.servicer.attitude.control_error_arcsec=12",
                                                       "spacecraft.servicer.attitude.initial_boresight_rtn=[0, 1, 0]",
                                                       "spacecraft.servicer.attitude.boresight_body=[1, 0, 0]",
                                                       "spacecraft.servicer.attitude.secondary_axis_body=[0, 0, 1]"})
                                             .spacecraft[0]
                                             .attitude);
  EXPECT_DOUBLE_EQ(told.control_error, 12.0 / 3600.0 * kDegree);
  EXPECT_EQ(told.axes.initial_boresight_rtn, fsw::Vector3(0, 1, 0));
  EXPECT_EQ(told.axes.boresight_body, fsw::Vector3(1, 0, 0));
  EXPECT_THAT(message_of(camera_mission(), {"spacecraft.servicer.attitude.initial_boresight_rtn=[1, 0, 0]"}),
              HasSubstr("initial_boresight_rtn: found a zero boresight, or one at the zenith or the nadir"));
  EXPECT_THAT(message_of(camera_mission(), {"spacecraft.servicer.attitude.secondary_axis_body=[0, 0, 1]"}),
              HasSubstr("secondary_axis_body: found an axis along the other one"));
}

// Root mean square over a day within 10 % of sigma (cross terms of nearby periods), zero mean, periods as configured.
TEST(CommandedProfile, DrawnErrorHasItsSigma) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const truth::ControlError error = drawn_control_error(seed, "servicer", 1e-4);
    for (const auto& axis : error) {
      double squares = 0.0, sum = 0.0;
      constexpr int kSeconds = 86400;
      for (int t = 0; t < kSeconds; t += 2) {
        double value = 0.0;
        for (const truth::Sinusoid& one : axis) value += one.amplitude * std::sin(one.rate_radps * t + one.phase);
        squares += value * value;
        sum += value;
      }
      EXPECT_NEAR(std::sqrt(2.0 * squares / kSeconds), 1e-4, 1e-5);
      EXPECT_NEAR(2.0 * sum / kSeconds, 0.0, 1e-6);
      for (const truth::Sinusoid& one : axis) {
        EXPECT_GE(2.0 * M_PI / one.rate_radps, 20.0);
        EXPECT_LE(2.0 * M_PI / one.rate_radps, 600.0);
      }
    }
  }
  EXPECT_NE(drawn_control_error(1, "servicer", 1.0)[0][0].phase, drawn_control_error(2, "servicer", 1.0)[0][0].phase);
}

}  // namespace
}  // namespace vbar::mission::test
