#include "host_sim/mission/catalogue.h"

#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/sensors/sensor_kinds.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {
namespace {

class Catalogue : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("vbar_catalogue_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  void write(const std::string& name, std::string_view text) const { std::ofstream(folder_ / name) << text; }

  std::filesystem::path folder_;
};

TEST_F(Catalogue, ListsGoodAndBadMissionsInOrder) {
  write("b.toml", kSmallMission);
  write("a.toml", "[mission]\nduration_h = true\n");
  write("notes.txt", "not a mission");
  const auto entries = list_missions(folder_, sensors::installation());
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_FALSE(entries[0].good);
  EXPECT_EQ(line_of(entries[0], 4), "a     cannot be run: " + (folder_ / "a.toml").string() +
                                        ":2: mission.duration_h: found true; accepted: a number above 0, up to 2000");
  EXPECT_TRUE(entries[1].good);
  EXPECT_EQ(line_of(entries[1], 4), "b        2.00 h  ");
}

TEST_F(Catalogue, MissingFolderIsAnError) {
  EXPECT_THROW(static_cast<void>(list_missions(folder_ / "none", sensors::installation())), MissionError);
}

// Every mission that the project ships can be run.
TEST(ShippedMissions, AllLoad) {
  const auto entries = list_missions(vbar::tests::source_path("missions"), sensors::installation());
  ASSERT_FALSE(entries.empty());
  for (const auto& entry : entries) EXPECT_TRUE(entry.good) << entry.description;
}

// The names are those of the project's own missions.
TEST_F(Catalogue, FindsMissionsByPathAndByName) {
  write("b.toml", kSmallMission);
  EXPECT_EQ(find_mission(folder_ / "b.toml", sensors::installation()), folder_ / "b.toml");
  EXPECT_EQ(find_mission("experiment3", sensors::installation()).filename(), "experiment3.toml");
  for (const char* wrong : {"experiment33", "missions/experment3.toml"}) {
    try {
      static_cast<void>(find_mission(wrong, sensors::installation()));
      ADD_FAILURE() << wrong;
    } catch (const MissionError& error) {
      EXPECT_NE(std::string(error.what()).find("did you mean experiment3?"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace vbar::mission::test
