#pragma once
// A first pose, rate and relative orbit from the poses that single images gave (perspective n points).
//
// Such a pose may be quite wrong - turned half about, on another keypoint's place - so only what several images in a
// row agree on counts: an attitude and rate that lead through most of them, a relative orbit that passes their
// positions.

#include <array>
#include <cstddef>

#include "fsw/core/gps_time.h"
#include "fsw/navigation/pose_attitude.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::navigation {

struct PoseStartSettings {
  int least_images = 3;             ///< that agree
  double agreement = 0.26;          ///< rad, 15 deg: of an attitude with the motion of the others
  double most_rate = 0.1;           ///< rad/s; a faster turn is none
  double attitude_sigma = 0.06;     ///< rad, of one image's attitude beside what it says itself
  double range_sigma_share = 0.02;  ///< of one image's distance beside what it says itself
  /// What the formation may be, known beforehand: 1 sigma about none at all of the mean a * ROE, m. Above all the
  /// difference in semi-major axis, which makes the two drift apart: in a quarter of a minute poses say little of it.
  Vector6 sigma_a_roe_m{1.0, 100.0, 5.0, 5.0, 5.0, 5.0};
  double position_gate = 25.0;  ///< of a position's normalised residual squared
};

/// One image's pose.
struct PoseSample {
  GpsTime time;
  orbit::CartesianState servicer;
  Vector3 relative_eci = Vector3::Zero();    ///< target from servicer, centres of mass, m
  Matrix3 covariance_eci = Matrix3::Zero();  ///< m^2
  Eigen::Quaterniond q_eci_body = Eigen::Quaterniond::Identity();
  double attitude_sigma = 0.0;  ///< rad
};

struct AttitudeStart {
  AttitudeState attitude;
  Matrix6 covariance = Matrix6::Identity();  ///< turn in body axes, rate
  int agreeing = 0;
};

struct OrbitStart {
  Vector6 roe = Vector6::Zero();
  Matrix6 covariance = Matrix6::Identity();
  int used = 0;
};

class PoseStart {
 public:
  static constexpr std::size_t kMost = 12;

  void configure(const PoseStartSettings& settings, const Inertia& inertia) {
    settings_ = settings;
    inertia_ = inertia;
    clear();
  }
  void clear() { size_ = 0; }
  /// The servicer burnt: positions from before count no more, attitudes do.
  void interrupt_orbit() { orbit_from_ = size_; }
  /// Drops the oldest where it is full, and what is older than 75 s.
  void add(const PoseSample& sample);
  [[nodiscard]] std::size_t size() const { return size_; }

  /// At the time of the last sample. kNotReady with too few, kDidNotConverge where too few agree.
  [[nodiscard]] Result<AttitudeStart> attitude() const;
  /// The same, with respect to the servicer at the last sample.
  [[nodiscard]] Result<OrbitStart> orbit() const;

 private:
  struct Agreement {
    int count = 0;
    double squares = 0.0;
    std::array<bool, kMost> is_in{};
    std::array<Vector3, kMost> misses{};  ///< rad, body axes: sample against motion
  };

  [[nodiscard]] Agreement agreement_with(const AttitudeState& attitude, std::size_t at) const;
  [[nodiscard]] double seconds_between(std::size_t from, std::size_t to) const {
    return seconds(samples_[to].time - samples_[from].time);
  }

  PoseStartSettings settings_;
  Inertia inertia_;
  std::array<PoseSample, kMost> samples_{};
  std::size_t size_ = 0;
  std::size_t orbit_from_ = 0;
};

}  // namespace vbar::fsw::navigation
