#pragma once
// One image: placement, lights, motion, measured pose, one correction, exposure.

#include <cstdint>
#include <optional>
#include <string>

#include "hil_drivers/tron/calibration_file/calibration.h"
#include "hil_drivers/tron/exchange/devices.h"
#include "hil_drivers/tron/tron_row.h"

namespace vbar::tron {

struct ExchangeSettings {
  double correct_above_m = 0.5e-3, correct_above_rad = 3.5e-4;
  double fail_above_m = 5e-3, fail_above_rad = 5.2e-3;
  double lamp_speed_rad_s = 0.17;
  double lamp_delay_s = 0.1;  ///< bench time: nothing acknowledges a lighting level
  int restarts_in_row = 2;    ///< interruptions of an image after which the run ends
  double slipped_chi_square =
      50.0;  ///< limit between arms and motion capture, six degrees of freedom: one in 10^8 of good ones
  int disagreements_in_row = 5;  ///< images at which arms and motion capture disagree, after which the run ends
};

struct SceneImage {
  std::vector<std::uint16_t> dn;                            ///< empty: there is none, see row.failure
  Eigen::Isometry3d T_C_T = Eigen::Isometry3d::Identity();  ///< as measured
  bool is_lit = false;
};

class ImageExchange {
 public:
  ImageExchange(const ExchangeSettings& settings, const Calibration& calibration, MotionPlanner& motion,
                LightPlanner& lights, Laboratory& laboratory)
      : settings_(settings), calibration_(calibration), motion_(motion), lights_(lights), laboratory_(laboratory) {}

  /// Takes an image and fills its parts of the row. Throws std::runtime_error if the testbed cannot go on.
  SceneImage take(const Scene& scene, std::int64_t number, double exposure_s, TronRow& row);

  /// Takes an image with all lights off; the arms stay.
  BenchFrame take_dark(double exposure_s);

 private:
  struct PoseError {
    double translation_m = 0.0, rotation_rad = 0.0;
  };
  struct Reached {
    Eigen::Isometry3d T_C_T;
    Posture posture;
    PoseError error;
  };

  std::optional<Reached> reach(const Scene& scene, std::int64_t number, TronRow& row, Place& place);
  bool go_to(const Posture& posture, TronRow& row);
  std::optional<Reached> measure(const Scene& scene, TronRow& row);
  void set_lights(const LightLevels& levels);
  bool wait_for_lamp();

  ExchangeSettings settings_;
  const Calibration& calibration_;
  MotionPlanner& motion_;
  LightPlanner& lights_;
  Laboratory& laboratory_;
  std::optional<double> lamp_azimuth_rad_;  ///< as sent last
  double lights_ready_s_ = 0.0;             ///< bench time
  int disagreements_ = 0;
};

}  // namespace vbar::tron
