// The digital camera as a packet source, with a renderer made for the test: what it hands to the renderer is what the
// truth says, and its packets are the image.

#include "host_sim/twins/camera/camera_sensor.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <future>
#include <thread>

#include <gtest/gtest.h>

#include "fsw/packets/messages.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/twins/camera/logged_image.h"
#include "host_sim/twins/packet_encoder.h"

namespace vbar::twins::camera {
namespace {

using fsw::Vector3;

const fsw::GpsTime kStart = truth::gps_from_utc("2011-07-18T01:00:00Z");
const fsw::Duration kPeriod = fsw::duration_of_seconds(60);

/// A servicer over the equator that flies towards +y, a target 1 km before it, another spacecraft without an attitude.
TruthSnapshot snapshot(fsw::GpsTime time) {
  TruthSnapshot truth;
  truth.time = time;
  truth.spacecraft.resize(3);
  truth.spacecraft[0].name = "servicer";
  truth.spacecraft[0].orbit = {{7078e3, 0.0, 0.0}, {0.0, 7500.0, 0.0}};
  // Body axes: x along +y of ECI, y along -x, z along z: a turn of 90 degrees about z.
  truth.spacecraft[0].attitude =
      truth::AttitudeState{Eigen::Quaterniond(Eigen::AngleAxisd(-EIGEN_PI / 2, Vector3::UnitZ())), {0.0, 0.0, 1e-3}};
  truth.spacecraft[1].name = "target";
  truth.spacecraft[1].orbit = {{7078e3, 1000.0, 0.0}, {-1.0, 7500.0, 0.0}};
  truth.spacecraft[1].attitude = truth::AttitudeState{Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), Vector3::Zero()};
  truth.spacecraft[2].name = "debris";
  return truth;
}

CameraSensor::Settings small_camera() {
  CameraSensor::Settings settings;
  settings.image.camera.region = {100, 50, 40, 30};
  settings.image.name = "servicer/camera";
  settings.image.seed = 7;
  settings.image.spacecraft = 1;
  settings.image.unit = 2;
  settings.mount.spacecraft = "servicer";
  settings.mount.models = {{"servicer", "mango"}, {"target", "tango"}, {"debris", "tango"}, {"nobody", "tango"}};
  settings.images = {kStart - kPeriod, kPeriod};
  settings.readout = fsw::duration_of_seconds(2);
  return settings;
}

/// One bright pixel, moving with the number of the exposure.
void one_pixel(const Exposure& exposure, PhotonImage& image) {
  image.at(110 + static_cast<int>(exposure.number), 60) = 8000.0F;
}

TEST(CameraSensor, MeasuresEveryPeriod) {
  const CameraSensor sensor(small_camera(), one_pixel);
  EXPECT_EQ(sensor.next_epoch({0}), kStart);
  EXPECT_EQ(sensor.next_epoch(kStart + fsw::Duration{1}), kStart + kPeriod);
}

TEST(CameraSensor, TakesItsLastImageByTheEndOfItsUse) {
  CameraSensor::Settings settings = small_camera();
  settings.until = kStart + kPeriod;
  const CameraSensor sensor(settings, one_pixel);
  EXPECT_EQ(sensor.next_epoch(kStart + fsw::Duration{1}), kStart + kPeriod);
  EXPECT_EQ(sensor.next_epoch(kStart + kPeriod + fsw::Duration{1}), std::nullopt);
}

TEST(CameraSensor, PacketsAreTheImage) {
  CameraSensor sensor(small_camera(), one_pixel);
  const fsw::GpsTime time = kStart + kPeriod + kPeriod;
  Measurement measurement = sensor.measure(snapshot(time));
  ASSERT_EQ(measurement.status, MeasurementStatus::kReady) << measurement.reason;
  EXPECT_TRUE(measurement.packets.empty());
  EXPECT_EQ(measurement.available, time + fsw::duration_of_seconds(2));
  const std::vector<Packet> packets = measurement.pending.get().packets;
  ASSERT_EQ(packets.size(), 2U) << "1200 pixels, 868 a tile";
  const auto view = fsw::packets::parse_packet(packets[0]);
  ASSERT_TRUE(view.ok());
  EXPECT_EQ(view.value().header.time, time);
  EXPECT_EQ(view.value().header.spacecraft, 1);
  EXPECT_EQ(view.value().header.unit, 2);
  EXPECT_EQ(view.value().header.sequence_count, 4) << "two images of two tiles came before";
  const auto tile = fsw::packets::decode<image_tile>(view.value());
  ASSERT_TRUE(tile.ok());
  EXPECT_EQ(tile.value().image, 2);
  EXPECT_EQ(tile.value().tiles, 2);
  EXPECT_EQ(tile.value().width, 40);
  EXPECT_EQ(tile.value().height, 30);
  EXPECT_EQ(tile.value().origin_x, 100);
  EXPECT_EQ(tile.value().origin_y, 50);
  EXPECT_EQ(tile.value().pixels, 868);
  // Pixel (112, 60): the 412th, so the first of a pair. 8000 electrons at 1/8 above 64 are 1064, noise some 11.
  const std::uint8_t* pair = tile.value().data + 412 / 2 * 3;
  EXPECT_NEAR(pair[0] << 4 | pair[1] >> 4, 1064, 60);
  EXPECT_NEAR((pair[1] & 0xF) << 8 | pair[2], 64, 6) << "its neighbour is dark";
}

/// The command of an exposure to a camera, as the flight software sends it.
Packet exposure_packet(std::uint8_t unit, double exposure_s) {
  return *PacketEncoder(1, unit).encode(kStart, exposure_command{.exposure_s = exposure_s});
}

double exposure_of_image_at(CameraSensor& sensor, fsw::GpsTime time) {
  const Measurement measurement = sensor.measure(snapshot(time));
  return recipe_of(measurement.recipe->bytes)->exposure.duration_s.value_or(-1.0);
}

TEST(CameraSensor, TakesTheExposureCommandedFromItsTimeOn) {
  CameraSensor::Settings settings = small_camera();
  settings.first_exposure_s = 0.2;
  CameraSensor sensor(settings, one_pixel);
  const Packet shorter = exposure_packet(2, 1e-5), of_another = exposure_packet(1, 0.5), none = exposure_packet(2, 0.0);
  sensor.command(fsw::packets::parse_packet(shorter).value(), kStart + kPeriod);
  sensor.command(fsw::packets::parse_packet(of_another).value(), kStart);
  sensor.command(fsw::packets::parse_packet(none).value(), kStart);
  EXPECT_EQ(exposure_of_image_at(sensor, kStart), 0.2) << "not in effect yet";
  EXPECT_EQ(exposure_of_image_at(sensor, kStart + kPeriod), 1e-5);
}

TEST(CameraSensor, OneWithAFixedExposureTakesNoCommand) {
  CameraSensor sensor(small_camera(), one_pixel);
  const Packet shorter = exposure_packet(2, 1e-5);
  sensor.command(fsw::packets::parse_packet(shorter).value(), kStart);
  EXPECT_EQ(exposure_of_image_at(sensor, kStart), -1.0) << "that of the settings";
}

TEST(CameraSensor, TilesStateTheExposure) {
  CameraSensor::Settings settings = small_camera();
  settings.first_exposure_s = 0.125;
  CameraSensor sensor(settings, one_pixel);
  const std::vector<Packet> packets = sensor.measure(snapshot(kStart)).pending.get().packets;
  const auto tile = fsw::packets::decode<image_tile>(fsw::packets::parse_packet(packets[0]).value());
  EXPECT_EQ(tile.value().exposure_s, 0.125F);
}

TEST(CameraSensor, ExposureIsTheTruth) {
  CameraSensor::Settings settings = small_camera();
  // The camera looks along body x: its z is body x, its x is body -y, its y is body -z.
  Eigen::Matrix3d R_camera_body;
  R_camera_body << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  ASSERT_NEAR(R_camera_body.determinant(), 1.0, 1e-15);
  settings.mount.q_camera_body = Eigen::Quaterniond(R_camera_body);
  settings.mount.position_body = {0.5, 0.0, 0.1};
  const Exposure exposure = exposure_of_truth(settings.mount, snapshot(kStart), 3);
  EXPECT_EQ(exposure.number, 3);
  // Body x is +y of ECI, which the camera sees in its centre.
  EXPECT_LT((exposure.q_camera_eci * Vector3::UnitY() - Vector3::UnitZ()).norm(), 1e-15);
  EXPECT_LT((exposure.rate_camera - Vector3(0.0, -1e-3, 0.0)).norm(), 1e-18) << "the turn about body z";
  EXPECT_LT((exposure.camera_position_eci - Vector3(7078e3, 0.5, 0.1)).norm(), 1e-8);
  // 0.5 m along +y turning about z at 1 mrad/s moves towards -x.
  EXPECT_LT((exposure.camera_velocity_eci - Vector3(-0.5e-3, 7500.0, 0.0)).norm(), 1e-11);
  ASSERT_EQ(exposure.objects.size(), 1U) << "not the camera's own spacecraft, none without an attitude, no stranger";
  const ObjectInView& target = exposure.objects[0];
  EXPECT_EQ(target.name, "target");
  EXPECT_EQ(target.model, "tango");
  EXPECT_LT((target.position_eci - Vector3(0.0, 999.5, -0.1)).norm(), 1e-8);
  EXPECT_LT((target.velocity_eci - Vector3(-1.0 + 0.5e-3, 0.0, 0.0)).norm(), 1e-11);
  EXPECT_EQ(target.q_body_eci.coeffs(), Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5).coeffs());
}

