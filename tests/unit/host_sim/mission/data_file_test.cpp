// Where the files that a mission names are searched, and what is said of one that is missing.

#include "host_sim/mission/data_file.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/body_file.h"
#include "host_sim/mission/load.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/truth/attitude/rigid_body.h"
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

namespace vbar::mission {

// The bodies of the project against the numbers they come from, and body files that are none.

namespace {

using fsw::Matrix3;
using fsw::Vector3;
using testing::HasSubstr;

truth::Body body(const std::string& name) {
  return load_body(std::filesystem::path(vbar::tests::source_path("data/bodies")) / (name + ".toml"));
}

TEST(Bodies, TangoHasThePublishedPrincipalMoments) {
  // Published research code on PRISMA: principal moments, and the keypoint frame's place and turn in the principal
  // frame. Moments to the digits printed.
  const truth::Body tango = body("tango");
  EXPECT_NO_THROW(truth::check_inertia(tango.inertia_kgm2));
  const Vector3 moments = Eigen::SelfAdjointEigenSolver<Matrix3>(tango.inertia_kgm2).eigenvalues();
  EXPECT_LT((moments - Vector3(2.685703125, 3.106463735035312, 3.458072723298021)).norm(), 1e-13);

  // The quaternion, scalar first, as a transformation of components to body axes from principal axes: about x only.
  const double w = -0.187867580617481, x = 0.982194365771324;
  Matrix3 R_body_principal = Matrix3::Identity();
  R_body_principal(1, 1) = R_body_principal(2, 2) = w * w - x * x;
  R_body_principal(1, 2) = 2.0 * w * x;
  R_body_principal(2, 1) = -2.0 * w * x;
  const Matrix3 principal = Vector3(2.685703125, 3.458072723298021, 3.106463735035312).asDiagonal();
  EXPECT_LT((R_body_principal * principal * R_body_principal.transpose() - tango.inertia_kgm2).norm(), 1e-13);
  const Vector3 origin_principal(0.0, -0.041845452916084, 0.156390637826117);
  EXPECT_LT((R_body_principal * -origin_principal - tango.centre_of_mass_m).norm(), 1e-14);
  // What speaks for reading it so: the centre of mass lies at half height.
  EXPECT_NEAR(tango.centre_of_mass_m.z(), 0.5 * 0.3215, 1e-3);
}

TEST(Bodies, TangosSurfaceIsClosed) {
  const truth::Body tango = body("tango");
  ASSERT_EQ(tango.facets.size(), 6U);
  Vector3 sum = Vector3::Zero();
  double volume = 0.0;
  for (const truth::Facet& facet : tango.facets) {
    sum += facet.area_m2 * facet.normal;
    volume += facet.area_m2 * facet.normal.dot(facet.centre_m) / 3.0;
    EXPECT_GT(facet.normal.dot(facet.centre_m), 0.0) << "outwards, seen from the centre of mass";
  }
  EXPECT_LT(sum.norm(), 1e-15);
  // A prism along x with a trapezoid of sides 0.770 m and 0.568 m, 0.3215 m apart.
  EXPECT_NEAR(volume, 0.74 * 0.3215 * 0.5 * (0.77 + 0.568), 1e-15);
}

TEST(Bodies, MangoIsABody) {
  const truth::Body mango = body("mango");
  EXPECT_NO_THROW(truth::check_inertia(mango.inertia_kgm2));
  EXPECT_TRUE(mango.facets.empty());
}

class BodyFile : public testing::Test {
 protected:
  BodyFile() : file_(std::filesystem::temp_directory_path() / ("vbar_body_" + std::to_string(getpid()) + ".toml")) {}
  ~BodyFile() override { std::filesystem::remove(file_); }

  [[nodiscard]] std::string message_of(const std::string& text) const {
    std::ofstream(file_) << text;
    try {
      static_cast<void>(load_body(file_));
    } catch (const MissionError& error) {
      return error.what();
    }
    return "no error";
  }

