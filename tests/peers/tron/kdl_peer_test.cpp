// Kinematics of the arms of TRON against Orocos KDL, built from the table of the bench file.

#include <gtest/gtest.h>

#ifdef VBAR_HAVE_KDL

#include <algorithm>
#include <cmath>
#include <random>

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "hil_drivers/tron/geometry/kinematics.h"
#include "tests/support/accuracy.h"
#include "tests/support/paths.h"

namespace vbar::tron {
namespace {

constexpr int kPostures = 10000;

ArmDesign design() {
  return read_testbed_design(tests::source_path("data/benches/tron.toml")).camera_robot.design;
}

/// As ArmDesign describes it: the axes at zero angles, and the steps from each to the next.
KDL::Chain chain_of(const ArmDesign& arm) {
  using KDL::Frame;
  using KDL::Joint;
  using KDL::Segment;
  using KDL::Vector;
  const Vector x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  KDL::Chain chain;
  chain.addSegment(Segment(Joint(Joint::None), Frame(arm.d1_m * z)));
  chain.addSegment(Segment(Joint(Vector::Zero(), -z, Joint::RotAxis), Frame(arm.a1_m * x)));
  chain.addSegment(Segment(Joint(Joint::RotY), Frame(arm.a2_m * x)));
  chain.addSegment(Segment(Joint(Joint::RotY), Frame(arm.a3_m * z)));
  chain.addSegment(Segment(Joint(Vector::Zero(), -x, Joint::RotAxis), Frame(arm.d4_m * x)));
  chain.addSegment(Segment(Joint(Joint::RotY), Frame::Identity()));
  chain.addSegment(
      Segment(Joint(Vector::Zero(), -x, Joint::RotAxis), Frame(KDL::Rotation::RotY(std::acos(0.0)), arm.d6_m * x)));
  return chain;
}

class Postures {
 public:
  explicit Postures(const ArmDesign& arm) : arm_(arm) {}
  Joints next() {
    Joints q;
    for (std::size_t k = 0; k < kJoints; ++k)
      q[static_cast<Eigen::Index>(k)] = std::uniform_real_distribution(arm_.axes[k].lower, arm_.axes[k].upper)(random_);
    return q;
  }

 private:
  ArmDesign arm_;
  std::mt19937_64 random_{20260101};
};

KDL::JntArray to_kdl(const Joints& q) {
  KDL::JntArray joints(kJoints);
  joints.data = q;
  return joints;
}

Eigen::Isometry3d to_eigen(const KDL::Frame& frame) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) T.linear()(row, column) = frame.M(row, column);
    T.translation()[row] = frame.p[row];
  }
  return T;
}

double difference(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return accuracy::largest_entry(a.matrix() - b.matrix());
}

TEST(TronKinematicsPeer, ForwardIsKdls) {
  const Arm arm(design());
  const KDL::Chain chain = chain_of(design());
  KDL::ChainFkSolverPos_recursive solver(chain);
  Postures postures(design());
  accuracy::Largest largest;
  for (int n = 0; n < kPostures; ++n) {
    const Joints q = postures.next();
    KDL::Frame frame;
    ASSERT_GE(solver.JntToCart(to_kdl(q), frame), 0);
    largest.add(difference(arm.forward(q), to_eigen(frame)));
  }
  // Six products of matrices of ones round to some 1e-16 each.
  accuracy::expect_below("TRON's arms: pose of the flange", "Orocos KDL, 10,000 postures", largest, 1e-12, "m, rad");
}

TEST(TronKinematicsPeer, JacobianIsKdls) {
  const Arm arm(design());
  const KDL::Chain chain = chain_of(design());
  KDL::ChainJntToJacSolver solver(chain);
  Postures postures(design());
  for (int n = 0; n < 1000; ++n) {
    const Joints q = postures.next();
    KDL::Jacobian jacobian(kJoints);
    ASSERT_GE(solver.JntToJac(to_kdl(q), jacobian), 0);
    ASSERT_LT(accuracy::largest_entry(arm.jacobian(q) - jacobian.data), 1e-12) << n;  // as above
  }
}

TEST(TronKinematicsPeer, EveryBranchLeadsBackAndThePosturesOwnIsAmongThem) {
  const Arm arm(design());
  const KDL::Chain chain = chain_of(design());
  KDL::ChainFkSolverPos_recursive solver(chain);
  Postures postures(design());
  accuracy::Largest back;
  int not_found = 0;
  for (int n = 0; n < kPostures; ++n) {
    const Joints q = postures.next();
    KDL::Frame pose;
    ASSERT_GE(solver.JntToCart(to_kdl(q), pose), 0);
    const Eigen::Isometry3d T = to_eigen(pose);
    const Branches branches = arm.inverse(T);
    accuracy::Smallest own;
    for (std::size_t k = 0; k < branches.count; ++k) {
      KDL::Frame reached;
      ASSERT_GE(solver.JntToCart(to_kdl(branches.joints[k]), reached), 0);
      back.add(difference(T, to_eigen(reached)));
      if (!branches.is_within_limits[k]) continue;
      for (const Joints& turned : arm.turns(branches.joints[k])) own.add(accuracy::largest_entry(turned - q));
    }
    // Near a singularity rounding of the pose, 1e-16, is some 1e-8 of an angle.
    if (!(own < 1e-6)) ++not_found;
  }
  accuracy::expect_below("TRON's arms: pose of the flange of every branch", "Orocos KDL, 10,000 postures", back, 1e-9,
                         "m, rad");
  accuracy::expect_count("TRON's arms: postures not among their own branches", "Orocos KDL, 10,000 postures", not_found,
                         0, "postures");
}

}  // namespace
}  // namespace vbar::tron

#else

TEST(TronKinematicsPeer, IsKdls) {
  GTEST_SKIP() << "Orocos KDL (liborocos-kdl-dev) is not installed";
}

#endif