// Figures of the Astronomical Almanac's low-precision formulas for 2011-07-18 01:00: the Sun's longitude 114.9 deg at
// 1.0163 au; the Earth's speed is near its least, 29.3 km/s, and at right angles to the Sun within the eccentricity's 1
// degree.
TEST(CameraSensor, SunMoonAndEarthAreOfTheDate) {
  const Exposure exposure = exposure_of_truth(small_camera().mount, snapshot(kStart), 0);
  const double obliquity = 23.4393 * EIGEN_PI / 180.0;
  const double longitude = 114.9 * EIGEN_PI / 180.0;
  const Vector3 sun(std::cos(longitude), std::sin(longitude) * std::cos(obliquity),
                    std::sin(longitude) * std::sin(obliquity));
  EXPECT_LT(std::acos(exposure.sun_eci.normalized().dot(sun)), 0.3 * EIGEN_PI / 180.0);
  EXPECT_NEAR(exposure.sun_eci.norm() / 149597870700.0, 1.0163, 5e-4);
  EXPECT_NEAR(exposure.moon_eci.norm(), 384400e3, 25e6);
  EXPECT_NEAR(exposure.earth_velocity_bcrs.norm(), 29300.0, 60.0);
  EXPECT_NEAR(exposure.earth_velocity_bcrs.normalized().dot(exposure.sun_eci.normalized()), 0.0, 0.02);
  // The Earth runs a quarter turn ahead of where the Sun is seen from it, retrograde to it: Sun x velocity points
  // north.
  EXPECT_LT(exposure.sun_eci.cross(exposure.earth_velocity_bcrs).z(), 0.0);
  // 4215 days and 13 hours; TT is a minute ahead of UTC.
  EXPECT_NEAR(exposure.years_since_j2000, (4215.0 + 13.0 / 24.0) / 365.25, 1e-5);
}

