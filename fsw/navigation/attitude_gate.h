#pragma once
// Gate for attitudes of the servicer, which rejects those of a star tracker in error: they contradict both the attitude
// that the gyro propagates and the commanded one. The propagated or the commanded attitude replaces a rejected one.
//
// The propagation by the gyro continues through rejections. A step of the tracker contradicts it for as long as the
// drift of the gyro stays small against the step. Stars in an image of the camera restart the propagation.

#include <optional>

#include "fsw/core/types.h"
#include "fsw/measurements/pointing.h"

namespace vbar::fsw::navigation {

class AttitudeGate {
 public:
  /// Largest accepted difference: many times the control error of a platform and the drift of a gyro over
  /// kLongestPropagation.
  static constexpr double kLargestDifference = 0.01;  // rad
  /// Longest propagation by the gyro: at 0.3 deg/h the drift is then a quarter of kLargestDifference.
  static constexpr Duration kLongestPropagation = duration_of_seconds(1800);

  /// Verdict on a sample. `used` is the sample itself if it is accepted. Otherwise `used` has its time and rate with
  /// the attitude that replaces it, or is empty without such an attitude.
  struct Verdict {
    bool is_accepted = false;
    std::optional<measurements::AttitudeSample> used;
  };

  /// Judges a sample. `R_body_eci_commanded` holds at the time of the sample and is empty without a command. A sample
  /// that no other attitude can judge is accepted.
  [[nodiscard]] Verdict judge(const measurements::AttitudeSample& sample,
                              const std::optional<Matrix3>& R_body_eci_commanded);

  /// Accepts the attitude by the stars of an image. The propagation restarts from it if the propagated attitude
  /// contradicts it, or while the tracker is rejected.
  void take_stars(GpsTime time, const Matrix3& R_eci_body);

  /// Returns the smaller of both differences of the last sample, rad.
  [[nodiscard]] double difference() const { return difference_; }

 private:
  [[nodiscard]] std::optional<Matrix3> propagated_to(const measurements::AttitudeSample& sample) const;

  std::optional<measurements::AttitudeSample> gyro_;  ///< propagated to the last sample
  GpsTime anchored_;                                  ///< time of the last attitude that was not propagated
  bool follows_commands_ = false;                     ///< the platform has reached a commanded attitude
  double control_error_ =
      0.0;                    ///< rad, difference of the last accepted sample from its command, if it follows commands
  bool is_refusing_ = false;  ///< the last sample was rejected
  double difference_ = 0.0;
};

}  // namespace vbar::fsw::navigation
