// Where the files that a mission names are searched, and what is said of one that is missing.

#include "host_sim/mission/data_file.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/load.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {

namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

/// A folder with a mission, a folder of data and a working directory, each with files of its own.
class DataFiles : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(testing::TempDir()) / ("vbar_data_files_" + std::to_string(::getpid()));
    for (const char* folder : {"missions", "data", "here"}) fs::create_directories(root_ / folder);
    write("missions/m.toml", kSmallMission);
    write("data/of_data.gfc", "x");
    write("missions/beside.gfc", "x");
    write("here/here.gfc", "x");
    before_ = fs::current_path();
    fs::current_path(root_ / "here");
  }
  void TearDown() override {
    fs::current_path(before_);
    fs::remove_all(root_);
  }
  void write(const std::string& name, std::string_view text) const { std::ofstream(root_ / name) << text; }
  [[nodiscard]] Mission with(const std::string& assignment) const {
    return load_mission(root_ / "missions/m.toml", std::vector<std::string>{assignment});
  }
  [[nodiscard]] fs::path gravity(const std::string& value) const {
    return with("truth.gravity_file=" + value).truth.gravity_file;
  }
  [[nodiscard]] std::string missing(const Mission& mission) const {
    try {
      check_data_files(mission, root_ / "data");
    } catch (const MissionError& error) {
      return error.what();
    }
    return "";
  }

  fs::path root_, before_;
};

TEST_F(DataFiles, OnTheCommandLineTheWorkingDirectoryComesFirst) {
  EXPECT_EQ(gravity("here.gfc"), root_ / "here/here.gfc");
  EXPECT_EQ(gravity("./here.gfc"), root_ / "here/here.gfc");
  EXPECT_EQ(gravity("../here/here.gfc"), root_ / "here/here.gfc");
  EXPECT_EQ(gravity("of_data.gfc"), "of_data.gfc");
  EXPECT_EQ(fs::weakly_canonical(gravity("./beside.gfc")), fs::weakly_canonical(root_ / "missions/beside.gfc"));
  write("here/none", "x");
  EXPECT_EQ(with("truth.earth_orientation_file=none").truth.earth_orientation_file, "none") << "a word, not a file";
}

TEST_F(DataFiles, InAMissionFileTheFolderOfDataOrThatOfTheMission) {
  write("missions/m.toml", std::string(kSmallMission) + "[truth]\ngravity_file = \"here.gfc\"\n");
  const Mission mission = load_mission(root_ / "missions/m.toml");
  EXPECT_EQ(mission.truth.gravity_file, "here.gfc");
  EXPECT_EQ(missing(mission),
            (root_ / "missions/m.toml").string() +
                ":30: truth.gravity_file: found \"here.gfc\": " + (root_ / "data/here.gfc").string() +
                ": No such file or directory; accepted: a file of the data folder " + (root_ / "data").string() +
                "; with ./ or ../ before it one seen from the folder " + (root_ / "missions").string() +
                " of the mission file; an absolute path; with --set also one seen from the working directory");
}

TEST_F(DataFiles, EveryKeyThatNamesOneIsChecked) {
  EXPECT_EQ(missing(with("truth.gravity_file=of_data.gfc")), "");
  EXPECT_EQ(missing(load_mission(root_ / "missions/m.toml")), "") << "the defaults are not named";
  for (const char* key : {"truth.gravity_file", "truth.earth_orientation_file", "truth.space_weather_file"})
    EXPECT_THAT(missing(with(std::string(key) + "=/no/such")),
                AllOf(HasSubstr("--set " + std::string(key) + "=/no/such: " + key + ": found \"/no/such\""),
                      HasSubstr("No such file or directory")));
  EXPECT_THAT(missing(with("constellation.navigation_files=[\"of_data.gfc\", \"no.rnx\"]")),
              HasSubstr("constellation.navigation_files: found \"no.rnx\""));
  EXPECT_THAT(missing(with("spacecraft.servicer.orbit_file=no.oem")),
              HasSubstr("servicer.orbit_file: found \"no.oem\""));
  EXPECT_THAT(missing(with("truth.gravity_file=../here")), HasSubstr("Is a directory"));
}

// A run folder keeps its overrides; they must name the same files from any working directory.
TEST_F(DataFiles, OverridesAreKeptWithAbsolutePaths) {
  const auto kept = [&](const std::string& assignment) {
    return with_absolute_files({"mission.seed=3", assignment}, with(assignment)).at(1);
  };
  const std::string here = (root_ / "here/here.gfc").string();
  EXPECT_EQ(kept("truth.gravity_file=here.gfc"), "truth.gravity_file=\"" + here + "\"");
  EXPECT_EQ(kept("constellation.navigation_files=[\"here.gfc\", \"of_data.gfc\"]"),
            "constellation.navigation_files=[\"" + here + "\", \"of_data.gfc\"]");
  for (const char* same : {"truth.gravity_file=of_data.gfc", "truth.gravity_file=/a/b.gfc", "mission.step_s=30"})
    EXPECT_EQ(kept(same), same);
  EXPECT_EQ(with(kept("truth.gravity_file=here.gfc")).truth.gravity_file, here);
}

}  // namespace

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
