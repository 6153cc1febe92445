#pragma once
// Is a supposed attitude true? The catalogue is laid over the image: if more objects have a star at their place than
// chance can put there, it is. Chance is counted: objects that are no stars agree with the catalogue's density times
// the area of tolerance; the number of agreements is then bounded by Chernoff's inequality.

#include <array>
#include <span>

#include "fsw/core/result.h"
#include "fsw/stars/attitude_determination.h"
#include "fsw/stars/observation.h"
#include "fsw/stars/star_lookup.h"

namespace vbar::fsw::stars {

/// A supposed attitude and what it cost to come by it.
struct Supposition {
  Matrix3 R_camera_eci = Matrix3::Identity();
  double sigma_rad = 0.0;    ///< error to be expected, anywhere in the image
  int agreements_spent = 0;  ///< matches that were assumed to make it: two for a pair, one for an offset
  int hypotheses = 1;        ///< tried so far for this image
};

/// ln of a bound on the probability that `expected` (mean) chance agreements become `count` or more (Chernoff 1952); 0
/// where count <= expected.
double log_chance_of(int count, double expected);

/// An identification is accepted where chance would give fewer than this many of its kind in an image.
inline constexpr double kLogAcceptedChance = -16.118;  // ln 1e-7
inline constexpr int kFewestMatches = 4;

class Verification {
 public:
  /// Fills `fix` and returns kOk where the supposition is accepted; else kDidNotConverge, and `fix` is of no use.
  /// Objects must be finite with positive sigma, at most kMaxObjects.
  Status verify(std::span<const ObservedStar> objects, const Field& field, const Vector3& velocity_over_c_eci,
                const Supposition& supposed, AttitudeFix& fix);

 private:
  void match(std::span<const ObservedStar> objects, const Vector3& velocity_over_c_eci, const Matrix3& R_camera_eci,
             const Matrix3& covariance_camera, const MagnitudeGate& gate);
  void add_match(int object, const Neighbour& neighbour);
  double median_magnitude_offset(std::span<const ObservedStar> objects);
  double star_density(const Vector3& centre_eci, double radius);

  std::size_t count_ = 0;
  double tolerance_area_ = 0.0;  ///< of all objects tried, sr
  std::array<int, imaging::kMaxObjects> object_{};
  std::array<Neighbour, imaging::kMaxObjects> star_{};
  std::array<DirectionPair, imaging::kMaxObjects> pair_{};
  std::array<int, imaging::kMaxObjects> tag_{};
  std::array<double, imaging::kMaxObjects> offset_{};
  std::array<int, 4096> in_field_{};
};

}  // namespace vbar::fsw::stars
