#pragma once
// Pointing of a camera.

#include <array>
#include <cstddef>
#include <optional>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::measurements {

/// Commanded line of sight: a direction in the servicer's RTN with a constant rate.
struct Pointing {
  GpsTime time;
  Vector3 boresight_rtn = Vector3::Zero();       ///< unit vector
  Vector3 boresight_rate_rtn = Vector3::Zero();  ///< 1/s

  [[nodiscard]] Vector3 boresight_rtn_at(GpsTime at) const {
    return (boresight_rtn + seconds(at - time) * boresight_rate_rtn).normalized();
  }
};

/// To the centre of the target. kOutOfRange if the distance is zero.
Result<Pointing> pointing_at(GpsTime time, const orbit::CartesianState& servicer, const orbit::CartesianState& target);

/// Body axes of the servicer under a pointing command: z along the boresight, -y as close to the zenith as possible.
/// The platform follows the same convention.
Matrix3 R_body_eci_of(const Pointing& pointing, GpsTime time, const orbit::CartesianState& servicer);

// The attitudes of one spacecraft as reported by its sensors, interpolated to the time tags of other measurements.

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

}  // namespace vbar::fsw::measurements
