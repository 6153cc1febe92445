#include "fsw/trunk/keypoint_errors.h"

namespace vbar::fsw::trunk {
namespace {

constexpr int kCommon = kAt<KeypointCommon>;
constexpr int kStretch = kCommon + 2;
constexpr int kLastingStretch = kCommon + KeypointCommon::kLastingStretch;
constexpr int kLastingTurn = kCommon + KeypointCommon::kLastingTurn;
constexpr int kEnd = kCommon + KeypointCommon::kSize;
constexpr GaussMarkov kWhitened{.sigma = 1.0};  // in units of the root of a keypoint's covariance

}  // namespace

void begin_keypoint_errors(Estimate& estimate, const KeypointErrorSettings& settings) {
  for (int axis = 0; axis < 2; ++axis) begin_process(estimate, kCommon + axis, {.sigma = settings.shift_sigma_px});
  begin_process(estimate, kStretch, {.sigma = settings.stretch_sigma});
  for (int i = kLastingStretch; i < kLastingTurn; ++i) begin_process(estimate, i, settings.lasting_stretch);
  for (int i = kLastingTurn; i < kEnd; ++i) begin_process(estimate, i, settings.lasting_turn);
  begin_block<KeypointErrors>(estimate, kWhitened);
}

void rest_keypoint_errors(Estimate& estimate) {
  rest_block<KeypointErrors>(estimate);
  rest_block<KeypointCommon>(estimate);
}

void advance_keypoint_errors(Estimate& estimate, const KeypointErrorSettings& settings, double rate, double dt) {
  if (!is_active<KeypointCommon>(estimate)) return;
  const double view = math::exp(-dt * (rate / settings.correlation_angle + 1.0 / settings.correlation_time_s));
  for (int axis = 0; axis < 2; ++axis) {
    advance_process(estimate, kCommon + axis, {.sigma = settings.shift_sigma_px}, view);
  }
  advance_process(estimate, kStretch, {.sigma = settings.stretch_sigma}, view);
  const double lasting = settings.lasting_stretch.decay(dt);
  for (int i = kLastingStretch; i < kLastingTurn; ++i) {
    advance_process(estimate, i, settings.lasting_stretch, lasting);
  }
  const double turn = settings.lasting_turn.decay(dt);
  for (int i = kLastingTurn; i < kEnd; ++i) advance_process(estimate, i, settings.lasting_turn, turn);
  for (int k = 0; k < KeypointErrors::kSize; ++k) {
    advance_process(estimate, kAt<KeypointErrors> + k, kWhitened, view);
  }
}

}  // namespace vbar::fsw::trunk
