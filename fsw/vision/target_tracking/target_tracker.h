#pragma once
// Identification of the target in an image: multi-hypothesis tracking (Reid 1979; track-oriented, after Blackman 2004)
// of all objects that move like satellites near the servicer, and selection of the one that moves as navigation
// predicts for the target. Ambiguous objects are not selected: no bearing is better than one to another object.
//
// Kinematics form tracks, navigation selects one of them. The two are separated because the noise of two satellites'
// bearings contains no information on which of them is the target: tracks are scored without the prediction (beyond its
// gate), and compared by the likelihood ratio of their relative orbits: an orbit as predicted against any.
//
// A target that was lost is searched in a wide region (search_region.h), where motion alone tells less. Its history
// then counts as well: brightness and apparent size that it had, reduced to one distance, and tracks that were seen
// beside it.
//
// An object belongs to one satellite. Detections that a better track shares do not establish a track.

#include <array>
#include <optional>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/vision/target_tracking/hot_pixel_map.h"
#include "fsw/vision/target_tracking/prediction.h"
#include "fsw/vision/target_tracking/relative_motion.h"
#include "fsw/vision/target_tracking/track_hypothesis.h"

namespace vbar::fsw::target_tracking {

struct TrackerSettings {
  MotionSettings motion;
  HotPixelSettings hot_pixels;
  double field_sr = 0.0113;        ///< solid angle of the search for candidates: 4.8 by 7.7 degrees
  double surroundings = 0.03;      ///< rad about the predicted bearing in which other satellites are tracked as well
  double association_gate = 13.8;  ///< chi-square, 2 degrees of freedom: 99.9 %
  double prediction_gate = 18.4;   ///< the same about the predicted bearing: 99.99 %
  double identity_gate = 25.7;     ///< chi-square, 5 degrees of freedom: 99.99 %
  double identity_margin = 6.0;    ///< log-likelihood by which the target must exceed all others
  double slope_floor = 1.5e-4;     ///< 1-sigma floor of the errors of predicted bearings, 30 arcsec
  double shape_floor = 1.5e-4;     ///< 1-sigma floor of each element of a relative orbit (relative_motion.h)
  double certainty = 0.99;         ///< required certainty of the association in an image
  double magnitude_sigma = 1.5;    ///< 1-sigma variation of a tumbling target from image to image
  double history_sigma = 1.0;      ///< magnitudes, 1-sigma variation of the target from one hour to another
  double size_sigma = 0.4;         ///< 1-sigma variation of the logarithm of the lit extent: faces of a box, phase
  double resolved_rad = 2e-4;      ///< apparent radius from which on an extent is more than errors of pixels
  double beside_loss = 10.0;       ///< log-likelihood of being the target, of a track that was seen beside it
  int beside_images = 30;          ///< number of images that establish that
  double least_identity = -5.0;    ///< log-likelihood with which a track that is searched may be the target: satellites
                                   ///< that were never seen before are as rare as this in the field
  double sharp_object_loss = 2.3;  ///< log-likelihood: the target's light falls on more than one pixel
  int confirm_hits = 5;            ///< number M of detections that establishes a track...
  int confirm_images = 7;          ///< ...among N images
  int gap_images = 5;              ///< a gap: number of images without detection
  int hits_after_gap = 3;          ///< detections needed again after a gap
  int give_up_images = 15;         ///< images without detection, though expected, until a track is given up
  int remember_images = 500;       ///< the same of another satellite's track while the target is searched
};

struct TrackerInput {
  GpsTime time;                           ///< middle of the exposure
  orbit::CartesianState servicer;         ///< at that time, ECI, osculating
  std::span<const Candidate> candidates;  ///< at most kMaxCandidates
  std::span<const OwnBurn> burns;         ///< since the last image, in order of time
  std::optional<Prediction> prediction;
  std::optional<Prediction> kept;      ///< of the orbit that the present one has replaced, if that may be wrong
  bool is_search = false;              ///< the target was lost: objects are compared with its history too
  double detection_probability = 0.9;  ///< that the target, if in the field, is a candidate: 0 in eclipse
};

enum class TrackerState : std::uint8_t {
  kSearching,  ///< no track is identified as the target
  kTracking,   ///< one track is identified as the target
  kCoasting,   ///< one track is, but it is not detected in this image, or not for certain
  kAmbiguous,  ///< two or more tracks may be the target
};

struct TrackerOutput {
  TrackerState state = TrackerState::kSearching;
  int candidate = -1;      ///< index of the target among the candidates, -1 none
  bool confirmed = false;  ///< `candidate` is the target: never true without one
  int hypotheses = 0;
  int tracks = 0;
  int hot_pixels = 0;            ///< number of known hot pixels
  bool is_as_kept = false;       ///< the target moves as the replaced orbit predicts: that one was right
  double score_margin = 0.0;     ///< excess of the best track's identity over the next one's; large if alone
  double residual_sigmas = 0.0;  ///< root mean square of the target's recent residuals over their standard deviation
};

class TargetTracker {
 public:
  explicit TargetTracker(const TrackerSettings& settings = {})
      : settings_(settings), hot_pixels_(settings.hot_pixels) {}

