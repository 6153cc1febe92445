// Kinematics of one arm at postures whose pose follows from the drawing, at singularities and for invalid input. The
// comparison with Orocos KDL is in tests/peers/tron.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "hil_drivers/tron/geometry/kinematics.h"
#include "tests/support/figures.h"
#include "tests/support/paths.h"

namespace vbar::tron {

namespace {

constexpr double kPi = std::numbers::pi;

Arm kuka() {
  return Arm(read_testbed_design(tests::source_path("data/benches/tron.toml")).camera_robot.design);
}

double difference(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return accuracy::largest_entry(a.matrix() - b.matrix());
}

TEST(TronArm, IsStretchedAlongXAtZeroAngles) {
  const Eigen::Isometry3d T = kuka().forward(Joints::Zero());
  // 25 + 560 + 515 + 80 mm ahead, 400 + 35 mm up; flange z ahead, x down.
  EXPECT_LT((T.translation() - fsw::Vector3(1.180, 0.0, 0.435)).norm(), 1e-12);
  EXPECT_LT((T.linear().col(2) - fsw::Vector3::UnitX()).norm(), 1e-12);
  EXPECT_LT((T.linear().col(0) + fsw::Vector3::UnitZ()).norm(), 1e-12);
}

TEST(TronArm, PositiveA1TurnsClockwiseSeenFromAboveAndPositiveA2Down) {
  const Arm arm = kuka();
  Joints q = Joints::Zero();
  q[0] = kPi / 2.0;
  EXPECT_LT((arm.forward(q).translation() - fsw::Vector3(0.0, -1.180, 0.435)).norm(), 1e-12);
  q = Joints::Zero();
  q[1] = -kPi / 2.0;
  // Straight up: 400 + 560 + 515 + 80 mm, 35 mm behind the upper arm.
  EXPECT_LT((arm.forward(q).translation() - fsw::Vector3(0.025 - 0.035, 0.0, 1.555)).norm(), 1e-12);
}

TEST(TronArm, PointsAreThoseOfTheChain) {
  const Arm arm = kuka();
  const Joints q(0.3, -1.1, 1.4, 0.7, -0.9, 2.0);
  const ArmPoints at = arm.points(q);
  const ArmDesign& design = arm.design();
  EXPECT_NEAR((at.elbow - at.shoulder).norm(), design.a2_m, 1e-12);
  EXPECT_NEAR((at.wrist - at.elbow).norm(), std::hypot(design.d4_m, design.a3_m), 1e-12);
  EXPECT_LT((at.flange - arm.forward(q).translation()).norm(), 1e-12);
  EXPECT_NEAR(arm.wrist_from_a1_m(q), at.wrist.head<2>().norm(), 1e-15);
}

TEST(TronArm, JacobianIsTheDerivative) {
  const Arm arm = kuka();
  const Joints q(0.3, -1.1, 1.4, 0.7, -0.9, 2.0);
  const auto J = arm.jacobian(q);
  constexpr double kStep = 1e-6;
  for (int k = 0; k < 6; ++k) {
    const Eigen::Isometry3d before = arm.forward(q - kStep * Joints::Unit(k)),
                            after = arm.forward(q + kStep * Joints::Unit(k));
    const fsw::Vector3 velocity = (after.translation() - before.translation()) / (2.0 * kStep);
    const Eigen::AngleAxisd turn(after.linear() * before.linear().transpose());
    const fsw::Vector3 rate = turn.angle() * turn.axis() / (2.0 * kStep);
    // Central differences of 1e-6: rounding 1e-16 / 1e-6, and angle of a rotation matrix near zero.
    EXPECT_LT((J.col(k).head<3>() - velocity).norm(), 1e-8);
    EXPECT_LT((J.col(k).tail<3>() - rate).norm(), 1e-6);
  }
}

TEST(TronArm, FullTurnsWithinLimits) {
  const Arm arm = kuka();
  const Joints q(0.1, -1.0, 1.2, 178.0 / 180.0 * kPi, 0.5, 20.0 / 180.0 * kPi);
  // A4 +-185 deg: 178 and -182; A6 +-350 deg: 20 and -340.
  const std::vector<Joints> all = arm.turns(q);
  ASSERT_EQ(all.size(), 4U);
  for (const Joints& turned : all) {
    EXPECT_TRUE(arm.is_within_limits(turned));
    EXPECT_LT(difference(arm.forward(turned), arm.forward(q)), 1e-12);
  }
  Joints near = q;
  near[3] = -3.0;
  near[5] = -5.0;
  const Joints nearest = arm.nearest_turn(q, near);
  EXPECT_NEAR(nearest[3], q[3] - 2.0 * kPi, 1e-12);
  EXPECT_NEAR(nearest[5], q[5] - 2.0 * kPi, 1e-12);
}

TEST(TronArm, SingularPosturesAreReportedAndLeadBack) {
  const Arm arm = kuka();
  const Joints wrist(0.2, -1.0, 1.3, 0.8, 0.0, -0.3);
  const Branches at_wrist = arm.inverse(arm.forward(wrist), wrist);
  EXPECT_TRUE(at_wrist.is_wrist_singular);
  Joints stretched(0.2, -1.0, 0.0, 0.8, 0.6, -0.3);
  stretched[2] = std::atan2(arm.design().a3_m, arm.design().d4_m);
  const Branches at_elbow = arm.inverse(arm.forward(stretched), stretched);
  ASSERT_GT(at_elbow.count, 0U);
  for (const auto& [branches, posture] : {std::pair(at_wrist, wrist), std::pair(at_elbow, stretched)}) {
    accuracy::Smallest own;
    for (std::size_t k = 0; k < branches.count; ++k) {
      EXPECT_LT(difference(arm.forward(branches.joints[k]), arm.forward(posture)), 1e-9);
      own.add(accuracy::largest_entry(branches.joints[k] - posture));
    }
    EXPECT_LT(own, 1e-6);  // at a singularity rounding of 1e-16 is 1e-8 of an angle
  }
}

TEST(TronArm, AWristOnTheAxisOfA1KeepsA1) {
  const Arm arm = kuka();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << 0.0, 0.0, 1.0 + arm.design().d6_m;
  Joints near = Joints::Zero();
  near[0] = 0.7;
  const Branches branches = arm.inverse(T, near);
  EXPECT_TRUE(branches.is_shoulder_singular);
  ASSERT_GT(branches.count, 0U);
  EXPECT_NEAR(branches.joints[0][0], 0.7, 1e-12);
  for (std::size_t k = 0; k < branches.count; ++k) EXPECT_LT(difference(arm.forward(branches.joints[k]), T), 1e-9);
}

TEST(TronArm, HasNoPostureForAPoseOutOfReachOrNotFinite) {
  const Arm arm = kuka();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << 3.0, 0.0, 0.4;
  EXPECT_EQ(arm.inverse(T).count, 0U);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    T.translation() << 0.5, bad, 0.4;
    EXPECT_EQ(arm.inverse(T).count, 0U);
    Joints q = Joints::Zero();
    q[2] = bad;
    EXPECT_TRUE(arm.turns(q).empty());
    EXPECT_FALSE(arm.is_within_limits(q));
  }
}

}  // namespace

// Poses in the laboratory by its drawing, and corrections against a chain with errors.

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

TestbedDesign bench() {
  return read_testbed_design(tests::source_path("data/benches/tron.toml"));
}

Posture posture() {
  return {Joints(0.1, -1.4, 1.2, 0.5, 0.7, -0.6), Joints(-0.2, -1.6, 1.5, -0.4, 0.8, 0.3), 3.0};
}

TEST(TronArmPair, StretchedArmsAreWhereTheDrawingHasThem) {
  TestbedDesign file = bench();
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
