#pragma once
// Update of the filter by the keypoints of an image: editing, weighting, adaptation of the noise.
//
// A keypoint beyond its gate is excluded; an image that loses too many is rejected. Those that pass are weighted as
// samples of a Student distribution (their tails are heavier than Gaussian: 5 to 7 % lie beyond 99 %), an image that
// fits badly as a whole is weighted less, and the scale of the network's covariances is adapted to all images so far.

#include <array>

#include "fsw/core/gps_time.h"
#include "fsw/measurements/keypoints/keypoint_measurement.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw::measurements {

struct KeypointEditingSettings {
  double gate = 9.21;               ///< of a keypoint's normalised innovation squared: 99 % of two degrees of freedom
  double tail_degrees = 4.0;        ///< degrees of freedom of the Student distribution of a keypoint's error
  double max_noise_scale = 9.0;     ///< largest factor on the covariances of keypoints, adapted and for one image
  double max_rejected_share = 0.6;  ///< of the keypoints; beyond it the image is rejected
  int min_keypoints = 3;
};

/// Edit status of a keypoint. Residuals are measured minus predicted, px.
struct KeypointUpdate {
  bool is_usable = false;  ///< by the network, and predicted in front of the camera
  bool accepted = false;
  Vector2 prefit = Vector2::Zero();
  Vector2 postfit = Vector2::Zero();
  double nis = 0.0;  ///< of this keypoint alone
};

/// Edit status of the keypoints of an image.
struct KeypointsUpdate {
  bool accepted = false;
  int usable = 0;
  int used = 0;
  double nis = 0.0;          ///< of the accepted ones together: 2 * used on average
  double noise_scale = 1.0;  ///< factor applied to the covariances of keypoints
  std::array<KeypointUpdate, pose::kKeypoints> keypoints{};

  [[nodiscard]] bool is_mostly_rejected(double share) const { return usable > 0 && usable - used > share * usable; }
};

class KeypointEditing {
 public:
  static constexpr filter::MeasurementSource kSource{.bit = navigation_configuration::kUseKeypoints};

  void configure(const KeypointEditingSettings& settings) { settings_ = settings; }
  [[nodiscard]] const KeypointEditingSettings& settings() const { return settings_; }

  /// Processes the keypoints of an image; the filter stands at its time and has an attitude. `novelty_scale`: factor
  /// on their covariances (seen_views.h).
  const KeypointsUpdate& process_measurement(filter::RelativeNavigationFilter& filter, GpsTime time,
                                             const pose::Keypoints& keypoints, const CameraPose& camera,
                                             const KeypointModel& model, double novelty_scale);

  [[nodiscard]] const KeypointsUpdate& last_update() const { return update_; }
  void clear_update() { update_ = {}; }
  /// Factor on the covariances of keypoints, adapted to the residuals of all images so far.
  [[nodiscard]] double adapted_scale() const { return adapted_scale_ > 1.0 ? adapted_scale_ : 1.0; }

 private:
  void gate_keypoints(filter::MeasurementBatch& batch);
  void weight_keypoints(filter::MeasurementBatch& batch, double common) const;
  void adapt_noise(const filter::MeasurementBatch& batch, GpsTime time, const CameraPose& camera,
                   filter::RelativeNavigationFilter& filter);
  void adapt_scale();

  KeypointEditingSettings settings_;
  pose::Keypoints scaled_{};
  double adapted_scale_ = 1.0;
  GpsTime last_processed_;
  KeypointsUpdate update_;
};

}  // namespace vbar::fsw::measurements
