// CAD files that are none, and what is said of them; Tango's against its keypoints.

#include "host_sim/twins/camera/model/cad_model.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include "tests/support/figures.h"
#include "tests/support/paths.h"

namespace vbar::twins::camera {
namespace {

using fsw::Vector3;
using testing::AllOf;
using testing::HasSubstr;

// A folder of its own for files that a test makes.
class CadFiles : public testing::Test {
 protected:
  CadFiles()
      : folder_(std::filesystem::temp_directory_path() /
                ("vbar_cad_" + std::to_string(getpid()) + "_" +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::create_directories(folder_);
    write("white.mtl", "newmtl white\nKd 0.8 0.8 0.8\nKs 0.1 0.1 0.1\nNs 20\n");
  }
  ~CadFiles() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  // What is said of an OBJ file with this text; it must name the file.
  std::string complaint(const std::string& text) const {
    const std::filesystem::path file = write("body.obj", text);
    try {
      const CadModel model = load_cad_model(file);
      return "no complaint, " + std::to_string(model.triangles.size()) + " triangles";
    } catch (const std::runtime_error& error) {
      const std::string what = error.what();
      return what.find(folder_.string()) == 0 ? what : "the file is not named: " + what;
    }
  }

  std::filesystem::path folder_;
};

const std::string kCorners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
const std::string kFaces = "f 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n";

TEST_F(CadFiles, AGoodFileIsRead) {
  const CadModel model = load_cad_model(write("body.obj", "mtllib white.mtl\n" + kCorners + "usemtl white\n" + kFaces));
  ASSERT_EQ(model.triangles.size(), 4U);
  ASSERT_EQ(model.materials.size(), 1U);
  EXPECT_EQ(model.materials[0].name, "white");
  EXPECT_NEAR(model.materials[0].grey_diffuse(), 0.8, 1e-6);
  EXPECT_NEAR(model.materials[0].grey_specular(), 0.1, 1e-6);
  EXPECT_NEAR(model.materials[0].exponent, 20.0, 1e-6);
  EXPECT_NEAR(std::abs(model.triangles[0].normals[0].z()), 1.0, 1e-12) << "the file has no normals: those of the faces";
  for (const Vector3& corner : {Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)})
    EXPECT_LT((corner - model.centre).norm(), model.radius_m + 1e-12);
  EXPECT_LT(model.radius_m, 1.0) << "the smallest sphere has 0.816 m";
}

TEST_F(CadFiles, WithoutFaces) {
  EXPECT_THAT(complaint("mtllib white.mtl\n" + kCorners), HasSubstr("face"));
}

TEST_F(CadFiles, OfPointsAndLinesOnly) {
  EXPECT_THAT(complaint("mtllib white.mtl\n" + kCorners + "usemtl white\nl 1 2\nl 2 3\n"), HasSubstr("no faces"));
}

TEST_F(CadFiles, InMillimetres) {
  EXPECT_THAT(complaint("mtllib white.mtl\nv 0 0 0\nv 700 0 0\nv 0 700 0\nusemtl white\nf 1 2 3\n"),
              AllOf(HasSubstr("sphere of radius 495 m"), HasSubstr("0.05 m to 100 m"), HasSubstr("metres")));
}

TEST_F(CadFiles, InKilometres) {
  EXPECT_THAT(complaint("mtllib white.mtl\nv 0 0 0\nv 0.0007 0 0\nv 0 0.0007 0\nusemtl white\nf 1 2 3\n"),
              HasSubstr("0.05 m to 100 m"));
}

TEST_F(CadFiles, WhoseMaterialFileIsMissing) {
  EXPECT_THAT(complaint("mtllib gone.mtl\n" + kCorners + "usemtl white\n" + kFaces),
              AllOf(HasSubstr("gone.mtl"), HasSubstr("no such material file")));
}

TEST_F(CadFiles, WhoseMaterialIsNotDefined) {
  EXPECT_THAT(complaint("mtllib white.mtl\n" + kCorners + "usemtl whyte\n" + kFaces),
              AllOf(HasSubstr("body.obj"), HasSubstr("line 6"), HasSubstr("\"whyte\"")));
}

// The same tetrahedron as an OBJ file in metres and as an STL file in millimetres, displaced, with z for y: what CAD
// programs write.
TEST_F(CadFiles, OtherUnitsAxesAndOrigin) {
  const CadModel metres =
      load_cad_model(write("body.obj", "mtllib white.mtl\n" + kCorners + "usemtl white\n" + kFaces));
  const std::array<Vector3, 4> corners{Vector3::Zero(), Vector3::UnitX(), Vector3::UnitY(), Vector3::UnitZ()};
  const std::array<std::array<std::size_t, 3>, 4> faces{{{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}}};
  std::string stl = "solid body\n";
  for (const auto& face : faces) {
    stl += "facet normal 0 0 0\nouter loop\n";
    for (const std::size_t k : face) {
      const Vector3& p = corners[k];  // body x, y, z along the file's x, -z, y; the body's origin at (100, 200, 300) mm
      stl += fmt::format("vertex {} {} {}\n", 1e3 * p.x() + 100.0, 1e3 * p.z() + 200.0, -1e3 * p.y() + 300.0);
    }
    stl += "endloop\nendfacet\n";
  }
  CadSource source{.file = write("body.stl", stl + "endsolid body\n"), .unit_m = 1e-3, .origin_m = {0.1, 0.2, 0.3}};
  source.R_body_file << 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0;
  source.surface = PlainSurface{.diffuse = 0.3, .specular = 0.2, .exponent = 50.0};
  const CadModel millimetres = load_cad_model(source);
  ASSERT_EQ(millimetres.triangles.size(), metres.triangles.size());
  for (std::size_t f = 0; f < metres.triangles.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT((millimetres.triangles[f].corners[k] - metres.triangles[f].corners[k]).norm(), 1e-6) << f << " " << k;
      EXPECT_LT((millimetres.triangles[f].normals[k] - metres.triangles[f].normals[k]).norm(), 1e-5) << f << " " << k;
    }
  ASSERT_EQ(millimetres.materials.size(), 1U);
  EXPECT_EQ(millimetres.materials[0].grey_diffuse(), 0.3);
  EXPECT_EQ(millimetres.materials[0].exponent, 50.0);
}

// A surface is for faces without a material, not for a material that is misspelt.
TEST_F(CadFiles, OfObjectsASurfaceCompletesFacesWithoutMaterialOnly) {
  CadSource source{.file = write("body.obj", kCorners + kFaces), .surface = PlainSurface{.diffuse = 0.3}};
  EXPECT_EQ(load_cad_model(source).materials.at(0).grey_diffuse(), 0.3);
  source.file = write("body.obj", "mtllib white.mtl\n" + kCorners + "usemtl whyte\n" + kFaces);
  try {
    static_cast<void>(load_cad_model(source));
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("line 6"), HasSubstr("\"whyte\"")));
  }
}

