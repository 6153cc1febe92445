#pragma once
// Keypoints of a camera as an aid of the filter.
//
// The attitude is initialised by a consensus of single-image poses, and only where the target is lit and the range is
// known: a pose under a wrong range may be wrong by tens of degrees. Until then such poses contribute their position
// alone. A lost attitude deactivates the attitude, the rate and the errors of keypoints; the orbit is never discarded.
//
// Images that contradict the orbit are evidence against the network, unless their poses agree with each other as the
// motion of one target: then the covariance of the orbit is opened by the burn that explains them, unreported, since
// the last image that agreed. Images without agreement, or without a target, are no reason to give an estimate away;
// the target is then searched in the whole image.

#include <cstdint>
#include <optional>

#include "fsw/measurements/aid.h"
#include "fsw/measurements/keypoints/keypoint_editing.h"
#include "fsw/measurements/keypoints/pose_initialiser.h"
#include "fsw/measurements/keypoints/seen_views.h"
#include "fsw/vision/pose/pnp.h"

namespace vbar::fsw::measurements {

struct KeypointAidingSettings {
  KeypointEditingSettings editing;
  NoveltySettings novelty;
  measurements::PoseInitialiserSettings start;
  filter::Inertia inertia;  ///< that of the filter's attitude
  /// Limit in addition to those of `start`: poses of fewer keypoints are used there only if their attitude is this
  /// accurate, rad.
  int start_inliers = 8;
  double start_attitude_sigma = 0.05;
  double start_range_share = 0.007;    ///< an attitude is initialised where the range is known to this share, 1 sigma,
  int start_images = 6;                ///< or by the consensus of this number of images that are fit for it
  double keypoint_range_share = 0.03;  ///< beyond it, 1 sigma, only positions are used: keypoints are not linear in it
  double pose_range_share = 0.1;       ///< 1 sigma of the range of a single-image pose, as for a wrong attitude,
  double agreed_range_share = 0.035;   ///< and of one whose attitude agrees with those of the images before
  /// 1 sigma, m, across the line of sight, of a pose whose attitude may be wrong: another side is taken for the one
  /// seen.
  double pose_lateral_sigma_m = 0.15;
  double max_phase = 1.92;  ///< rad, 110 deg: a target lit from behind shows its dark side
  /// 1 sigma, rad: an attitude less certain than this is deactivated until it can be initialised again.
  double widest_attitude = 0.35;
  double position_gate = 25.0;  ///< of the normalised squared distance of a single-image position
};

/// A camera with the model of the target.
struct KeypointCamera {
  KeypointModel model;
  Vector3 position_camera_m = Vector3::Zero();  ///< from the servicer's centre of mass, camera axes
};

/// A processed image, or one without a target.
struct KeypointImage {
  GpsTime time;
  KeypointCamera camera;
  Vector3 sun_eci = Vector3::UnitX();          ///< unit vector
  std::optional<Matrix3> R_camera_eci;         ///< at the image
  const pose::Keypoints* keypoints = nullptr;  ///< null: no target detected
  std::optional<pose::PnpSolution> pnp;        ///< of the same keypoints
};

/// Edit status of the image; numbers of telemetry_pose, edit status.
enum class KeypointEditStatus : std::uint8_t {
  kNone,      ///< no usable input
  kRejected,  ///< rejected by the gate
  kFilter,    ///< keypoints processed
  kPosition,  ///< only its position: the attitude is not confirmed
  kStart,     ///< kept for initialisation
};

struct KeypointCounters {
  std::int32_t images_used = 0;  ///< their keypoints
  std::int32_t images_rejected = 0;
  std::int32_t keypoints_used = 0;
  std::int32_t keypoints_rejected = 0;
  std::int32_t positions_used = 0;   ///< of single images, while the attitude was not confirmed
  std::int32_t attitudes_reset = 0;  ///< initialised from single images, from the second time on
  std::int32_t inflations = 0;       ///< of the covariance of the orbit, after contradictions that agree
  std::int32_t undecided = 0;        ///< contradictions without agreement, after which the orbit was kept
  std::int32_t restarts = 0;         ///< of the relative orbit, from single images after persistent contradictions
};

/// Keypoints of a lit target against its known attitude.
struct NetworkVerdict {
  bool contradicts = false;  ///< most of them are rejected, and the pose of the same image has another attitude
  double angle = 0.0;        ///< rad, between both
};

class KeypointAiding {
 public:
  /// Replaces the settings; the poses collected for initialisation are discarded.
  void configure(const KeypointAidingSettings& settings);

  /// Processes an image; the filter stands at its time. Must be called for images without a target too.
  KeypointEditStatus process(const KeypointImage& image, filter::RelativeNavigationFilter& filter);

