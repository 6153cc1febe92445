#pragma once
// Attitudes of the servicer that a star tracker in error would give: they contradict both the attitude that its gyro
// propagates and the one that is commanded. In place of a refused attitude the propagated or the commanded one is used.
//
// The gyro continues through refusals: a step of the tracker contradicts it for as long as its drift stays small
// against the step. Stars in an image of the camera restart it.

#include <optional>

#include "fsw/core/types.h"
#include "fsw/navigation/attitude_history.h"

namespace vbar::fsw::gnc {

class AttitudeGate {
 public:
  /// Many times what a platform's control error and the drift of a gyro over kLongestPropagation amount to.
  static constexpr double kLargestDifference = 0.01;  // rad
  /// The drift of a gyro of 0.3 deg/h is a quarter of kLargestDifference after this time.
  static constexpr Duration kLongestPropagation = duration_of_seconds(1800);

  /// `used`: the sample itself if it is accepted; otherwise its time and rate with the attitude that replaces it, empty
  /// if there is none.
  struct Verdict {
    bool is_accepted = false;
    std::optional<navigation::AttitudeSample> used;
  };

  /// `R_body_eci_commanded`: at the time of the sample, empty without a command. What no other attitude can judge is
  /// accepted.
  [[nodiscard]] Verdict judge(const navigation::AttitudeSample& sample,
                              const std::optional<Matrix3>& R_body_eci_commanded);

  /// The attitude by the stars of an image. If the propagated one contradicts it, or if the tracker is being refused,
  /// the propagation restarts from it.
  void take_stars(GpsTime time, const Matrix3& R_eci_body);

  /// The smaller of both differences of the last sample, rad.
  [[nodiscard]] double difference() const { return difference_; }

 private:
  [[nodiscard]] std::optional<Matrix3> propagated_to(const navigation::AttitudeSample& sample) const;

  std::optional<navigation::AttitudeSample> gyro_;  ///< propagated to the last sample
  GpsTime anchored_;                                ///< the last attitude that was not propagated
  bool follows_commands_ = false;                   ///< the platform has been where it was commanded
  double control_error_ = 0.0;  ///< rad, of the last accepted sample against its command, if it follows commands
  bool is_refusing_ = false;    ///< the last sample
  double difference_ = 0.0;
};

}  // namespace vbar::fsw::gnc
