#pragma once
// State blocks of keypoints: their frame, the mounts of the cameras, and the errors that successive images have in
// common.
//
// A network has the same errors for the same view, so that a filter that assumed white errors would soon underestimate
// its covariance by a factor of ten. A share of each keypoint's own error, and a shift and stretch of all, are
// therefore Gauss-Markov states that decay as the target rotates: by 1/e in 11 to 14 deg, measured over ten tumbles of
// 0.3 to 1.5 deg/s. A part of the stretch is constant: it is equivalent to another range, and only known burns separate
// the two. A part of the rotation error lasts as well, over many views: without it, attitude errors of half a degree
// persisted for 10 to 30 minutes at a sigma of 0.3 deg.

#include "fsw/estimation/gauss_markov.h"
#include "fsw/packets/message_list.h"
#include "fsw/vision/pose/architecture.h"

namespace vbar::fsw::measurements {

/// Origin of the keypoints' frame from the centre of mass, body axes, m.
struct KeypointOrigin : estimation::GaussMarkovBlock<KeypointOrigin, 3> {
  static constexpr estimation::GaussMarkov kDefaults{.sigma = 0.01};
  static constexpr bool kFollowsAttitude = true;
};

inline constexpr int kMountAxes = 2;  ///< components of the mount of one camera

/// Errors of the boresights against the star tracker, in the rows of bearing_axes(), rad. Default sigma: 60 arcsec.
struct CameraMounts : estimation::GaussMarkovBlock<CameraMounts, kMountAxes* static_cast<int>(packets::kCameras)> {
  static constexpr estimation::GaussMarkov kDefaults{.sigma = 2.9e-4, .time_s = 43200.0};
};

struct KeypointErrorSettings {
  double correlated_share = 0.85;     ///< share of a keypoint's variance that is common to images of the same view
  double shift_sigma_px = 0.8;        ///< shift of all keypoints together, per axis, common to such images
  double stretch_sigma = 9e-3;        ///< relative error of the target's apparent size, common to such images
  double correlation_angle = 0.21;    ///< rad: rotation of the target over which keypoint errors decorrelate
  double correlation_time_s = 120.0;  ///< s: decorrelation for a target with a small rate
  estimation::GaussMarkov lasting_stretch{
      .sigma = 4e-3, .time_s = 3600.0};  ///< error of the apparent size in a camera, constant over all views
  estimation::GaussMarkov lasting_turn{.sigma = 1e-2, .time_s = 600.0};  ///< rad, per body axis, over all views
};

/// Errors of single keypoints, each over its standard deviation. They decorrelate with the view, as those of all
/// keypoints do: KeypointCommon propagates both.
struct KeypointErrors {
  static constexpr int kSize = 2 * pose::kKeypoints;
  static constexpr bool kFollowsAttitude = true;
};

/// Errors of all keypoints together: shift (px, px), stretch, the lasting stretch of each camera (shares), and the
/// lasting rotation, body axes, rad.
struct KeypointCommon {
  static constexpr int kStretch = 2;
  static constexpr int kLastingStretch = 3;
  static constexpr int kLastingTurn = kLastingStretch + static_cast<int>(packets::kCameras);
  static constexpr int kSize = kLastingTurn + 3;
  static constexpr bool kFollowsAttitude = true;
  using Settings = KeypointErrorSettings;
  static constexpr Settings kDefaults{};
  static constexpr estimation::GaussMarkov kWhitened{.sigma = 1.0};  ///< unit: root of a keypoint's covariance

  /// Initialises all errors, those of single keypoints too, with their stationary distribution.
  template <class State>
  static void initialize_with_attitude(estimation::Estimate<State::kSize>& estimate, const Settings& settings) {
    constexpr int kFirst = State::template offset<KeypointCommon>();
    for (int axis = 0; axis < 2; ++axis)
      initialize_process(estimate, kFirst + axis, {.sigma = settings.shift_sigma_px});
    initialize_process(estimate, kFirst + kStretch, {.sigma = settings.stretch_sigma});
    for (int k = kLastingStretch; k < kLastingTurn; ++k)
      initialize_process(estimate, kFirst + k, settings.lasting_stretch);
    for (int k = kLastingTurn; k < kSize; ++k) initialize_process(estimate, kFirst + k, settings.lasting_turn);
    constexpr int kErrors = State::template offset<KeypointErrors>();
    for (int k = 0; k < KeypointErrors::kSize; ++k) initialize_process(estimate, kErrors + k, kWhitened);
  }

  template <class State>
  static void propagate(estimation::Estimate<State::kSize>& estimate, const Settings& settings,
                        const estimation::BlockStep& step) {
    constexpr int kFirst = State::template offset<KeypointCommon>();
    if (estimate.is_inactive(kFirst)) return;
    const double view =
        math::exp(-step.dt_s * (step.target_rate / settings.correlation_angle + 1.0 / settings.correlation_time_s));
    for (int axis = 0; axis < 2; ++axis) {
      propagate_process(estimate, kFirst + axis, {.sigma = settings.shift_sigma_px}, view);
    }
    propagate_process(estimate, kFirst + kStretch, {.sigma = settings.stretch_sigma}, view);
    const double lasting = settings.lasting_stretch.decay(step.dt_s);
    for (int k = kLastingStretch; k < kLastingTurn; ++k) {
      propagate_process(estimate, kFirst + k, settings.lasting_stretch, lasting);
    }
    const double turn = settings.lasting_turn.decay(step.dt_s);
    for (int k = kLastingTurn; k < kSize; ++k) propagate_process(estimate, kFirst + k, settings.lasting_turn, turn);
    constexpr int kErrors = State::template offset<KeypointErrors>();
    for (int k = 0; k < KeypointErrors::kSize; ++k) propagate_process(estimate, kErrors + k, kWhitened, view);
  }
};

}  // namespace vbar::fsw::measurements