// Kd 1 and Ks 1, as Wings 3D writes and the models of NASA's simulator 42 have it.
TEST_F(CadFiles, MaterialsThatReflectMoreThanTheyReceive) {
  write("wings.mtl",
        "newmtl FLAT_WHITE\nNs 100\nKd 1 1 1\nKs 1 1 1\nnewmtl grey\nNs 10\nKd 0.2 0.3 0.4\nKs 0.1 0.1 0.1\n");
  const std::string text = "mtllib wings.mtl\n" + kCorners + "usemtl grey\nf 1 2 3\nusemtl FLAT_WHITE\n" + kFaces;
  CadSource source{.file = write("body.obj", text)};
  try {
    static_cast<void>(load_cad_model(source));
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("\"FLAT_WHITE\" reflects more than it receives"),
                                    HasSubstr("materials = \"scaled\""), HasSubstr("\"surface\"")));
  }
  source.materials = CadMaterials::kScaled;
  // Half of the light each way; what reflects less stays as it is.
  for (const Material& material : load_cad_model(source).materials) {
    const bool is_grey = material.name == "grey";
    EXPECT_NEAR(material.grey_diffuse(), is_grey ? 0.3 : 0.5, 1e-6) << material.name;
    EXPECT_NEAR(material.grey_specular(), is_grey ? 0.1 : 0.5, 1e-6) << material.name;
    EXPECT_EQ(material.exponent, is_grey ? 10.0 : 100.0);
  }
  source.materials = CadMaterials::kSurface;
  source.surface = PlainSurface{.diffuse = 0.3, .specular = 0.2, .exponent = 50.0};
  const CadModel plain = load_cad_model(source);
  ASSERT_EQ(plain.materials.size(), 1U);
  EXPECT_DOUBLE_EQ(plain.materials[0].grey_specular(), 0.2);
  // Nor does a material file that is missing matter then.
  source.file = write("body.obj", "mtllib none.mtl\n" + kCorners + "usemtl whyte\n" + kFaces);
  EXPECT_EQ(load_cad_model(source).materials.at(0).grey_diffuse(), 0.3);
}