  /// Processes an image. kInvalidArgument: the image is not after the last one, or a burn is after it or before the
  /// last one; kTooLong: more candidates than kMaxCandidates; kNotFinite, kOutOfRange: invalid state, candidates (sigma
  /// <= 0), burns, prediction or probability. After an error nothing is changed. Candidates more than 60 degrees from
  /// the T axis are ignored.
  Result<TrackerOutput> step(const TrackerInput& input);

  /// Hot pixels learned so far, for telemetry.
  [[nodiscard]] const HotPixelMap& hot_pixels() const { return hot_pixels_; }

 private:
  // Steps of an image, in this order.
  [[nodiscard]] Status check(const TrackerInput& input) const;
  void select_eligible(const TrackerInput& input);
  void propagate_all(const TrackerInput& input);
  void make_branches();
  void grow();
  void share_objects();
  void compare_with_prediction();
  [[nodiscard]] double evidence_for(const Prediction& prediction, const SlopeState& state, const Matrix5& common,
                                    double log_determinant_of_any, double& distance) const;
  void return_to_kept();
  [[nodiscard]] bool is_another(const Hypothesis& hypothesis) const {
    return hypothesis.images_beside >= settings_.beside_images;
  }
  [[nodiscard]] int patience_with(const Hypothesis& hypothesis) const;
  [[nodiscard]] double evidence_for_known(const Hypothesis& hypothesis, const SlopeState& state, const Matrix5& unit,
                                          double log_determinant_of_any) const;
  [[nodiscard]] double history_loss(const Hypothesis& hypothesis) const;
  [[nodiscard]] double extent_loss(const Hypothesis& hypothesis, double distance) const;
  void note_history(const Hypothesis& target);
  void prune();
  void merge_accounts();
  void merge_tracks();
  void choose_target();
  TrackerOutput report();

  struct Eligible {
    SlopeMeasurement measurement;
    double log_flux = 0.0;
    double apparent_radius = 0.0;  ///< rad
    double sigma = 0.0;            ///< rad
    double handicap = 0.0;         ///< log-likelihood
    std::int16_t index = 0;
    bool is_in_gate = true;  ///< may be the target
  };

  [[nodiscard]] double gain_of(const Hypothesis& parent, const Innovation& innovation, const Eligible& candidate) const;
  [[nodiscard]] Hypothesis child_of(const Branch& branch);
  [[nodiscard]] bool is_in_surroundings(const Vector2& slopes) const;
  [[nodiscard]] bool is_expected(const Hypothesis& hypothesis) const;
  [[nodiscard]] bool is_narrow(double gate, double determinant) const;
  void erase_marked();
  [[nodiscard]] bool is_rival(const Hypothesis& h, const Hypothesis& target) const;
  [[nodiscard]] bool moves_as(const Hypothesis& a, const Hypothesis& b) const;
  [[nodiscard]] const Hypothesis* best_of(std::uint32_t track) const;
  [[nodiscard]] bool is_best_of_its_track(std::size_t k) const;
  [[nodiscard]] double claim(std::uint32_t track, std::int16_t candidate) const;
  [[nodiscard]] double rival_claim(const Hypothesis& target) const;

  static constexpr std::size_t kMaxBranches = 1024;

  TrackerSettings settings_;
  HotPixelMap hot_pixels_;
  bool has_image_ = false;
  GpsTime time_;
  std::uint32_t next_track_ = 1;
  std::uint32_t target_track_ = 0;  ///< images in which the target was expected, since the tracks were reset
  int images_watched_ = 0;          ///< in which the target was expected, since the last reset of the tracks
  int deposing_images_ = 0;
  int returning_images_ = 0;  ///< in which a track moved as the replaced orbit predicts, and the target's did not
  bool is_as_kept_ = false;
  bool ambiguous_ = false;
  std::optional<double> target_log_power_;  ///< flux of the target times its squared distance, running mean
  std::optional<double> target_extent_m_;   ///< apparent radius of the target times its distance, running mean
  double score_margin_ = 0.0;

  std::size_t count_ = 0;
  std::array<Hypothesis, kMaxHypotheses> hypotheses_{};

  // Data of the current image
  struct Workspace {
    ServicerView view;
    Prediction prediction;
    bool has_prediction = false;
    std::optional<Prediction> kept_prediction;
    bool is_search = false;
    bool is_prediction_narrow = false;  ///< few other objects are to be expected in its gate
    double bend = 0.0;
    double bend_rate = 0.0;
    double detection_probability = 0.0;
    double log_miss = 0.0;
    double log_density = 0.0;  ///< ln of the density of false detections, 1/sr
    std::size_t eligible_count = 0;
    std::array<Eligible, kMaxCandidates> eligible{};
    std::size_t branch_count = 0;
    std::array<Branch, kMaxBranches> branches{};
    std::array<bool, kMaxHypotheses> erased{};
    std::array<bool, kMaxHypotheses> shared{};
    std::array<Hypothesis, kMaxHypotheses> children{};
  } work_;
};

}  // namespace vbar::fsw::target_tracking
