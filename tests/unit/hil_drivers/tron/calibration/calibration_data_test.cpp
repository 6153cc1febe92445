// Raw data of a calibration: the file, the order of angles, the table of true poses.

#include "hil_drivers/tron/calibration/calibration_data.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace vbar::tron::calibrate {
namespace {

Eigen::Isometry3d some_pose(double angle) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d(1.0, -2.0, 0.3).normalized()).toRotationMatrix();
  pose.translation() << 0.1 + 0.2, -angle, 3.0;
  return pose;
}

Measurement some_measurement(double angle) {
  Measurement measurement;
  for (Eigen::Index k = 0; k < 6; ++k) {
    measurement.posture.camera_rad[k] = 0.1 * static_cast<double>(k) + angle;
    measurement.posture.target_rad[k] = -0.3 * static_cast<double>(k) + angle;
  }
  measurement.posture.carriage_m = 2.0 + angle;
  measurement.corners = {{0, {100.25, 200.1 + 0.2}}, {53, {1500.0, 3.5}}};
  return measurement;
}

CalibrationData example() {
  CalibrationData data;
  data.validity = {"2026-11-23T04:00:00Z", "tron", true, 18446744073709551615ULL, "GS3", "12\"3", ""};
  data.bits = 10;
  data.dark = {64.25, 1.5};
  data.lights = {{"lamp", 0.5, 1234.5, 0.7}, {"box 1", 1.0, 20.0, 0.05}};
  data.fitted = {some_measurement(0.1), some_measurement(0.2)};
  data.fitted[1].vicon = ViconObjects{some_pose(0.4), some_pose(-1.2)};
  data.judged = {some_measurement(0.3)};
  return data;
}