TEST_F(CadFiles, AnStlFileNeedsASurface) {
  const auto file =
      write("body.stl",
            "solid body\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
            "endfacet\nendsolid body\n");
  try {
    static_cast<void>(load_cad_model(file));
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("body.stl"), HasSubstr("no diffuse colour"), HasSubstr("[cad]")));
  }
}

TEST_F(CadFiles, WithoutMaterials) {
  EXPECT_THAT(complaint(kCorners + kFaces), AllOf(HasSubstr("line 5"), HasSubstr("a face without material")));
}

TEST_F(CadFiles, WhoseMaterialReflectsTooMuch) {
  write("white.mtl", "newmtl white\nKd 0.8 0.8 0.8\nKs 0.4 0.4 0.4\nNs 20\n");
  EXPECT_THAT(complaint("mtllib white.mtl\n" + kCorners + "usemtl white\n" + kFaces),
              AllOf(HasSubstr("\"white\""), HasSubstr("reflects more than it receives")));
}

TEST_F(CadFiles, WithACornerThatIsNoNumber) {
  EXPECT_THAT(complaint("mtllib white.mtl\nv 0 0 0\nv 1 nan 0\nv 0 1 0\nusemtl white\nf 1 2 3\n"),
              AllOf(HasSubstr("body.obj"), HasSubstr("is not finite")));
}

TEST_F(CadFiles, WithFacesWithoutArea) {
  EXPECT_THAT(complaint("mtllib white.mtl\n" + kCorners + "usemtl white\n" + kFaces + "f 1 1 2\n"),
              HasSubstr("1 of 5 triangles have no area"));
}

TEST_F(CadFiles, WithAFaceOfMissingCorners) {
  EXPECT_THAT(complaint("mtllib white.mtl\n" + kCorners + "usemtl white\nf 1 2 9\n"), HasSubstr("body.obj"));
}

TEST_F(CadFiles, ThatAreNone) {
  EXPECT_THAT(complaint("this is a letter, not a body\n"), HasSubstr("face"));
  try {
    load_cad_model(folder_ / "nobody.obj");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("nobody.obj"), HasSubstr("no such file")));
  }
  try {
    load_cad_model(write("body.xyz", "1 2 3\n"));
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("body.xyz"), HasSubstr("no CAD file that can be read")));
  }
}

TEST(TangoModel, HasItsKeypointsAndALimitedNumberOfFaces) {
  const CadModel model = load_cad_model(std::filesystem::path(vbar::tests::source_path("data/models/tango.obj")));
  EXPECT_GT(model.triangles.size(), 1000U);
  EXPECT_LT(model.triangles.size(), 5000U);
  EXPECT_EQ(model.faces_without_area, 0U);
  std::set<std::size_t> used;
  for (const Triangle& t : model.triangles) used.insert(t.material);
  EXPECT_EQ(used.size(), 13U) << "materials of its script";
  // Published with the SPEED and SPEED+ data sets: corners of the panel, corners of the bottom, antenna tips.
  for (const Vector3& keypoint :
       {Vector3(-0.37, -0.385, 0.3215), Vector3(-0.37, 0.385, 0.3215), Vector3(0.37, 0.385, 0.3215),
        Vector3(0.37, -0.385, 0.3215), Vector3(-0.37, -0.264, 0.0), Vector3(-0.37, 0.304, 0.0),
        Vector3(0.37, 0.304, 0.0), Vector3(0.37, -0.264, 0.0), Vector3(-0.5427, 0.4877, 0.2535),
        Vector3(0.5427, 0.4877, 0.2591), Vector3(0.3050, -0.5790, 0.2515)}) {
    accuracy::Smallest nearest{1.0};
    for (const Triangle& t : model.triangles)
      for (const Vector3& corner : t.corners) nearest.add((corner - keypoint).norm());
    EXPECT_LT(nearest, 2e-5) << keypoint.transpose();  // of the file's digits, 1e-5 m
  }
  // Nothing but antennas reaches far beyond the hull: fittings stand out by less than a decimetre.
  for (const Triangle& t : model.triangles)
    for (const Vector3& corner : t.corners) {
      EXPECT_LT(std::abs(corner.x()), 0.5478);
      EXPECT_GT(corner.z(), -0.06);
      EXPECT_LT(corner.z(), 0.36);
    }
}

}  // namespace
}  // namespace vbar::twins::camera
