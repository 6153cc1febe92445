#pragma once
// The first relative orbit: all bearings of the first half hour or so against one arc of the target's, by
// Gauss-Newton with Levenberg's damping, what was known beforehand weighing in as a measurement of its own. Bearings of
// a short arc fix the orbit but for its size, and that remains what was known beforehand; so there is one minimum, and
// it lies near the start.

#include <array>
#include <cstddef>
#include <cstdint>

#include "fsw/core/result.h"
#include "fsw/navigation/bearing.h"
#include "fsw/navigation/propagation.h"
#include "fsw/orbit/earth_rotation.h"

namespace vbar::fsw::navigation {

struct BearingBatchSettings {
  int bearings = 40;              ///< so many make an orbit; at most BearingBatch::kCapacity
  double bias_sigma = 1.5e-5;     ///< rad, of what all bearings share, each axis
  double least_share_used = 0.6;  ///< of the bearings, or the solution is none
  double most_chi_square = 2.0;   ///< of a degree of freedom, of the bearings used
};

/// ROE of the target with respect to the servicer at the batch's last bearing (dimensionless), and what all bearings
/// have in common of error (rad, as in bearing_axes()), with the covariance of the eight.
struct BatchSolution {
  Vector6 roe = Vector6::Zero();
  Vector2 bias = Vector2::Zero();
  Eigen::Matrix<double, 8, 8> covariance = Eigen::Matrix<double, 8, 8>::Zero();
  int used = 0;
  double chi_square = 0.0;  ///< of a degree of freedom
};

class BearingBatch {
 public:
  static constexpr std::size_t kCapacity = 120;
  static constexpr std::size_t kLeastBearings = 10;

  void clear() {
    count_ = 0;
    burn_count_ = 0;
  }
  /// In order of time. If there is no room the older half goes.
  void add(const BearingMeasurement& bearing);
  /// A burn of the servicer. One before the first bearing is left out; with no room for it the batch begins anew.
  void add_burn(GpsTime time, const Vector3& dv_eci);
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] GpsTime first_time() const { return bearings_[0].time; }
  [[nodiscard]] GpsTime last_time() const { return bearings_[count_ - 1].time; }

  /// `servicer` at the last bearing's time; `prior_roe` and its covariance are of that time too. Reads no more than it
  /// is given; kNotReady with fewer than ten bearings, kDidNotConverge, kSingular, kOutOfRange if too few bearings fit
  /// or those that do not well enough.
  Result<BatchSolution> solve(const orbit::CartesianState& servicer, const Vector6& prior_roe,
                              const Matrix6& prior_covariance, const orbit::EarthOrientation& earth,
                              const Vector3& sun_eci, const BearingBatchSettings& settings);

 private:
  static constexpr int kUnknowns = 8;  ///< six ROE, two of bias
  static constexpr int kOrbits = 14;   ///< servicer, target, and it with each element a little more and less
  static constexpr std::size_t kMaxBurns = 32;
  using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
  using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;
  struct ImpulseAt {
    GpsTime time;
    Vector3 dv_eci = Vector3::Zero();
  };
  struct Linearised {
    Normal normal = Normal::Zero();
    Unknowns right = Unknowns::Zero();
    double cost = 0.0;
    double chi_square_of_used = 0.0;
    int used = 0;
  };

  Status linearise(const orbit::CartesianState& servicer, const Unknowns& x, const orbit::EarthOrientation& earth,
                   const Vector3& sun_eci, Linearised& result);

  std::array<BearingMeasurement, kCapacity> bearings_{};
  std::size_t count_ = 0;
  std::array<ImpulseAt, kMaxBurns> burns_{};
  std::size_t burn_count_ = 0;
};

}  // namespace vbar::fsw::navigation