TEST(CameraSensor, TargetBehindTheEarthIsDark) {
  TruthSnapshot truth = snapshot(kStart);
  const Vector3 sun = exposure_of_truth(small_camera().mount, truth, 0).sun_eci.normalized();
  truth.spacecraft[1].orbit.position_eci = 7078e3 * sun;
  EXPECT_EQ(exposure_of_truth(small_camera().mount, truth, 0).objects.at(0).sunlit, 1.0);
  truth.spacecraft[1].orbit.position_eci = -7078e3 * sun;
  EXPECT_EQ(exposure_of_truth(small_camera().mount, truth, 0).objects.at(0).sunlit, 0.0);
  // Seen from the edge of a sphere's shadow half of the Sun is left; the ellipsoid moves the edge by up to 21 km, a
  // penumbra is some 33 km wide here, so this only says that it is neither all nor nothing somewhere about there.
  const Vector3 across = sun.unitOrthogonal();
  bool partly = false;
  for (double height = 6350e3; height < 6390e3; height += 2e3) {
    truth.spacecraft[1].orbit.position_eci = height * across - std::sqrt(7078e3 * 7078e3 - height * height) * sun;
    const double sunlit = exposure_of_truth(small_camera().mount, truth, 0).objects.at(0).sunlit;
    partly = partly || (sunlit > 0.05 && sunlit < 0.95);
  }
  EXPECT_TRUE(partly);
}

