// The bodies of the project against the numbers they come from, and body files that are none.

#include "host_sim/mission/body_file.h"

#include <filesystem>
#include <fstream>

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>
#include <unistd.h>

#include "host_sim/mission/mission_error.h"
#include "host_sim/truth/attitude/rigid_body.h"
#include "tests/support/paths.h"

namespace vbar::mission {
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
