#pragma once
// Star identification and attitude of the camera: without prior attitude (lost in space) or near a predicted attitude
// (tracking). Both generate attitude hypotheses that verification.h accepts or rejects, so that the same confidence
// holds for both: false objects may be many and bright, and an identification that could be due to chance is rejected.

#include <array>
#include <span>

#include "fsw/core/result.h"
#include "fsw/vision/stars/attitude_determination.h"
#include "fsw/vision/stars/verification.h"

namespace vbar::fsw::stars {

/// Work limit of a lost-in-space identification: pairs of objects are tried, brightest first, until one fits or this
/// many catalogue pairs have been matched.
inline constexpr int kMaxHypotheses = 180'000;
/// Number of the brightest objects used in patterns.
inline constexpr std::size_t kMaxPatternObjects = 48;
/// Largest tolerance of a predicted attitude, rad (1 degree).
inline constexpr double kLargestTolerance = 0.0175;

/// Identifies the stars of an image. Its 95 kB are mostly workspace: between calls only the last fix is kept.
class StarIdentifier {
 public:
  /// Determines the attitude of a camera with unknown pointing. `velocity_over_c_eci` is the observer's barycentric
  /// velocity over the speed of light, for aberration. kOk: fix() holds the attitude. kDidNotConverge: no reliable
  /// solution. kTooLong: more than kMaxObjects; kNotFinite; kInvalidArgument: a sigma or the field's radius is not
  /// positive.
  /// Two stars of the catalogue's pair table with the separation of two objects yield an attitude (Black 1974); the
  /// other objects confirm or reject it.
  Status lost_in_space(std::span<const ObservedStar> objects, const Field& field, const Vector3& velocity_over_c_eci);

  /// Determines the attitude near a predicted one, within a rotation of `tolerance_rad` about any axis. Each object
  /// votes for the shifts that would map a star of the neighbourhood to it; the shifts with most votes are verified.
  /// Errors are those of lost_in_space, and kOutOfRange: tolerance above kLargestTolerance.
  Status track(std::span<const ObservedStar> objects, const Field& field, const Matrix3& predicted_R_camera_eci,
               double tolerance_rad, const Vector3& velocity_over_c_eci);

  /// Attitude of the last call that returned kOk.
  [[nodiscard]] const AttitudeFix& fix() const { return fix_; }

 private:
  struct Vote {
    int object = 0;
    int star = 0;
    Vector2 shift = Vector2::Zero();
    int support = 0;
  };
  static constexpr std::size_t kMaxVotes = 512;
  static constexpr int kMaxSeeds = 5;

  /// Data common to all hypotheses of a pair of objects.
  struct Pattern {
    Matrix3 R_camera_pattern = Matrix3::Identity();
    std::size_t others = 0;
    std::array<std::size_t, kMaxPatternObjects> object{};
    std::array<Vector3, kMaxPatternObjects> direction{};  ///< pattern axes
    std::array<double, kMaxPatternObjects> tolerance{};
  };

  std::size_t sort_pattern_objects(std::span<const ObservedStar> objects);
  void make_pattern(std::span<const ObservedStar> objects, std::size_t count, std::size_t i, std::size_t j);
  Status try_pair(std::span<const ObservedStar> objects, const Field& field, const Vector3& velocity_over_c_eci,
                  std::size_t i, std::size_t j);
  Status try_hypothesis(std::span<const ObservedStar> objects, const Field& field, const Vector3& velocity_over_c_eci,
                        const Vector3& first_eci, const Vector3& second_eci);
  std::size_t cast_votes(std::span<const ObservedStar> objects, const Field& field, const Matrix3& R_camera_eci,
                         double tolerance, const Vector3& velocity_over_c_eci);
  void count_support(std::size_t votes, double radius);
  Status try_seed(std::span<const ObservedStar> objects, const Field& field, const Vector3& velocity_over_c_eci,
                  std::size_t votes, const Vote& seed, double radius);

  AttitudeFix fix_;
  AttitudeFix trial_;
  Verification verification_;
  int hypotheses_ = 0;
  std::array<std::size_t, imaging::kMaxObjects> order_{};
  Pattern pattern_;
  std::array<Vote, kMaxVotes> vote_{};
  std::array<int, 4096> in_cone_{};
  std::array<DirectionPair, imaging::kMaxObjects> seed_pair_{};
};

/// Checks the input common to both methods.
Status check_objects(std::span<const ObservedStar> objects, const Field& field, const Vector3& velocity_over_c_eci);

}  // namespace vbar::fsw::stars