TEST(CameraSensor, ImageIsMadeWhileTheSimulationGoesOnAndOneAfterTheOther) {
  std::promise<void> go;
  const std::shared_future<void> gate = go.get_future().share();
  std::vector<std::thread::id> threads;
  std::vector<std::int64_t> numbers;
  CameraSensor sensor(small_camera(), [&](const Exposure& exposure, PhotonImage&) {
    gate.wait();
    threads.push_back(std::this_thread::get_id());
    numbers.push_back(exposure.number);
  });
  Measurement first = sensor.measure(snapshot(kStart));
  Measurement second = sensor.measure(snapshot(kStart + kPeriod));
  go.set_value();
  EXPECT_EQ(second.pending.get().packets.size(), 2U);
  EXPECT_EQ(first.pending.get().packets.size(), 2U);
  EXPECT_EQ(numbers, (std::vector<std::int64_t>{0, 1}));
  EXPECT_EQ(threads[0], threads[1]) << "an OpenGL context lives on one thread";
  EXPECT_NE(threads[0], std::this_thread::get_id());
  const auto statistics = sensor.statistics();
  const auto images = std::ranges::find(statistics, "images", &Note::name);
  ASSERT_NE(images, statistics.end());
  EXPECT_EQ(images->value, 2.0);
}

TEST(CameraSensor, SensorThatGoesAwayBreaksNoFuture) {
  std::future<Completion> pending;
  {
    CameraSensor sensor(small_camera(), one_pixel);
    pending = sensor.measure(snapshot(kStart)).pending;
  }
  try {
    EXPECT_EQ(pending.get().packets.size(), 2U);
  } catch (const std::future_error& error) {
    EXPECT_EQ(error.code(), std::future_errc::broken_promise);  // it had not been begun
  }
}

TEST(CameraSensor, RendererThatFailsIsHeard) {
  CameraSensor sensor(small_camera(), [](const Exposure&, PhotonImage&) { throw std::runtime_error("no context"); });
  Measurement measurement = sensor.measure(snapshot(kStart));
  EXPECT_THROW(measurement.pending.get(), std::runtime_error);
}

/// An optical bench, as a test has it.
class Bench final : public ImageTaker {
 public:
  void start(fsw::GpsTime) override { ++started; }
  void stop(StopReason) override { ++stopped; }
  TakenImage take(const Exposure& exposure) override {
    if (exposure.number == 1) return {{}, {{"retries", 3.0}}, "the frame was lost"};
    return {std::vector<std::uint16_t>(1200, 7), {{"pose_error_m", 0.001}}};
  }
  std::vector<Note> statistics() const override { return {{"moves", 12.0}}; }
  int started = 0, stopped = 0;
};

TEST(CameraSensor, BenchTakesTheImagesInTheRenderersPlace) {
  auto owned = std::make_unique<Bench>();
  Bench& bench = *owned;
  CameraSensor sensor(small_camera(), std::move(owned));
  sensor.start(kStart);
  Measurement first = sensor.measure(snapshot(kStart));
  ASSERT_TRUE(first.recipe) << "the digital twin can make an image of the same exposure";
  EXPECT_FALSE(first.recording) << "it is not yet taken";
  const Completion image = first.pending.get();
  EXPECT_EQ(image.packets.size(), 2U);
  ASSERT_TRUE(image.recording) << "it cannot be made again: the log keeps its pixels";
  EXPECT_EQ(image.recording->key, (ImageKey{1, 2, 0}));
  EXPECT_EQ(pixels_of_recorded_image(image.recording->bytes), std::vector<std::uint16_t>(1200, 7));
  EXPECT_EQ(image.notes.at(0).name, "pose_error_m");
  const Completion lost = sensor.measure(snapshot(kStart + kPeriod)).pending.get();
  EXPECT_TRUE(lost.packets.empty());
  EXPECT_FALSE(lost.recording);
  EXPECT_EQ(lost.failure, "the frame was lost");
  EXPECT_EQ(lost.notes.at(0).value, 3.0);
  sensor.stop(StopReason::kCompleted);
  EXPECT_EQ(bench.started, 1);
  EXPECT_EQ(bench.stopped, 1);
  EXPECT_EQ(sensor.statistics().at(0).name, "moves");
}

