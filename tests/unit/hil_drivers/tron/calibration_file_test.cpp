// The calibration of TRON: its file and its chain.

#include <cmath>
#include <filesystem>
#include <string>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "hil_drivers/tron/geometry/calibration.h"
#include "host_sim/mission/mission_error.h"
#include "tests/support/paths.h"

namespace vbar::tests {
namespace {

// A calibration of TRON in which every figure differs from its default.

tron::Calibration tron_calibration_example() {
  tron::Calibration c;
  c.validity = {"2026-11-23T04:00:00Z", "tron", true, 18446744073709551615ULL, "GS3 \"PGE\"", "12345", "0f1e2d"};
  c.lens = {1600, 1000, 2901.25, 2902.5, 799.1 + 0.2, 500.25, {-0.22, 0.51, -6e-4, -2e-4, -0.13}};
  const auto arm = [](double sign) {
    tron::ArmCalibration a;
    a.lengths = {0.4, 0.025, 0.56, 0.035, 0.515, 0.08};
    a.base = {{0.01 * sign, 0.002, 3.1}, {7.0, 0.01, 0.45}};
    a.offset_rad = {0.001, -0.002, 0.003 * sign, 0.0011, -0.0012, 0.1 + 0.2};
    for (std::size_t k = 0; k < a.link.size(); ++k)
      for (std::size_t i = 0; i < 6; ++i) a.link[k][i] = 1e-4 * sign * static_cast<double>(1 + 6 * k + i);
    a.flex_rad_m = {8e-4 * sign, 1.2e-3};
    a.mount = {{0.02, -0.01 * sign, 0.5}, {0.004, 0.001, 0.25}};
    return a;
  };
  c.camera_arm = arm(-1.0);
  c.target_arm = arm(1.0);
  c.track.grid = {0.1, 0.6, 4.1};
  c.track.scale = 1.1e-4;
  for (int k = 0; k < 15; ++k) c.track.knots.push_back({1e-4 * k, -2e-4, 3e-4, 8e-4, -7e-4 * k});
  c.vicon.rotation = "zyx";
  c.vicon.T_C_object = {{0.5, 1.0, -2.0}, {0.01, 0.02, -0.1}};
  c.vicon.T_object_T = {{-0.4, 0.3, 1.2}, {0.1, -0.3, 0.2}};
  c.vicon.T_V_L = {{0.03, 0.01, -0.02}, {0.05, 0.04, -0.03}};
  c.covariance.arms = 1e-6 * tron::Matrix6::Identity();
  c.covariance.arms(0, 4) = c.covariance.arms(4, 0) = 3e-7;
  c.covariance.vicon = 7e-6 * tron::Matrix6::Identity();
  c.lights = {{"lamp", {0.0, 0.5, 1.0}, {0.0, 0.22, 1.0}}, {"box 1", {0.25, 1.0}, {0.05, 1.0}}};
  c.camera = {10, 64.25, 1.1, 2.5e4};
  const tron::ErrorFigures errors{1.1, 0.6, 1.0, 0.05, 0.02, 0.045, 0.9, 0.5, 0.8};
  c.figures = {{"arms as mastered", 110, errors, std::nullopt}, {"fused", 109, errors, errors}};
  return c;
}

}  // namespace
}  // namespace vbar::tests

