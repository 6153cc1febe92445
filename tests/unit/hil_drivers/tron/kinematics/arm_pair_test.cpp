// Poses in the laboratory by its drawing, and corrections against a chain with errors.

#include "hil_drivers/tron/kinematics/arm_pair.h"

#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/figures.h"
#include "tests/support/paths.h"

namespace vbar::tron {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

BenchFile bench() {
  return read_bench_file(tests::source_path("data/benches/tron.toml"));
}

Posture posture() {
  return {Joints(0.1, -1.4, 1.2, 0.5, 0.7, -0.6), Joints(-0.2, -1.6, 1.5, -0.4, 0.8, 0.3), 3.0};
}

TEST(TronArmPair, StretchedArmsAreWhereTheDrawingHasThem) {
  BenchFile file = bench();
  file.target_robot.base = {{7.0, 0.0, 0.45}, {0.0, 0.0, std::numbers::pi}};
  file.target.face = MountFace::kBottom;
  const ArmPair arms(file);
  const Posture zero{Joints::Zero(), Joints::Zero(), 2.0};
  // Hanging from z 2.75 m, upside down, looking along +x: 1.180 + 0.150 m ahead, 0.435 m below.
  const Eigen::Isometry3d camera = arms.camera_pose(zero);
  EXPECT_LT((camera.translation() - fsw::Vector3(2.0 + 1.330, 0.0, 2.75 - 0.435)).norm(), 1e-12);
  EXPECT_LT((camera.linear().col(2) - fsw::Vector3::UnitX()).norm(), 1e-12);
  // On the floor at x 7 m, facing -x; the bottom panel, whose origin is the body's, 0.25 m before the flange.
  const Eigen::Isometry3d target = arms.target_pose(zero);
  EXPECT_LT((target.linear().col(2) + fsw::Vector3::UnitX()).norm(), 1e-12);
  EXPECT_NEAR(target.translation().x(), 7.0 - 1.180 - 0.25, 1e-12);
}

TEST(TronArmPair, FlangePosesAndInverseReturnTheJoints) {
  const ArmPair arms(bench());
  const Posture at = posture();
  EXPECT_LT(accuracy::largest_entry(arms.camera_flange(arms.camera_pose(at), at.carriage_m).matrix() -
                                    arms.camera_arm().forward(at.camera_rad).matrix()),
            1e-12);
  EXPECT_LT(accuracy::largest_entry(arms.target_flange(arms.target_pose(at)).matrix() -
                                    arms.target_arm().forward(at.target_rad).matrix()),
            1e-12);
}

TEST(TronArmPair, CorrectsAChainWithErrors) {
  const ArmPair arms(bench());
  // Joint offsets of some tenths of a degree, as hidden errors of an arm as mastered.
  const Joints camera_offset = 0.3 * kDegree * Joints(0.5, -1.0, 0.8, 1.0, -0.4, 0.6);
  const Joints target_offset = 0.3 * kDegree * Joints(-0.7, 0.2, 0.9, -1.0, 0.4, 0.5);
  const auto measured = [&](Posture at) {
    at.camera_rad += camera_offset;
    at.target_rad += target_offset;
    return arms.T_C_T(at);
  };
  const Eigen::Isometry3d wanted = arms.T_C_T(posture());
  const auto error = [&](const Posture& at) {
    const Eigen::Isometry3d left = measured(at).inverse() * wanted;
    return left.translation().norm() + Eigen::AngleAxisd(left.linear()).angle();
  };
  ASSERT_GT(error(posture()), 5e-3);
  const auto once = arms.correct(posture(), measured(posture()), wanted);
  ASSERT_TRUE(once);
  // Of second order: 1 deg of error in a correction of some mm and tenths of a degree.
  EXPECT_LT(error(*once), 0.05 * error(posture()));
  const auto twice = arms.correct(*once, measured(*once), wanted);
  ASSERT_TRUE(twice);
  EXPECT_LT(error(*twice), 0.05 * error(*once));
}

TEST(TronArmPair, RefusesACorrectionThatIsNotFiniteOrOutOfReach) {
  const ArmPair arms(bench());
  const Eigen::Isometry3d pose = arms.T_C_T(posture());
  Eigen::Isometry3d bad = pose;
  bad.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(arms.correct(posture(), bad, pose));
  EXPECT_FALSE(arms.correct(posture(), pose, bad));
  Posture nowhere = posture();
  nowhere.carriage_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(arms.correct(nowhere, pose, pose));
  Eigen::Isometry3d far = pose;
  far.translation().y() += 10.0;
  EXPECT_FALSE(arms.correct(posture(), pose, far));
}

}  // namespace
}  // namespace vbar::tron
