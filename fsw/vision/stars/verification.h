#pragma once
// Verification of an attitude hypothesis. The catalogue is compared with the image: if more objects have a star at
// their position than chance can explain, the hypothesis is accepted. False objects agree by chance with the catalogue
// density times the tolerance area; the probability of the number of agreements is bounded by Chernoff's inequality.

#include <array>
#include <span>

#include "fsw/core/result.h"
#include "fsw/vision/stars/attitude_determination.h"
#include "fsw/vision/stars/star_lookup.h"

namespace vbar::fsw::stars {

/// An attitude hypothesis and the degrees of freedom used to find it.
struct AttitudeHypothesis {
  Matrix3 R_camera_eci = Matrix3::Identity();
  double sigma_rad = 0.0;    ///< expected error, anywhere in the image
  int agreements_spent = 0;  ///< matches assumed by the hypothesis itself: two for a pair, one for an offset
  int hypotheses = 1;        ///< tried so far for this image
};

/// Returns ln of a bound on the probability that `expected` (mean) chance agreements become `count` or more (Chernoff
/// 1952); 0 where count <= expected.
double log_chance_of(int count, double expected);

/// An identification is accepted if chance would produce fewer than this many of its kind in an image.
inline constexpr double kLogAcceptedChance = -16.118;  // ln 1e-7
inline constexpr int kFewestMatches = 4;

class Verification {
 public:
  /// Fills `fix` and returns kOk if the hypothesis is accepted; otherwise kDidNotConverge, and `fix` is not valid.
  /// Objects must be finite with positive sigma, at most kMaxObjects.
  Status verify(std::span<const ObservedStar> objects, const Field& field, const Vector3& velocity_over_c_eci,
                const AttitudeHypothesis& supposed, AttitudeFix& fix);

 private:
  void match(std::span<const ObservedStar> objects, const Vector3& velocity_over_c_eci, const Matrix3& R_camera_eci,
             const Matrix3& covariance_camera, const MagnitudeGate& gate);
  void add_match(int object, const Neighbour& neighbour);
  double median_magnitude_offset(std::span<const ObservedStar> objects);
  double star_density(const Vector3& centre_eci, double radius);

  std::size_t count_ = 0;
  double tolerance_area_ = 0.0;  ///< tolerance area of all objects tried, sr
  std::array<int, imaging::kMaxObjects> object_{};
  std::array<Neighbour, imaging::kMaxObjects> star_{};
  std::array<DirectionPair, imaging::kMaxObjects> pair_{};
  std::array<int, imaging::kMaxObjects> tag_{};
  std::array<double, imaging::kMaxObjects> offset_{};
  std::array<int, 4096> in_field_{};
};

}  // namespace vbar::fsw::stars
