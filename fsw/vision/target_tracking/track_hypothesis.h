#pragma once
// One hypothesis on which object of each image was the same satellite.

#include <array>
#include <cstddef>
#include <cstdint>

#include "fsw/vision/target_tracking/relative_motion.h"

namespace vbar::fsw::target_tracking {

inline constexpr std::size_t kMaxHypotheses = 64;
inline constexpr std::size_t kHistory = 8;  ///< images

inline constexpr double kMaxMisfit = 9.0;  ///< largest Hypothesis::misfit: (3 sigma)^2

/// Entries of a hypothesis' history that are not an index of a candidate.
inline constexpr std::int16_t kMissed = -1;
inline constexpr std::int16_t kUnborn = -2;

struct Hypothesis {
  RelativeMotion motion;
  std::uint32_t track = 0;            ///< hypotheses of one track began with the same object
  double score = 0.0;                 ///< log-likelihood ratio against false detections only (Sittler 1964)
  double misfit = 1.0;                ///< running mean of the normalised innovation squared, per degree of freedom
  double log_flux = 0.0;              ///< running mean
  double apparent_radius = 0.0;       ///< rad, running mean
  double sigma = 0.0;                 ///< 1 sigma of its last object, rad
  double distance = 0.0;              ///< from the prediction (chi-square, 5 degrees of freedom)
  double identity = 0.0;              ///< log-likelihood ratio of being the target against being another satellite
  double kept_distance = 0.0;         ///< from the prediction of the orbit that was replaced, as `distance`
  double kept_identity = 0.0;         ///< log-likelihood ratio of moving as it predicts against any motion
  std::int32_t hits = 0;              ///< number of objects, in all
  std::int32_t hits_since_gap = 0;    ///< number of objects since its last long gap
  std::int32_t images_since_hit = 0;  ///< number of images, in which it was expected, since its last object
  std::uint32_t recent = 0;  ///< one bit per image in which it was expected or seen, newest lowest: 1 seen, and the
                             ///< object was not that of a better track
  std::int32_t images_beside = 0;                ///< number of images in which another track was certainly the target
  bool established = false;                      ///< was seen in M of N images with residuals as expected
  std::array<std::int16_t, kHistory> history{};  ///< candidates by image, newest first
};

/// A possible continuation of a hypothesis in an image.
struct Branch {
  std::int16_t parent = -1;     ///< -1: a new track
  std::int16_t candidate = -1;  ///< kMissed: none
  bool established = false;     ///< the parent is established
  double score = 0.0;
};

/// Returns true if both contain the same object in the last `images` images, and at least two objects.
bool share_recent(const Hypothesis& a, const Hypothesis& b, std::size_t images);

/// Returns true if their histories have at least two objects in common and never different objects in one image.
bool agree(const Hypothesis& a, const Hypothesis& b);

/// Returns the number of images of its history in which `a` contains an object that `b` does not.
int objects_of_its_own(const Hypothesis& a, const Hypothesis& b);

/// Returns the number of ones among the lowest `count` bits.
int hits_of(std::uint32_t bits, int count);

}  // namespace vbar::fsw::target_tracking
