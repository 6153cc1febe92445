#pragma once
// Attitudes of the servicer that a star tracker in error would give: they contradict both the attitude that its gyro
// propagates and the one that is commanded.

#include <optional>

#include "fsw/core/types.h"
#include "fsw/navigation/attitude_history.h"
#include "fsw/sources/pointing.h"

namespace vbar::fsw::gnc {

class AttitudeGate {
 public:
  /// Many times what a platform's control error and the drift of a gyro over half a minute amount to.
  static constexpr double kLargestDifference = 0.01;  // rad

  /// Whether `sample` may be used. `history`: the attitudes accepted so far; `R_body_eci_commanded`: at its time, empty
  /// without a command. What no other attitude can judge is accepted.
  [[nodiscard]] bool accepts(const navigation::AttitudeSample& sample, const navigation::AttitudeHistory& history,
                             const std::optional<Matrix3>& R_body_eci_commanded);

  /// The smaller of both differences of the last sample, rad.
  [[nodiscard]] double difference() const { return difference_; }

 private:
  bool follows_commands_ = false;  ///< the platform has been where it was commanded
  double difference_ = 0.0;
};

}  // namespace vbar::fsw::gnc