namespace vbar::tron {
namespace {

using tests::tron_calibration_example;

std::string refusal_of(const std::string& text) {
  try {
    static_cast<void>(parse_calibration(text, "bench.toml"));
  } catch (const mission::MissionError& error) {
    return error.what();
  }
  return "accepted";
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = toml_of(tron_calibration_example());
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

void expect_refusal(const std::string& text, const std::string& key) {
  const std::string refusal = refusal_of(text);
  EXPECT_NE(refusal.find("bench.toml"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find(key), std::string::npos) << refusal;
}

TestbedDesign bench() {
  return read_testbed_design(tests::source_path("data/benches/tron.toml"));
}

TEST(TronCalibrationFile, ReadsBackWithTheSameBits) {
  const Calibration written = tron_calibration_example();
  const std::string text = toml_of(written);
  const Calibration read = parse_calibration(text, "bench.toml");
  EXPECT_TRUE(toml_of(read) == text);  // EXPECT_EQ would print both
  EXPECT_EQ(read.validity.seed, written.validity.seed);
  EXPECT_EQ(read.validity.camera_model, written.validity.camera_model);
  EXPECT_EQ(read.camera_arm.link, written.camera_arm.link);
  EXPECT_EQ(read.track.knots, written.track.knots);
  EXPECT_EQ(read.vicon.rotation, "zyx");
  EXPECT_EQ(read.covariance.arms, written.covariance.arms);
  EXPECT_EQ(read.lights.at(1).level, written.lights.at(1).level);
  ASSERT_EQ(read.figures.size(), 2U);
  EXPECT_FALSE(read.figures[0].truth);
  EXPECT_EQ(read.figures[1].truth.value().pixel_median_px, 0.8);
}

TEST(TronCalibrationFile, IsSavedAsAWhole) {
  const auto file = std::filesystem::path(testing::TempDir()) / "tron_calibration_test.toml";
  save_calibration(tron_calibration_example(), file);
  EXPECT_TRUE(toml_of(load_calibration(file)) == toml_of(tron_calibration_example()));
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".partial"));
  std::filesystem::remove(file);
  EXPECT_THROW(save_calibration(tron_calibration_example(), "/nowhere/at/all.toml"), std::runtime_error);
}

TEST(TronCalibrationFile, DamagedFilesAreRefusedWithTheirKey) {
  expect_refusal(with("scale = 0.00011", "scale = nan"), "track.scale");
  expect_refusal(with("emulated = true\n", ""), "validity.emulated");
  expect_refusal(with("seed = \"1844", "seed = \"-1844"), "validity.seed");
  expect_refusal(with("focal_length_px = [2901.25", "focal_length_px = [0"), "lens.focal_length_px");
  expect_refusal(with("size_px = [1600", "size_px = [1600.5"), "lens.size_px");
  expect_refusal(with("after_a3 = [", "after_a3 = [0.1, "), "camera_arm.after_a3");
  expect_refusal(with("yaw_rad = [", "yaw_rad = [0.1, "), "track.yaw_rad");
  expect_refusal(with("roll_rad = [0", "roll_rad = [inf"), "track.roll_rad");
  expect_refusal(with("step_m = 0.6", "step_m = 0"), "track.step_m");
  expect_refusal(with("rotation = \"zyx\"", "rotation = \"zyz\""), "vicon.rotation");
  expect_refusal(with("arms = [\n  1e-06", "arms = [\n  -1e-06"), "covariance.arms");
  expect_refusal(with("level = [0, 0.5, 1]", "level = [0, 0.5, 0.5]"), "level");
  expect_refusal(with("light_tables = 2", "light_tables = 11"), "light");
  expect_refusal(with("[camera]", "[camera]\nlens = 3"), "camera.lens");
  expect_refusal(with("mount = {", "mounting = {"), "mount");
  expect_refusal("", "bench.toml");
  expect_refusal("lens = [", "bench.toml");
}

TEST(TronCalibrationFile, EveryTruncationIsRefused) {
  const std::string text = toml_of(tron_calibration_example());
  for (std::size_t length = 0; length + 1 < text.size(); length += 23)
    EXPECT_NE(refusal_of(text.substr(0, length)).find("bench.toml"), std::string::npos) << length;
}

// The chain as designed, at zero angles (ArmDesign's comment): stretched along base x, wrist at a1 + a2 + d4, flange d6
// further, z of the flange along x, its x down (the matrix of ArmDesign's comment).
TEST(TronCalibratedChain, AtZeroTheArmIsStretched) {
  const Calibration calibration = calibration_as_designed(bench());
  Calibration bare = calibration;
  bare.target_arm.mount = {};
  bare.target_arm.base = {};
  const Eigen::Isometry3d T = T_L_T_of_arm(bare, Posture{});
  EXPECT_LT((T.translation() - Eigen::Vector3d(0.025 + 0.56 + 0.515 + 0.08, 0.0, 0.4 + 0.035)).norm(), 1e-12);
  EXPECT_LT((T.linear().col(2) - Eigen::Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_LT((T.linear().col(0) + Eigen::Vector3d::UnitZ()).norm(), 1e-12);
}

// Senses of the joints (TRON.md, section 1): A1 about -z, A2 and A3 about +y.
TEST(TronCalibratedChain, JointsTurnInTheirSenses) {
  Calibration bare = calibration_as_designed(bench());
  bare.target_arm.mount = {};
  bare.target_arm.base = {};
  Posture posture;
  posture.target_rad[0] = M_PI / 2;
  EXPECT_LT((T_L_T_of_arm(bare, posture).linear().col(2) - Eigen::Vector3d(0.0, -1.0, 0.0)).norm(), 1e-12);
  posture.target_rad.setZero();
  posture.target_rad[1] = -M_PI / 2;  // straight up
  const Eigen::Isometry3d up = T_L_T_of_arm(bare, posture);
  EXPECT_LT((up.translation() - Eigen::Vector3d(0.025 - 0.035, 0.0, 0.4 + 0.56 + 0.515 + 0.08)).norm(), 1e-12);
  posture.target_rad[2] = M_PI / 2;  // forearm forward again
  EXPECT_LT((T_L_T_of_arm(bare, posture).linear().col(2) - Eigen::Vector3d::UnitX()).norm(), 1e-12);
}

TEST(TronCalibratedChain, WeightTurnsAStandingArmDownAndAHangingOneDownToo) {
  Calibration calibration = calibration_as_designed(bench());
  const Posture posture;  // both stretched: levers of about a metre
  const Calibration rigid = calibration;
  calibration.target_arm.flex_rad_m = calibration.camera_arm.flex_rad_m = {1e-3, 1e-3};
  EXPECT_LT(T_L_T_of_arm(calibration, posture).translation().z(),
            T_L_T_of_arm(rigid, posture).translation().z() - 1e-3);
  EXPECT_LT(T_L_C_of_arm(calibration, posture).translation().z(),
            T_L_C_of_arm(rigid, posture).translation().z() - 1e-3);
}

// A uniform cubic B-spline with equal control points is constant, one with linear ones is linear.
TEST(TronCalibratedChain, TrackErrorsFollowTheirKnots) {
  Calibration calibration = calibration_as_designed(bench());
  const TrackGrid& grid = calibration.track.grid;
  for (std::size_t k = 0; k < calibration.track.knots.size(); ++k)
    calibration.track.knots[k] = {0.0, 0.0, 0.0, 2e-3, 1e-3 * (grid.first_m + grid.step_m * static_cast<double>(k))};
  calibration.track.scale = 1e-4;
  const Calibration straight = calibration_as_designed(bench());
  for (const double carriage_m : {0.5, 0.73, 3.999, 4.0, 7.2, 7.5}) {
    Posture posture;
    posture.carriage_m = carriage_m;
    const Eigen::Vector3d moved =
        T_L_C_of_arm(calibration, posture).translation() - T_L_C_of_arm(straight, posture).translation();
    EXPECT_LT((moved - Eigen::Vector3d(1e-4 * (carriage_m - 4.0), 2e-3, 1e-3 * carriage_m)).norm(), 1e-12)
        << carriage_m;
  }
}

// The arm hangs by a plate at 2.75 m; pitch, roll and yaw of the carriage leave the plate's place.
TEST(TronCalibratedChain, TrackErrorsTurnAboutThePlateOfTheArm) {
  Calibration calibration = calibration_as_designed(bench());
  for (auto& knot : calibration.track.knots) knot = {1e-3, 2e-3, 3e-3, 0.0, 0.0};
  const TrackCalibration& track = calibration.track;
  const auto T =
      T_L_carriage<double>(track.grid, 3.0, track.knots.front().data(), static_cast<int>(track.knots.size()), 0.0);
  EXPECT_LT((T * Eigen::Vector3d(0.0, 0.0, 2.75) - Eigen::Vector3d(3.0, 0.0, 2.75)).norm(), 1e-12);
  EXPECT_GT(Eigen::AngleAxisd(T.linear()).angle(), 3e-3);
}

TEST(TronCalibratedChain, MotionCaptureGivesTheRelativePose) {
  const Calibration c = tron_calibration_example();
  Posture posture;
  posture.carriage_m = 3.0;
  const Eigen::Isometry3d T_L_C = T_L_C_of_arm(c, posture), T_L_T = T_L_T_of_arm(c, posture);
  const Eigen::Isometry3d V_L = c.vicon.T_V_L.isometry();
  const Eigen::Isometry3d T = T_C_T_of_vicon(c, V_L * T_L_C * c.vicon.T_C_object.isometry(),
                                             V_L * T_L_T * c.vicon.T_object_T.isometry().inverse());
  EXPECT_LT((T.matrix() - T_C_T_of_arms(c, posture).matrix()).norm(), 1e-12);
}

// An error drawn in camera axes, carried to the target's axes by hand.
TEST(TronCalibration, CovarianceIsCarriedToTheTargetsAxes) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  T.translation() << 0.1, -0.2, 4.0;
  Eigen::Matrix<double, 6, 1> error;
  error << 1e-6, -2e-6, 3e-6, 2e-6, 1e-6, -1e-6;
  Eigen::Isometry3d truth = T;
  truth.linear() = Eigen::AngleAxisd(error.head<3>().norm(), error.head<3>().normalized()) * T.linear();
  truth.translation() += T.translation().norm() * error.tail<3>();
  const Eigen::Isometry3d difference = T.inverse() * truth;
  const Eigen::AngleAxisd turn(difference.linear());
  Eigen::Matrix<double, 6, 1> expected;
  expected << turn.angle() * turn.axis(), difference.translation();
  const Matrix6 outer = error * error.transpose();
  const Matrix6 wanted = expected * expected.transpose();
  EXPECT_LT((covariance_at(outer, T) - wanted).norm(), 1e-4 * wanted.norm());
}

TEST(TronCalibration, AsDesignedItsParametersAreZeroAndItsPosesThoseOfTheBenchFile) {
  const TestbedDesign file = bench();
  const Calibration c = calibration_as_designed(file);
  EXPECT_LT((c.target_arm.base.isometry().matrix() - file.target_robot.base.T_L_base().matrix()).norm(), 1e-12);
  EXPECT_LT((c.camera_arm.mount.isometry().matrix() - file.camera.T_flange_camera().matrix()).norm(), 1e-12);
  EXPECT_EQ(c.track.knots.size(), 17U);  // 14 cells of 0.5 m and three more control points
  EXPECT_EQ(c.camera_arm.offset_rad[3], 0.0);
}

}  // namespace

}  // namespace vbar::tron
