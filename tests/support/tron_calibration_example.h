#pragma once
// A calibration of TRON in which every figure differs from its default.

#include "hil_drivers/tron/geometry/calibration.h"

namespace vbar::tests {

inline tron::Calibration tron_calibration_example() {
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

}  // namespace vbar::tests
