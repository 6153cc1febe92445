#include "host_sim/training/materials.h"

#include <gtest/gtest.h>

#include "host_sim/mission/data_directory.h"

namespace vbar::training {
namespace {

using twins::camera::CadModel;
using twins::camera::Material;

CadModel tango() {
  return twins::camera::load_cad_model(mission::data_directory() / "models" / "tango.obj");
}

bool both_near(const Material& drawn, const Material& own) {
  const double d = drawn.grey_diffuse() / own.grey_diffuse(), s = drawn.grey_specular() / own.grey_specular();
  return d >= 0.7 && d <= 1.3 && s >= 0.7 && s <= 1.3;
}

TEST(Materials, TrainingNeverShowsThoseOfTheFile) {
  const CadModel model = tango();
  engine::RandomStream stream(5, "materials");
  for (const CropKind kind : {CropKind::kTraining, CropKind::kCalibration})
    for (int i = 0; i < 500; ++i) {
      const auto drawn = draw_materials(kind, model.materials, stream);
      ASSERT_EQ(drawn.size(), model.materials.size());
      for (std::size_t k = 0; k < drawn.size(); ++k) ASSERT_FALSE(both_near(drawn[k], model.materials[k])) << k;
    }
}

TEST(Materials, HeldOutShowsOnlyThoseNearTheFile) {
  const CadModel model = tango();
  engine::RandomStream stream(5, "materials");
  for (int i = 0; i < 500; ++i) {
    const auto drawn = draw_materials(CropKind::kHeldOut, model.materials, stream);
    for (std::size_t k = 0; k < drawn.size(); ++k) ASSERT_TRUE(both_near(drawn[k], model.materials[k])) << k;
  }
}

TEST(Materials, ReflectNoMoreThanAllLight) {
  const CadModel model = tango();
  engine::RandomStream stream(6, "materials");
  for (int i = 0; i < 500; ++i)
    ASSERT_NO_THROW(check_materials("drawn", draw_materials(CropKind::kTraining, model.materials, stream)));
}

}  // namespace
}  // namespace vbar::training
