// The client against the emulated camera: what the converter gave is what arrives, bit by bit.

#include "hil_drivers/gige/camera/camera.h"

#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/gige/running_device.h"

namespace vbar::gige {
namespace {

using test::numbered_picture;
using test::RunningDevice;
using twins::camera::Region;

Camera::Settings settings_for(const RunningDevice& device) {
  Camera::Settings settings;
  settings.address = device.address();
  settings.exposure_s = 0.01;
  settings.region = {710, 152, 500, 848};
  settings.timeout_s = 20.0;
  return settings;
}

Frame taken(Camera& camera) {
  auto result = camera.take();
  if (auto* failure = std::get_if<NoFrame>(&result)) throw std::runtime_error(failure->text);
  return std::get<Frame>(std::move(result));
}

TEST(GigeCamera, EveryPixelOfMono16Arrives) {
  RunningDevice device;
  Camera camera(settings_for(device));
  camera.open();
  for (int number = 0; number < 3; ++number) {
    const Frame frame = taken(camera);
    EXPECT_EQ(frame.width, 500);
    EXPECT_EQ(frame.height, 848);
    EXPECT_EQ(frame.bits, 12);
    EXPECT_EQ(frame.dn, numbered_picture({camera.settings().region, 0, 0, 0, number}).dn) << number;
  }
}

}  // namespace
}  // namespace vbar::gige
