#pragma once
// Initial pose, rate and relative orbit from single-image poses (perspective n points).
//
// Such a pose may be grossly wrong - rotated by half a revolution, or with confused keypoints - so only a consensus of
// several images is used: an attitude and rate consistent with most of them, and a relative orbit through their
// positions.

#include <array>
#include <cstddef>

#include "fsw/core/gps_time.h"
#include "fsw/filter/target_attitude.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::measurements {

struct PoseInitialiserSettings {
  int min_images = 3;               ///< minimum consensus
  double agreement = 0.26;          ///< rad, 15 deg: tolerance of an attitude with respect to the motion of the others
  double max_rate = 0.1;            ///< rad/s; a larger rate is rejected
  double attitude_sigma = 0.06;     ///< rad, attitude error of a single image in addition to its own covariance
  double range_sigma_share = 0.02;  ///< range error of a single image in addition to its own covariance
  /// A-priori distribution of the formation: zero mean, 1 sigma of the mean a * ROE, m. It is needed above all for the
  /// difference in semi-major axis, i.e. the drift, which is hardly observable from the poses of a quarter of a minute.
  Vector6 sigma_a_roe_m{1.0, 100.0, 5.0, 5.0, 5.0, 5.0};
  double position_gate = 25.0;  ///< of a position's normalised residual squared
};

/// A single-image pose.
struct PoseSample {
  GpsTime time;
  orbit::CartesianState servicer;
  Vector3 relative_eci = Vector3::Zero();    ///< target from servicer, centres of mass, m
  Matrix3 covariance_eci = Matrix3::Zero();  ///< m^2
  Eigen::Quaterniond q_eci_body = Eigen::Quaterniond::Identity();
  double attitude_sigma = 0.0;  ///< rad
};

struct AttitudeStart {
  filter::AttitudeState attitude;
  Matrix6 covariance = Matrix6::Identity();  ///< rotation in body axes, rate
  int agreeing = 0;
};

struct OrbitStart {
  Vector6 roe = Vector6::Zero();
  Matrix6 covariance = Matrix6::Identity();
  int used = 0;
};

class PoseInitialiser {
 public:
  static constexpr std::size_t kMaxSamples = 12;

  void configure(const PoseInitialiserSettings& settings, const filter::Inertia& inertia) {
    settings_ = settings;
    inertia_ = inertia;
    clear();
  }
  void clear() { size_ = 0; }
  /// A burn of the servicer: positions before it are discarded, attitudes are kept.
  void interrupt_orbit() { orbit_from_ = size_; }
  /// Discards the oldest if full, and samples older than 75 s.
  void add(const PoseSample& sample);
  [[nodiscard]] std::size_t size() const { return size_; }

  /// At the time of the last sample. kNotReady with too few samples, kDidNotConverge if too few agree.
  [[nodiscard]] Result<AttitudeStart> attitude() const;
  /// Returns the orbit with respect to the servicer at the last sample.
  [[nodiscard]] Result<OrbitStart> orbit() const;

 private:
  struct Agreement {
    int count = 0;
    double squares = 0.0;
    std::array<bool, kMaxSamples> is_in{};
    std::array<Vector3, kMaxSamples> misses{};  ///< rad, body axes: sample against motion
  };

  [[nodiscard]] Agreement agreement_with(const filter::AttitudeState& attitude, std::size_t at) const;
  [[nodiscard]] double seconds_between(std::size_t from, std::size_t to) const {
    return seconds(samples_[to].time - samples_[from].time);
  }

  PoseInitialiserSettings settings_;
  filter::Inertia inertia_;
  std::array<PoseSample, kMaxSamples> samples_{};
  std::size_t size_ = 0;
  std::size_t orbit_from_ = 0;
};

}  // namespace vbar::fsw::measurements
