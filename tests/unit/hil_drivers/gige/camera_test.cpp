// The client against the emulated camera: what the converter gave is what arrives, bit by bit, and the settings hold.

#include "hil_drivers/gige/camera/camera.h"

#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/emulators/gige/running_device.h"

namespace vbar::gige::test {
namespace {

// Settings of a client for an emulated camera, and an image or an exception.

/// Small images and generous time limits.
Camera::Settings settings_for(const RunningDevice& device) {
  Camera::Settings settings;
  settings.address = device.address();
  settings.exposure_s = 0.01;
  settings.region = {64, 32, 200, 100};
  settings.timeout_s = 20.0;
  return settings;
}

Frame taken(Camera& camera) {
  auto result = camera.take();
  if (auto* failure = std::get_if<NoFrame>(&result)) throw std::runtime_error(failure->text);
  return std::get<Frame>(std::move(result));
}

Image picture_of(const Camera& camera, std::int64_t number, int bits = 12) {
  return numbered_picture({camera.settings().region, 0.0, 0.0, 0.0, number}, bits);
}

/// The message of the CameraError, empty without one.
std::string error_of_open(const Camera::Settings& settings) {
  try {
    Camera camera(settings);
    camera.open();
  } catch (const CameraError& error) {
    return error.what();
  }
  return "";
}

}  // namespace
}  // namespace vbar::gige::test

