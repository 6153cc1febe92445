#pragma once
// Initial relative orbit determination: all bearings of about the first half hour fitted by one arc of the target, by
// Gauss-Newton with Levenberg damping and the a-priori orbit as a measurement of its own. Bearings of a short arc
// determine the orbit except for its scale, which remains that of the a-priori orbit; there is therefore one minimum,
// close to the initial value.

#include <array>
#include <cstddef>
#include <cstdint>

#include "fsw/core/result.h"
#include "fsw/filter/propagation.h"
#include "fsw/orbit/earth_rotation.h"
#include "fsw/vision/target_tracking/bearing.h"

namespace vbar::fsw::measurements {

struct BearingBatchSettings {
  int bearings = 40;            ///< number required for a solution; at most BearingBatch::kCapacity
  double bias_sigma = 1.5e-5;   ///< rad, common bias of all bearings, per axis
  double min_share_used = 0.6;  ///< of the bearings, otherwise there is no solution
  double max_chi_square = 2.0;  ///< per degree of freedom, of the bearings used

  bool operator==(const BearingBatchSettings&) const = default;
};

/// ROE of the target with respect to the servicer at the last bearing of the batch (dimensionless), and the common
/// bias of all bearings (rad, as in bearing_axes()), with the covariance of the eight.
struct BatchSolution {
  Vector6 roe = Vector6::Zero();
  Vector2 bias = Vector2::Zero();
  Eigen::Matrix<double, 8, 8> covariance = Eigen::Matrix<double, 8, 8>::Zero();
  int used = 0;
  double chi_square = 0.0;  ///< per degree of freedom
};

class BearingBatch {
 public:
  static constexpr std::size_t kCapacity = 120;
  static constexpr std::size_t kMinBearings = 10;

  void clear() {
    count_ = 0;
    burn_count_ = 0;
  }
  /// Adds a bearing, in order of time. If the batch is full the older half is discarded.
  void add(const target_tracking::BearingMeasurement& bearing);
  /// A burn of the servicer. One before the first bearing is ignored; if the list is full the batch restarts.
  void add_burn(GpsTime time, const Vector3& dv_eci);
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] GpsTime first_time() const { return bearings_[0].time; }
  [[nodiscard]] GpsTime last_time() const { return bearings_[count_ - 1].time; }

  static constexpr int kUnknowns = 8;  ///< six ROE, two of bias
  using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
  using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;
  /// Normal equations of all bearings about a solution: chi-square + 2 right' dx - dx' normal dx.
  struct NormalEquations {
    Normal normal = Normal::Zero();
    Unknowns right = Unknowns::Zero();
    double chi_square = 0.0;
    int bearings = 0;
  };
  static Unknowns unknowns_of(const Vector6& roe) {
    Unknowns x = Unknowns::Zero();
    x.head<6>() = roe;
    return x;
  }
  /// Without robust weights, about `x` at the time of the last bearing. kNotReady without bearings.
  Result<NormalEquations> normal_equations(const orbit::CartesianState& servicer, const Unknowns& x,
                                           const orbit::EarthOrientation& earth, const Vector3& sun_eci);

  /// `servicer` at the time of the last bearing; `prior_roe` and its covariance are of that time too. Has no side
  /// effects; kNotReady with fewer than ten bearings, kDidNotConverge, kSingular, kOutOfRange if too few bearings fit
  /// or those used do not fit well enough.
  Result<BatchSolution> solve(const orbit::CartesianState& servicer, const Vector6& prior_roe,
                              const Matrix6& prior_covariance, const orbit::EarthOrientation& earth,
                              const Vector3& sun_eci, const BearingBatchSettings& settings);

 private:
  static constexpr int kOrbits = 8;  ///< servicer, target, and the target with each element increased
  static constexpr std::size_t kMaxBurns = 32;
  struct ImpulseAt {
    GpsTime time;
    Vector3 dv_eci = Vector3::Zero();
  };
  struct Linearised : NormalEquations {
    double cost = 0.0;
    double chi_square_of_used = 0.0;
    int used = 0;
  };

  Status linearise(const orbit::CartesianState& servicer, const Unknowns& x, const orbit::EarthOrientation& earth,
                   const Vector3& sun_eci, double huber, Linearised& result);

  std::array<target_tracking::BearingMeasurement, kCapacity> bearings_{};
  std::size_t count_ = 0;
  std::array<ImpulseAt, kMaxBurns> burns_{};
  std::size_t burn_count_ = 0;
};

}  // namespace vbar::fsw::measurements
