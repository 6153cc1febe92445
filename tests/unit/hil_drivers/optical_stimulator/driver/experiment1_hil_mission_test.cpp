// missions/experiment1_hil.toml explains every key of the optical testbed; cameras come from it.

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/optical_stimulator/stimulator_run.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/installed_testbeds.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {
namespace {

using ::testing::HasSubstr;

const std::string kFile = vbar::tests::source_path("missions/experiment1_hil.toml");

TEST(Experiment1HilMission, EveryKeyOfTheTestbedIsExplained) {
  expect_all_shown(text_of_file(kFile), kFile, {"testbed.optical_stimulator"});
}

TEST(Experiment1HilMission, TakesTheImagesOfTheTestbed) {
  const Mission mission = sensors::load_mission(kFile);
  EXPECT_EQ(sensor_of<sensors::CameraSensor>(mission).source, "optical_stimulator");
  ASSERT_NE(testbeds::find_testbed("optical_stimulator"), nullptr);
  const auto& settings =
      dynamic_cast<const optical_stimulator::OpticalStimulatorSettings&>(*mission.testbeds.at(0).settings);
  EXPECT_THAT(settings.bench, HasSubstr("vbar_os_bench"));
  EXPECT_EQ(settings.settle.count(), 0);
}

// The same mission flies with the twin by one key.
TEST(Experiment1HilMission, FliesWithTheTwinByOneKey) {
  const std::vector<std::string> digital = {"spacecraft.servicer.sensors.camera.source=\"digital\""};
  EXPECT_EQ(sensor_of<sensors::CameraSensor>(sensors::load_mission(kFile, digital)).source, "digital");
}

}  // namespace
}  // namespace vbar::mission::test