namespace vbar::gige {
namespace {

using test::picture_of;
using test::RunningDevice;
using test::settings_for;
using test::taken;

TEST(GigeCamera, EveryPixelOfMono16Arrives) {
  RunningDevice device;
  Camera::Settings settings = settings_for(device);
  settings.region = {710, 152, 500, 848};
  Camera camera(settings);
  camera.open();
  for (int number = 0; number < 3; ++number) {
    const Frame frame = taken(camera);
    EXPECT_EQ(frame.width, 500);
    EXPECT_EQ(frame.height, 848);
    EXPECT_EQ(frame.bits, 12);
    EXPECT_EQ(frame.dn, picture_of(camera, number).dn) << number;
  }
  EXPECT_EQ(device.statistics().acquisition.exposures, 3);
}

TEST(GigeCamera, EveryPixelOfMono12PackedArrives) {
  RunningDevice device;
  Camera::Settings settings = settings_for(device);
  settings.pixel_format = wire::PixelFormat::kMono12Packed;
  Camera camera(settings);
  camera.open();
  const Frame frame = taken(camera);
  EXPECT_EQ(frame.bits, 12);
  EXPECT_EQ(frame.dn, picture_of(camera, 0).dn);
}

TEST(GigeCamera, WholeSensorArrives) {
  RunningDevice device;
  Camera::Settings settings = settings_for(device);
  settings.region = {0, 0, 1920, 1200};
  Camera camera(settings);
  camera.open();
  EXPECT_EQ(taken(camera).dn, picture_of(camera, 0).dn);
}

TEST(GigeCamera, PaddingOfTenBitsIsFoundInTheData) {
  Device::Settings ten_bits;
  ten_bits.description.converter_bits = 10;
  RunningDevice device(ten_bits, [](const Request& request) { return test::numbered_picture(request, 10); });
  Camera camera(settings_for(device));
  camera.open();
  const Frame frame = taken(camera);
  EXPECT_EQ(frame.bits, 10);
  EXPECT_EQ(frame.dn, picture_of(camera, 0, 10).dn);
}

TEST(GigeCamera, SettingsReachTheExposure) {
  Request seen;
  RunningDevice device({}, [&seen](const Request& request) {
    seen = request;
    return test::numbered_picture(request);
  });
  Camera::Settings settings = settings_for(device);
  settings.exposure_s = 0.2;
  settings.gain_db = 3.0;
  settings.black_level_percent = 3.125;
  Camera camera(settings);
  camera.open();
  (void)taken(camera);
  EXPECT_EQ(seen.region, settings.region);
  EXPECT_DOUBLE_EQ(seen.exposure_s, 0.2);
  EXPECT_DOUBLE_EQ(seen.gain_db, 3.0);
  EXPECT_DOUBLE_EQ(seen.black_level_dn, 128.0);  // 3.125 % of 2^12
  camera.set_exposure(0.05);
  (void)taken(camera);
  EXPECT_DOUBLE_EQ(seen.exposure_s, 0.05);
}

TEST(GigeCamera, ImagesLabelledAsChunkDataAreTakenAsPixels) {
  RunningDevice device;
  Camera camera(settings_for(device));
  camera.open();
  int number = 0;
  for (const auto type : {wire::PayloadType::kChunkData, wire::PayloadType::kExtendedImage}) {
    device.with([type](Device& one) { one.set_payload_type(type); });
    EXPECT_EQ(taken(camera).dn, picture_of(camera, number++).dn) << static_cast<int>(type);
  }
}

TEST(GigeCamera, IdentityNamesTheEmulation) {
  RunningDevice device;
  Camera camera(settings_for(device));
  camera.open();
  const Camera::Identity& identity = camera.identity();
  EXPECT_EQ(identity.vendor, "Point Grey Research");
  EXPECT_EQ(identity.model, "Grasshopper3 GS3-PGE-23S6M");
  EXPECT_EQ(identity.serial, "00000001");
  EXPECT_TRUE(identity.is_emulated()) << identity.manufacturer_info;
}

TEST(GigeCamera, RegionCanBeChanged) {
  RunningDevice device;
  Camera camera(settings_for(device));
  camera.open();
  EXPECT_EQ(taken(camera).dn, picture_of(camera, 0).dn);
  camera.set_region({1600, 1000, 320, 200});
  EXPECT_EQ(taken(camera).dn, picture_of(camera, 1).dn);
}

TEST(GigeCamera, ClosedCameraHasNoOwner) {
  RunningDevice device;
  bool is_owned = false;
  const auto ask = [&] { device.with([&](Device& one) { is_owned = one.is_owned(); }); };
  Camera camera(settings_for(device));
  camera.open();
  ask();
  EXPECT_TRUE(is_owned);
  camera.close();
  ask();
  EXPECT_FALSE(is_owned);
  EXPECT_THROW((void)camera.take(), CameraError);
}

}  // namespace

// What the client does when camera or network fail: an image with every pixel, or one reason.

namespace {

using std::chrono::milliseconds;
using test::error_of_open;
using ::testing::HasSubstr;
using ::testing::StartsWith;

NoFrame::Reason reason_of(const std::variant<Frame, NoFrame>& result) {
  EXPECT_TRUE(std::holds_alternative<NoFrame>(result));
  return std::holds_alternative<NoFrame>(result) ? std::get<NoFrame>(result).reason : NoFrame::Reason::kInvalid;
}

TEST(GigeCameraFaults, LostPacketsAreSentAgain) {
  RunningDevice device;
  Camera::Settings settings = settings_for(device);
  settings.region = {710, 152, 500, 848};
  Camera camera(settings);
  camera.open();
  device.with([](Device& one) { one.set_packet_faults({.loss = 0.01}); });
  std::int64_t resent = 0;
  constexpr int kImages = 10;
  for (int number = 0; number < kImages; ++number) {
    const Frame frame = taken(camera);
    EXPECT_EQ(frame.dn, picture_of(camera, number).dn) << number;
    resent += frame.packets_resent;
  }
  // Of 6,240 packets 62 are lost in the mean; with a standard deviation of 8 never none.
  EXPECT_GT(resent, 0);
  EXPECT_GT(device.statistics().stream.packets_resent, 0);
}

TEST(GigeCameraFaults, DuplicatedAndReorderedPacketsAreHarmless) {
  RunningDevice device;
  Camera camera(settings_for(device));
  camera.open();
  device.with([](Device& one) { one.set_packet_faults({.duplicate = 0.2, .reorder = 0.2}); });
  for (int number = 0; number < 5; ++number) EXPECT_EQ(taken(camera).dn, picture_of(camera, number).dn) << number;
}

TEST(GigeCameraFaults, LateAnswersDoNotTriggerTwice) {
  RunningDevice device;
  Camera camera(settings_for(device));
  camera.open();
  // Aravis repeats a command after 500 ms.
  device.with([](Device& one) { one.set_answer_delay(milliseconds(700)); });
  EXPECT_EQ(taken(camera).dn, picture_of(camera, 0).dn);
  device.with([](Device& one) { one.set_answer_delay(milliseconds(0)); });
  EXPECT_EQ(device.statistics().acquisition.triggers, 1);
}

TEST(GigeCameraFaults, TriggerThatIsIgnoredTimesOut) {
  RunningDevice device;
  Camera::Settings settings = settings_for(device);
  settings.timeout_s = 0.3;
  Camera camera(settings);
  camera.open();
  device.with([](Device& one) { one.ignore_triggers(1); });
  const auto result = camera.take();
  EXPECT_EQ(reason_of(result), NoFrame::Reason::kTimeout);
  EXPECT_THAT(std::get<NoFrame>(result).text, StartsWith("camera " + device.address() + ": no image within 0.3 s"));
}

TEST(GigeCameraFaults, FrameThatIsLostTimesOutAndTheNextOneComes) {
  RunningDevice device;
  Camera::Settings settings = settings_for(device);
  settings.timeout_s = 0.3;
  Camera camera(settings);
  camera.open();
  device.with([](Device& one) { one.lose_frames(1); });
  EXPECT_EQ(reason_of(camera.take()), NoFrame::Reason::kTimeout);
  EXPECT_EQ(taken(camera).dn, picture_of(camera, 1).dn);
  EXPECT_EQ(device.statistics().acquisition.frames_lost, 1);
}

TEST(GigeCameraFaults, FrameOlderThanTheTriggerIsNotAnImage) {
  RunningDevice device;
  Camera::Settings settings = settings_for(device);
  settings.timeout_s = 0.3;
  Camera camera(settings);
  camera.open();
  const Frame first = taken(camera);
  device.with([](Device& one) { one.repeat_frames(1); });
  const auto result = camera.take();
  EXPECT_EQ(reason_of(result), NoFrame::Reason::kStale);
  EXPECT_THAT(std::get<NoFrame>(result).text, HasSubstr("only an image of an exposure before it"));
  EXPECT_EQ(camera.stale_images(), 1);
  const Frame third = taken(camera);
  EXPECT_EQ(third.dn, picture_of(camera, 2).dn);
  EXPECT_GT(third.timestamp_ns, first.timestamp_ns);
}

// Each image comes once more, after the next trigger and before its image: late, doubled and in the wrong order. The
// own time stamp of such an image is later than that of any image accepted before.
TEST(GigeCameraFaults, OfAThousandLateImagesNoneIsAccepted) {
  RunningDevice device;
  Camera camera(settings_for(device));
  camera.open();
  constexpr int kImages = 1001;
  device.with([](Device& one) { one.delay_frames(kImages, false); });
  std::int64_t refused = 0;
  for (int number = 0; number < kImages; ++number) {
    const Frame frame = taken(camera);
    ASSERT_EQ(frame.dn, picture_of(camera, number).dn) << number;
    refused += frame.stale_images;
  }
  EXPECT_EQ(camera.stale_images(), kImages - 1);
  EXPECT_EQ(refused, kImages - 1);
  EXPECT_EQ(device.statistics().acquisition.frames_delayed, kImages);
}

// Nothing but images of the trigger before.
TEST(GigeCameraFaults, ImagesAfterTheNextTriggerAreRefused) {
  RunningDevice device;
  Camera::Settings settings = settings_for(device);
  settings.timeout_s = 0.1;
  Camera camera(settings);
  camera.open();
  device.with([](Device& one) { one.delay_frames(5, true); });
  EXPECT_EQ(reason_of(camera.take()), NoFrame::Reason::kTimeout);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(reason_of(camera.take()), NoFrame::Reason::kStale);
  const Frame frame = taken(camera);
  EXPECT_EQ(frame.dn, picture_of(camera, 5).dn);
  EXPECT_EQ(camera.stale_images(), 5);
  camera.reconnect();
  EXPECT_EQ(camera.stale_images(), 5);
}

TEST(GigeCameraFaults, FrameWithHolesIsNotAnImage) {
  RunningDevice device;
  Camera::Settings settings = settings_for(device);
  settings.timeout_s = 5.0;
  Camera camera(settings);
  camera.open();
  device.with([](Device& one) { one.set_packet_faults({.loss = 0.98}); });
  const auto reason = reason_of(camera.take());
  EXPECT_TRUE(reason == NoFrame::Reason::kIncomplete || reason == NoFrame::Reason::kTimeout);
  device.with([](Device& one) { one.set_packet_faults({}); });
  // The first image whole is that of a later exposure.
  for (int attempt = 0; attempt < 3; ++attempt) {
    const auto result = camera.take();
    if (const auto* frame = std::get_if<Frame>(&result)) {
      EXPECT_EQ(frame->dn, picture_of(camera, device.statistics().acquisition.exposures - 1).dn);
      return;
    }
  }
  FAIL() << "no image after three more attempts";
}

TEST(GigeCameraFaults, CameraOfAnotherOwnerIsRefused) {
  RunningDevice device;
  device.with([](Device& one) { one.set_busy(true); });
  EXPECT_EQ(error_of_open(settings_for(device)), "camera " + device.address() + ": it is owned by another program");
  device.with([](Device& one) { one.set_busy(false); });
  EXPECT_EQ(error_of_open(settings_for(device)), "");
}

TEST(GigeCameraFaults, AnotherCameraIsRefused) {
  RunningDevice device;
  Camera::Settings model = settings_for(device);
  model.model = "Blackfly";
  EXPECT_THAT(error_of_open(model), HasSubstr("it is a \"Grasshopper3 GS3-PGE-23S6M\" of \"Point Grey Research\"; "
                                              "expected \"Blackfly\""));
  Camera::Settings size = settings_for(device);
  size.sensor_width = 2048;
  EXPECT_THAT(error_of_open(size), HasSubstr("its sensor has 1920 x 1200 pixels; expected 2048 x 0"));
  Camera::Settings serial = settings_for(device);
  serial.serial = "7";
  EXPECT_THAT(error_of_open(serial), HasSubstr("its serial number is \"00000001\"; expected \"7\""));
}

TEST(GigeCameraFaults, RefusedSettingsAreNamed) {
  RunningDevice device;
  Camera::Settings odd = settings_for(device);
  odd.region.width = 201;
  EXPECT_THAT(error_of_open(odd), HasSubstr("Width = 201 is refused"));
  Camera::Settings outside = settings_for(device);
  outside.region.x = 1900;
  EXPECT_THAT(error_of_open(outside), HasSubstr("OffsetX = 1900 is refused"));
  Camera::Settings packet = settings_for(device);
  packet.packet_size = 100;
  EXPECT_THAT(error_of_open(packet), HasSubstr("GevSCPSPacketSize = 100 is refused"));
  device.with([](Device& one) { one.refuse_region(true); });
  EXPECT_THAT(error_of_open(settings_for(device)), HasSubstr("OffsetX = 0 is refused"));
}

TEST(GigeCameraFaults, DamagedDescriptionIsRefused) {
  RunningDevice device;
  device.with([](Device& one) { one.damage_xml(true); });
  EXPECT_THAT(error_of_open(settings_for(device)), StartsWith("camera " + device.address() + ": "));
}

TEST(GigeCameraFaults, AbsentCameraIsOneSentence) {
  Camera::Settings settings;
  settings.address = test::free_address();
  EXPECT_EQ(error_of_open(settings), "camera " + settings.address + ": it does not answer");
  settings.address = "camera.local";
  EXPECT_EQ(error_of_open(settings), "camera camera.local: this is not an IPv4 address");
}

TEST(GigeCameraFaults, CameraThatReturnsIsConnectedAgainWithAllSettings) {
  RunningDevice device;
  Camera::Settings settings = settings_for(device);
  settings.timeout_s = 0.3;
  settings.black_level_percent = 3.125;
  Camera camera(settings);
  camera.open();
  (void)taken(camera);
  device.with([](Device& one) { one.set_away(true); });
  const auto reason = reason_of(camera.take());
  EXPECT_TRUE(reason == NoFrame::Reason::kNoAnswer || reason == NoFrame::Reason::kNotOwner);
  device.with([](Device& one) { one.set_away(false); });
  camera.reconnect();
  EXPECT_EQ(taken(camera).dn, picture_of(camera, 1).dn);
}

TEST(GigeCameraFaults, AnotherThreadStopsTheWait) {
  Device::Settings real;
  real.pace = Pace::kReal;
  RunningDevice device(real);
  Camera::Settings settings = settings_for(device);
  settings.exposure_s = 20.0;  // much longer than the test takes
  Camera camera(settings);
  camera.open();
  std::thread stopping([&camera] {
    std::this_thread::sleep_for(milliseconds(50));
    camera.stop();
  });
  EXPECT_EQ(reason_of(camera.take()), NoFrame::Reason::kStopped);
  stopping.join();
  EXPECT_EQ(reason_of(camera.take()), NoFrame::Reason::kStopped);
}

TEST(GigeCameraFaults, SilentOwnerLosesTheCamera) {
  RunningDevice device;
  Camera camera(settings_for(device));
  camera.open();
  device.with([](Device& one) { one.set_away(true); });
  // The heartbeat's time is 3 s.
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  bool is_owned = true;
  while (is_owned && std::chrono::steady_clock::now() < limit) {
    std::this_thread::sleep_for(milliseconds(50));
    device.with([&is_owned](Device& one) { is_owned = one.is_owned(); });
  }
  EXPECT_FALSE(is_owned);
  EXPECT_EQ(device.statistics().owners_expired, 1);
}

}  // namespace

}  // namespace vbar::gige
