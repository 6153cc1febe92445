#include "fsw/navigation/bearing.h"

#include "fsw/orbit/rtn.h"
#include "tests/unit/fsw/navigation/angles_only_scene.h"

namespace vbar::fsw::navigation {
namespace {

using namespace test;

TEST(BearingAxes, AreThoseOfTheOrbitForATargetBehind) {
  const orbit::CartesianState servicer = scene_servicer();
  const Matrix3 R_rtn_eci = orbit::R_rtn_eci(servicer);
  const Matrix3 axes = bearing_axes(-R_rtn_eci.row(1).transpose(), servicer);
  EXPECT_LT((axes.row(0) - R_rtn_eci.row(0)).norm(), 1e-12);  // up
  EXPECT_LT((axes.row(1) - R_rtn_eci.row(2)).norm(), 1e-12);  // orbit normal
  // Straight along the normal there is no vertical, but there are axes.
  const Matrix3 above = bearing_axes(R_rtn_eci.row(2).transpose(), servicer);
  EXPECT_LT((above * above.transpose() - Matrix3::Identity()).norm(), 1e-12);
}

TEST(CentreOfBrightness, LiesAcrossTheLineOfSightOnTheLitSide) {
  const Vector3 target(7e6, 0.0, 0.0), camera(7e6, 1000.0, 0.0);
  const Vector3 sun = Vector3(1.0, 1.0, 0.0).normalized();
  // The sun's direction across the sight (-y) is +x, of length cos 45 deg.
  EXPECT_LT((centre_of_brightness(target, camera, sun, 0.2) - target - Vector3(0.2 * std::sqrt(0.5), 0.0, 0.0)).norm(),
            1e-9);
  // Full and new target: none.
  EXPECT_LT((centre_of_brightness(target, camera, Vector3(0.0, 1.0, 0.0), 0.2) - target).norm(), 1e-9);
}

}  // namespace
}  // namespace vbar::fsw::navigation
