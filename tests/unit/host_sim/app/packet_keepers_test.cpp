// What a run's log keeps of a camera's images.

#include "host_sim/app/packet_keepers.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/report/run_folder.h"
#include "host_sim/twins/camera/image_maker.h"
#include "host_sim/twins/camera/image_recipe.h"
#include "host_sim/twins/packet_log.h"

namespace vbar::app {
namespace {

class ImagesInTheLog : public testing::TestWithParam<mission::ImagesInLog> {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("vbar_keepers_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

TEST_P(ImagesInTheLog, AreWhatTheMissionAsksFor) {
  twins::camera::ImageMaker::Settings settings;
  settings.camera.region = {0, 0, 100, 50};  // 5000 pixels: 6 tiles
  settings.spacecraft = 1;
  twins::camera::ImageMaker maker(settings, [](const twins::camera::Exposure&, twins::camera::PhotonImage&) {});
  const twins::camera::ImageRecipe recipe{1, 0, {}};
  const std::vector<twins::Packet> tiles = maker.packets_of(recipe.exposure);
  ASSERT_EQ(tiles.size(), 6U);

  mission::Mission mission;
  mission.record.images = GetParam();
  {
    const PacketKeepers keepers(mission, folder_);
    for (RunObserver* observer : keepers.observers()) {
      observer->on_recipe({0}, twins::LoggedImage{{1, 0, 0}, twins::camera::bytes_of(recipe)});
      observer->on_step(0, {0}, tiles, {});
    }
  }
  const twins::PacketLog log = twins::read_packet_log(report::packet_log_file(folder_));
  if (GetParam() == mission::ImagesInLog::kTiles) {
    EXPECT_TRUE(log.recipes.empty());
    ASSERT_EQ(log.records.size(), 6U);
    EXPECT_EQ(log.records[5].packet, tiles[5]);
  } else {
    ASSERT_EQ(log.recipes.size(), 1U);
    ASSERT_EQ(log.records.size(), 1U) << "held back to the end of the step and no longer";
    EXPECT_EQ(log.records[0].tiles->tiles, 6);
  }
}

INSTANTIATE_TEST_SUITE_P(Both, ImagesInTheLog,
                         testing::Values(mission::ImagesInLog::kRecipes, mission::ImagesInLog::kTiles));

}  // namespace
}  // namespace vbar::app