std::string refusal_of(const std::string& text) {
  try {
    static_cast<void>(parse_data(text, "data.json"));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "accepted";
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = text_of(example());
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(CalibrationDataFile, ReadsBackWithTheSameBits) {
  const CalibrationData written = example(), read = parse_data(text_of(written), "data.json");
  EXPECT_EQ(read.validity.seed, written.validity.seed);
  EXPECT_EQ(read.validity.camera_serial, written.validity.camera_serial);
  EXPECT_EQ(read.bits, 10);
  ASSERT_EQ(read.fitted.size(), 2U);
  EXPECT_EQ(read.fitted[0].posture.camera_rad, written.fitted[0].posture.camera_rad);
  EXPECT_EQ(read.fitted[0].corners[0].px, written.fitted[0].corners[0].px);
  EXPECT_FALSE(read.fitted[0].vicon);
  ASSERT_TRUE(read.fitted[1].vicon);
  EXPECT_LT((read.fitted[1].vicon->T_V_target.matrix() - some_pose(-1.2).matrix()).norm(), 1e-15);
  EXPECT_EQ(read.lights[1].source, "box 1");
  EXPECT_EQ(read.judged[0].posture.carriage_m, written.judged[0].posture.carriage_m);
}

TEST(CalibrationDataFile, DamageIsRefusedWithItsPlace) {
  const auto expect = [](const std::string& text, const std::string& place) {
    const std::string refusal = refusal_of(text);
    EXPECT_NE(refusal.find("data.json"), std::string::npos) << refusal;
    EXPECT_NE(refusal.find(place), std::string::npos) << refusal;
  };
  expect("", "data.json");
  expect("[]", "data.json");
  expect(with("data 1", "data 2"), "format");
  expect(with("\"bits\": 10", "\"bits\": 99"), "bits");
  expect(with("\"emulated\": true", "\"emulated\": 1"), "emulated");
  expect(with("\"seed\": 18446744073709551615", "\"seed\": -1"), "seed");
  expect(with("[53,", "[53.5,"), "fitted[0].corners");
  expect(with("1500.0", "1e400"), "data.json");
  expect(with("1500.0", "\"x\""), "fitted[0].corners");
  expect(with("\"vicon_target\"", "\"vicon_other\""), "fitted[1].vicon_target");
  expect(with("\"carriage_m\":2.3", "\"carriage_m\":null"), "judged[0].carriage_m");
  const std::string text = text_of(example());
  for (std::size_t length = 0; length + 3 < text.size(); length += 29)
    EXPECT_NE(refusal_of(text.substr(0, length)), "accepted") << length;
}

TEST(CalibrationDataFile, MissingFilesAreRefused) {
  EXPECT_THROW(static_cast<void>(load_data("/nowhere/data.json")), std::runtime_error);
}

// Rx(a) Ry(b) Rz(c) read as Rz Ry Rx and put right again.
TEST(OrderOfAngles, IsChangedWithoutLoss) {
  const auto turn = [](double angle, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  };
  const auto x = turn(0.4, Eigen::Vector3d::UnitX()), y = turn(-0.9, Eigen::Vector3d::UnitY()),
             z = turn(2.2, Eigen::Vector3d::UnitZ());
  Eigen::Isometry3d pose = some_pose(0.0);
  pose.linear() = x * y * z;
  const Eigen::Isometry3d other = reordered(pose, "xyz", "zyx");
  EXPECT_LT((other.linear() - z * y * x).norm(), 1e-12);
  EXPECT_EQ(other.translation(), pose.translation());
  EXPECT_LT((reordered(other, "zyx", "xyz").linear() - pose.linear()).norm(), 1e-12);
  EXPECT_EQ(reordered(pose, "yxz", "yxz").matrix(), pose.matrix());
}

class TruthTable : public testing::Test {
 protected:
  std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "tron_truth_test.csv";

  void write(const std::string& row) const {
    std::ofstream out(file);
    out << "image,mounted,C_x_m,C_y_m,C_z_m,q_C_T_w,q_C_T_x,q_C_T_y,q_C_T_z,carriage_m";
    for (int k = 1; k <= 6; ++k) out << ",camera_A" << k << "_deg";
    for (int k = 1; k <= 6; ++k) out << ",target_A" << k << "_deg";
    out << "\n" << row;
  }
  ~TruthTable() override { std::filesystem::remove(file); }
};

TEST_F(TruthTable, GivesItsPosesByPosture) {
  std::vector<Measurement> measurements(2);
  measurements[1].posture.carriage_m = 2.0;
  measurements[1].posture.camera_rad[0] = 10.0 * M_PI / 180.0;
  write(
      "0,target,9,9,9,1,0,0,0,2,10,0,0,0,0,0,0,0,0,0,0,0\n1,board,0.1,0.2,3,1,0,0,0,2.0001,10.001,0,0,0,0,0,0,0,0,0,0,"
      "0\n");
  Eigen::Isometry3d T_T_B = Eigen::Isometry3d::Identity();
  T_T_B.translation().z() = 0.5;
  EXPECT_EQ(add_truth(measurements, file, T_T_B), 1);
  EXPECT_FALSE(measurements[0].true_T_C_T);
  ASSERT_TRUE(measurements[1].true_T_C_T);
  EXPECT_LT((measurements[1].true_T_C_T->translation() - Eigen::Vector3d(0.1, 0.2, 2.5)).norm(), 1e-12);
}

TEST_F(TruthTable, DamageIsRefused) {
  std::vector<Measurement> measurements(1);
  write("0,board,0.1,0.2,3,1,0,0,0,nan,0,0,0,0,0,0,0,0,0,0,0,0\n");
  EXPECT_THROW(add_truth(measurements, file, Eigen::Isometry3d::Identity()), std::runtime_error);
  write("0,board,\x1b[2J,0.2,3,1,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n");
  try {
    add_truth(measurements, file, Eigen::Isometry3d::Identity());
    ADD_FAILURE() << "a command to the terminal is not a number";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("column C_x_m: \"?[2J\" is not a finite number"), std::string::npos)
        << error.what();
  }
  write("0,board,0.1\n");
  EXPECT_THROW(add_truth(measurements, file, Eigen::Isometry3d::Identity()), std::runtime_error);
  EXPECT_THROW(add_truth(measurements, "/nowhere.csv", Eigen::Isometry3d::Identity()), std::runtime_error);
}

}  // namespace
}  // namespace vbar::tron::calibrate