/// A bench that uses its devices for a while after it has been stopped.
class SlowBench final : public ImageTaker {
 public:
  void stop(StopReason) override { is_stopped = true; }
  TakenImage take(const Exposure&) override {
    uses_devices = true;
    while (!is_stopped) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    uses_devices = false;
    return {std::vector<std::uint16_t>(1200, 7)};
  }
  std::atomic<bool> is_stopped{false}, uses_devices{false};
};

TEST(CameraSensor, StoppedItLeavesTheDevicesOfABenchToOthers) {
  auto owned = std::make_unique<SlowBench>();
  SlowBench& bench = *owned;
  CameraSensor sensor(small_camera(), std::move(owned));
  Measurement taken = sensor.measure(snapshot(kStart));
  Measurement waiting = sensor.measure(snapshot(kStart + kPeriod));
  while (!bench.uses_devices) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  sensor.stop(StopReason::kInterrupted);
  EXPECT_FALSE(bench.uses_devices);
  EXPECT_EQ(taken.pending.get().packets.size(), 2U);
  EXPECT_THROW(waiting.pending.get(), std::future_error) << "it had not been begun";
  EXPECT_THROW(sensor.measure(snapshot(kStart + kPeriod + kPeriod)).pending.get(), std::future_error);
}

TEST(CameraSensor, TruthThatLacksTheSpacecraftFails) {
  CameraSensor sensor(small_camera(), one_pixel);
  TruthSnapshot truth = snapshot(kStart);
  truth.spacecraft[0].attitude.reset();
  const Measurement without_attitude = sensor.measure(truth);
  EXPECT_EQ(without_attitude.status, MeasurementStatus::kFailed);
  EXPECT_EQ(without_attitude.reason, "camera: \"servicer\" has no attitude");
  EXPECT_FALSE(without_attitude.pending.valid());
  truth.spacecraft.clear();
  EXPECT_EQ(sensor.measure(truth).reason, "camera: no spacecraft \"servicer\"");
}

TEST(CameraSensor, MoreModelsThanARecipeHoldsAreRefused) {
  CameraSensor::Settings settings = small_camera();
  for (int k = 0; k < 9; ++k) settings.mount.models.push_back({"decoy" + std::to_string(k), "tango"});
  EXPECT_THROW(CameraSensor(settings, one_pixel), std::invalid_argument);
  settings.mount.models = {{std::string(64, 'x'), "tango"}};
  EXPECT_THROW(CameraSensor(settings, one_pixel), std::invalid_argument);
}

TEST(CameraSensor, RecipeMakesTheSamePackets) {
  CameraSensor sensor(small_camera(), one_pixel);
  Measurement measurement = sensor.measure(snapshot(kStart + kPeriod));
  ASSERT_TRUE(measurement.recipe);
  EXPECT_EQ(measurement.recipe->key, (ImageKey{1, 2, 1}));
  const auto recipe = recipe_of(measurement.recipe->bytes);
  ASSERT_TRUE(recipe);
  EXPECT_EQ(recipe->spacecraft, 1);
  EXPECT_EQ(recipe->unit, 2);
  ImageMaker maker(small_camera().image, one_pixel);
  static_cast<void>(maker.packets_of({}));  // another image before it changes nothing
  const Completion image = measurement.pending.get();
  EXPECT_EQ(maker.packets_of(recipe->exposure), image.packets);
  EXPECT_FALSE(image.recording) << "the recipe is enough";
}

TEST(CameraSensor, ImagesThatAreNotSentAreRecordedOnly) {
  CameraSensor::Settings settings = small_camera();
  settings.sends_packets = false;
  CameraSensor digital(settings, one_pixel);
  const Measurement recipe_only = digital.measure(snapshot(kStart));
  EXPECT_TRUE(recipe_only.recipe);
  EXPECT_FALSE(recipe_only.pending.valid()) << "nobody needs its pixels";
  EXPECT_FALSE(digital.truth_is_compared());
  CameraSensor bench(settings, std::make_unique<Bench>());
  const Completion image = bench.measure(snapshot(kStart)).pending.get();
  EXPECT_TRUE(image.packets.empty());
  EXPECT_TRUE(image.recording);
}

}  // namespace
}  // namespace vbar::twins::camera
