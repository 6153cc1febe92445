#pragma once
// The attitudes of one spacecraft as reported by its sensors, interpolated to the time tags of other measurements.

#include <array>
#include <cstddef>
#include <optional>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"

namespace vbar::fsw::navigation {

struct AttitudeSample {
  GpsTime time;
  Matrix3 R_eci_body = Matrix3::Identity();
  Vector3 rate_body = Vector3::Zero();  ///< rad/s, of the body with respect to ECI
};

/// The attitude after a rotation by `angle_body` (rad, a vector in body axes).
[[nodiscard]] Matrix3 rotated(const Matrix3& R_eci_body, const Vector3& angle_body);

class AttitudeHistory {
 public:
  void put(const AttitudeSample& sample);

  /// At `time`, propagated by the rate from the nearest sample; no value if that is more than kReach away.
  [[nodiscard]] std::optional<Matrix3> R_eci_body_at(GpsTime time) const;

  static constexpr Duration kReach = duration_of_seconds(30);
  static constexpr std::size_t kSamples = 64;

 private:
  std::array<AttitudeSample, kSamples> samples_{};
  std::size_t count_ = 0;
  std::size_t next_ = 0;  ///< the oldest, once all are in use
};

}  // namespace vbar::fsw::navigation