  /// Notes that nothing was measured until `now`: the state follows the age of the last accepted image.
  void check_age(GpsTime now);

  [[nodiscard]] const Aid& aid() const { return aid_; }
  [[nodiscard]] Aid& aid() { return aid_; }
  /// Update by the last image; empty if its keypoints were not processed.
  [[nodiscard]] const KeypointsUpdate& last_update() const { return editing_.last_update(); }
  /// Whether the target is to be searched in the whole image: it was not where the estimate expects it.
  [[nodiscard]] bool searches() const { return searches_; }
  [[nodiscard]] GpsTime last_accepted() const { return last_accepted_; }
  /// Verdict on the images since forget_verdict(); empty if none was judged.
  [[nodiscard]] const std::optional<NetworkVerdict>& network_verdict() const { return verdict_; }
  void forget_verdict() { verdict_.reset(); }
  [[nodiscard]] const KeypointCounters& counters() const { return counters_; }

 private:
  /// Illumination of the target as the camera sees it.
  struct Light {
    bool is_sunlit = false;  ///< surely outside the shadow
    bool is_lit = false;     ///< and not from behind
    bool may_start = false;  ///< and for two minutes to come
  };

  [[nodiscard]] Light light_of(const KeypointImage& image, const filter::RelativeNavigationFilter& filter) const;
  [[nodiscard]] bool is_fit_for_start(const KeypointImage& image) const;
  [[nodiscard]] measurements::PoseSample sample_of(const KeypointImage& image, const CameraPose& camera,
                                                   const filter::RelativeNavigationFilter& filter) const;
  void follow_burns(const filter::RelativeNavigationFilter& filter);
  KeypointEditStatus edit(const KeypointImage& image, filter::RelativeNavigationFilter& filter);
  KeypointEditStatus begin_orbit(filter::RelativeNavigationFilter& filter);
  [[nodiscard]] bool agrees_with_image(const filter::AttitudeState& attitude) const;
  bool initialize_attitude(filter::RelativeNavigationFilter& filter);
  KeypointEditStatus take_position(const KeypointImage& image, const CameraPose& camera,
                                   filter::RelativeNavigationFilter& filter);
  void activate_blocks(std::size_t camera, filter::RelativeNavigationFilter& filter) const;
  KeypointEditStatus take_keypoints(const KeypointImage& image, const CameraPose& camera,
                                    filter::RelativeNavigationFilter& filter);
  [[nodiscard]] Matrix3 position_covariance(const measurements::PoseSample& sample, bool is_agreed) const;
  [[nodiscard]] double likeness_factor(const View& view) const;
  [[nodiscard]] std::optional<double> distance_if_far(const measurements::PoseSample& sample,
                                                      const filter::RelativeNavigationFilter& filter) const;
  void judge_network(const KeypointImage& image, const CameraPose& camera, bool is_rejected,
                     const filter::RelativeNavigationFilter& filter);
  [[nodiscard]] bool is_proven() const;
  [[nodiscard]] bool is_upset(GpsTime time) const;
  [[nodiscard]] bool poses_agree() const;
  void accept(GpsTime time);
  /// `miss_m`: distance of the pose of the image from the estimate, if it is beyond the gate.
  void count_rejection(GpsTime time, const std::optional<double>& miss_m, filter::RelativeNavigationFilter& filter);
  void count_missing(const filter::RelativeNavigationFilter& filter);
  void open_orbit(GpsTime time, double miss_m, filter::RelativeNavigationFilter& filter);
  void contradict_orbit(GpsTime time, double miss_m, filter::RelativeNavigationFilter& filter);
  void reset_rejections();
  void follow_state(GpsTime time, KeypointEditStatus status);

  KeypointAidingSettings settings_;
  Aid aid_;
  KeypointEditing editing_;
  ViewNovelty seen_;
  std::optional<View> view_of_position_;  ///< of the last image that contributed its position alone
  measurements::PoseInitialiser start_;
  Light light_;                                                            ///< of the current image
  bool has_sample_ = false;                                                ///< of the current image, for initialisation
  Eigen::Quaterniond q_eci_body_sample_ = Eigen::Quaterniond::Identity();  ///< its attitude
  bool has_begun_ = false;                                                 ///< an attitude was initialised before
  GpsTime burns_until_;  ///< impulses of the filter before this are known to `start_`
  GpsTime last_accepted_;
  GpsTime attitude_since_;  ///< the present attitude was initialised
  int images_of_attitude_ = 0;
  std::optional<NetworkVerdict> verdict_;
  int rejected_in_a_row_ = 0;
  int far_in_a_row_ = 0;
  int missing_in_a_row_ = 0;
  bool searches_ = false;
  int openings_in_a_row_ = 0;
  KeypointCounters counters_;
};

}  // namespace vbar::fsw::measurements
