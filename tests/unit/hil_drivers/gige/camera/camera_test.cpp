// The client against the emulated camera: what the converter gave is what arrives, bit by bit, and the settings hold.

#include "hil_drivers/gige/camera/camera.h"

#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/gige/camera/camera_client.h"

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
}  // namespace vbar::gige