  std::filesystem::path file_;
};

const std::string kPlate =
    "inertia_kgm2 = [1, 1, 1]\ncentre_of_mass_m = [0, 0, 1]\ncorners = [{at_m = [0, 0, 0]}, {at_m = [2, 0, 0]}, {at_m "
    "= "
    "[2, 2, 0]}]\n";

TEST_F(BodyFile, FacetsAreSeenFromTheCentreOfMass) {
  EXPECT_EQ(message_of(kPlate + "[[facet]]\ncorners = [0, 1, 2]\nspecular = 0.5\ndiffuse = 0.25\n"), "no error");
  const truth::Body plate = load_body(file_);
  ASSERT_EQ(plate.facets.size(), 1U);
  EXPECT_LT((plate.facets[0].centre_m - Vector3(4.0 / 3.0, 2.0 / 3.0, -1.0)).norm(), 1e-15);
}

TEST_F(BodyFile, KeypointsAreDistinct) {
  const std::string two = "keypoints = [{at_m = [0, 0, 0]}, {at_m = [1, 0, 0]}]\n";
  EXPECT_EQ(message_of(two + kPlate), "no error");
  EXPECT_EQ(load_keypoints(file_, 2)[1], Vector3::UnitX());
  EXPECT_THROW(static_cast<void>(load_keypoints(file_, 11)), MissionError);
  EXPECT_THAT(
      message_of("keypoints = [{at_m = [0, 0, 0]}, {at_m = [0.0005, 0, 0]}]\n" + kPlate),
      HasSubstr("keypoints.1.at_m: found the place of keypoint 0; accepted: keypoints at least a millimetre apart"));
}

TEST_F(BodyFile, StatesUnitAxesAndOriginOfItsCadFile) {
  EXPECT_EQ(message_of(
                kPlate +
                "[cad]\nfile = \"shape.stl\"\nunit_m = 0.001\naxes = [\"+x\", \"-z\", \"+y\"]\norigin_m = [0.1, 0, 0]\n"
                "surface = { diffuse = 0.3, specular = 0.2, exponent = 50 }\n"),
            "no error");
  EXPECT_THAT(message_of(kPlate + "[cad]\nunit_m = 1\n"), HasSubstr("cad.file: found nothing"));
  EXPECT_THAT(
      message_of(kPlate + "[cad]\nfile = \"a\"\nmaterials = \"surface\"\n"),
      HasSubstr("cad.materials: found the text \"surface\"; accepted: file or scaled, as cad.surface is missing"));
  EXPECT_THAT(message_of(kPlate + "[cad]\nfile = \"a\"\nmaterials = \"grey\"\n"), HasSubstr("file, scaled or surface"));
  EXPECT_THAT(message_of(kPlate + "[cad]\nfile = \"a\"\nunit_m = 0\n"), HasSubstr("cad.unit_m: found"));
  EXPECT_THAT(message_of(kPlate + "[cad]\nfile = \"a\"\naxes = [\"x\", \"y\", \"z\"]\n"),
              HasSubstr("cad.axes: found \"x\""));
  EXPECT_THAT(message_of(kPlate + "[cad]\nfile = \"a\"\naxes = [\"+x\", \"+y\"]\n"),
              HasSubstr("cad.axes: found 2 of them"));
  EXPECT_THAT(message_of(kPlate + "[cad]\nfile = \"a\"\naxes = [\"+x\", \"+z\", \"+y\"]\n"),
              HasSubstr("not right-handed"));
  EXPECT_THAT(message_of(kPlate + "[cad]\nfile = \"a\"\naxes = [\"+x\", \"+x\", \"+y\"]\n"),
              HasSubstr("not right-handed"));
}

// Beside the body file; without [cad] in the folder of models.
TEST(CadSources, OfTheBodyFileOrOfTheFolderOfModels) {
  const std::filesystem::path data = vbar::tests::source_path("data");
  EXPECT_EQ(cad_source_of(data, "tango").file, data / "models/tango.obj");
  EXPECT_TRUE(std::filesystem::equivalent(cad_source_of(data, "winged_box").file, data / "models/winged_box.obj"));
  EXPECT_EQ(cad_source_of(data, "tango_mockup").file, data / "models/tango_mockup.obj")
      << "a model without a body file";
}

TEST_F(BodyFile, WhatIsNoneIsRefusedWithOneMessage) {
  EXPECT_THAT(message_of("centre_of_mass_m = [0, 0, 0]\n"), HasSubstr("inertia_kgm2: found nothing"));
  EXPECT_THAT(message_of("inertia_kgm2 = [1, 1, 1]\n"), HasSubstr("centre_of_mass_m: found nothing"));
  EXPECT_THAT(message_of("inertia_kgm2 = [1, 1, 3]\n"), HasSubstr("sum of the other two"));
  EXPECT_THAT(message_of(kPlate + "mass_kg = 3\n"), HasSubstr("mass_kg: found an unknown key"));
  EXPECT_THAT(message_of(kPlate + "[[facet]]\ncorners = [0, 1, 3]\nspecular = 0\ndiffuse = 0\n"),
              HasSubstr("facet.0.corners[2]: found the integer 3; accepted: a number from 0 to 2"));
  EXPECT_THAT(message_of(kPlate + "[[facet]]\ncorners = [0, 1.5, 2]\nspecular = 0\ndiffuse = 0\n"),
              HasSubstr("facet.0.corners: found a number that is not an integer"));
  EXPECT_THAT(message_of(kPlate + "[[facet]]\ncorners = [0, 1, 2]\nspecular = 0.7\ndiffuse = 0.7\n"),
              HasSubstr("facet.0: found an invalid facet"));
  EXPECT_THAT(message_of(kPlate + "[[facet]]\ncorners = [0, 1, 1]\nspecular = 0\ndiffuse = 0\n"),
              HasSubstr("facet.0: found an invalid facet: a facet has no area; accepted: "));
  EXPECT_THAT(message_of("inertia_kgm2 = ["), HasSubstr("invalid TOML"));
  std::filesystem::remove(file_);
  EXPECT_THROW(static_cast<void>(load_body(file_)), MissionError);
}

}  // namespace

}  // namespace vbar::mission
