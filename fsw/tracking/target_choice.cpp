// Selection of the target's track, and whether its object in this image is certain: the decision of the tracker.

#include <algorithm>

#include "fsw/math/math.h"
#include "fsw/tracking/target_tracker.h"

namespace vbar::fsw::tracking {
namespace {

constexpr double kAlone = 99.0;
constexpr int kRivalHits = 3;
constexpr int kOwnObjects = 2;
constexpr int kDeposeAfter = 3;

}  // namespace

void TargetTracker::compare_with_prediction(double dt) {
  const double decay = math::exp(-dt / settings_.identity_memory_s);
  for (std::size_t k = 0; k < count_; ++k) {
    Hypothesis& hypothesis = hypotheses_[k];
    if (!work_.has_prediction) continue;
    const SlopeState state = slope_state(hypothesis.motion, work_.view, work_.bend, work_.bend_rate);
    hypothesis.identity_now =
        distance_between(state.slopes, state.covariance, work_.prediction.slopes, work_.prediction.covariance,
                         settings_.slope_floor, settings_.rate_floor);
    hypothesis.identity = std::max(hypothesis.identity * decay, hypothesis.identity_now);
  }
}

void TargetTracker::choose_target() {
  // The track closest to the prediction, and the closest of the others.
  const Hypothesis* best = nullptr;
  const Hypothesis* second = nullptr;
  for (std::size_t k = 0; k < count_; ++k) {
    const Hypothesis& h = hypotheses_[k];
    if (h.hits < kRivalHits || !is_best_of_its_track(k)) continue;
    if (best == nullptr || h.identity < best->identity) {
      second = best;
      best = &h;
    } else if (second == nullptr || h.identity < second->identity) {
      second = &h;
    }
  }
  score_margin_ = 0.0;
  ambiguous_ = false;
  if (best == nullptr) {
    target_track_ = 0;
    return;
  }
  score_margin_ = second == nullptr ? kAlone : std::min(0.5 * (second->identity - best->identity), kAlone);

  const Hypothesis* target = target_track_ == 0 ? nullptr : best_of(target_track_);
  if (target == nullptr) {
    target_track_ = 0;
    deposing_images_ = 0;
    ambiguous_ = second != nullptr && score_margin_ < settings_.identity_margin;
    if (best->established && !ambiguous_ && best->identity < settings_.identity_gate &&
        images_watched_ >= settings_.confirm_images) {
      target_track_ = best->track;
    }
    return;
  }
  // The target track is kept unless the prediction contradicts it for some time.
  const bool misplaced = target->history[0] >= 0 && target->identity_now > settings_.identity_gate;
  const bool beaten = best->track != target_track_ && best->established &&
                      0.5 * (target->identity_now - best->identity) > settings_.identity_margin;
  deposing_images_ = misplaced || beaten ? deposing_images_ + 1 : 0;
  if (deposing_images_ >= kDeposeAfter) {
    target_track_ = 0;
    deposing_images_ = 0;
  }
}

// By how much a track's best hypothesis with the candidate in this image exceeds its best one without; no hypothesis
// with it or none without: -kAlone or kAlone.
double TargetTracker::claim(std::uint32_t track, std::int16_t candidate) const {
  const Hypothesis* with = nullptr;
  const Hypothesis* without = nullptr;
  for (std::size_t k = 0; k < count_; ++k) {
    const Hypothesis& h = hypotheses_[k];
    if (h.track != track) continue;
    const Hypothesis*& best = h.history[0] == candidate ? with : without;
    if (best == nullptr || h.score > best->score) best = &h;
  }
  if (with == nullptr) return -kAlone;
  return without == nullptr ? kAlone : with->score - without->score;
}

// The strongest association of another satellite's track with the target's candidate. A short track is another
// satellite's if it includes objects that the target's does not.
double TargetTracker::rival_claim(const Hypothesis& target) const {
  const std::int16_t candidate = target.history[0];
  double strongest = -kAlone;
  for (std::size_t k = 0; k < count_; ++k) {
    const Hypothesis& h = hypotheses_[k];
    if (h.track == target_track_ || h.history[0] != candidate) continue;
    if (!h.established && objects_of_its_own(h, target) < kOwnObjects) continue;
    strongest = std::max(strongest, claim(h.track, candidate));
  }
  return strongest;
}

TrackerOutput TargetTracker::report() {
  TrackerOutput output;
  output.hypotheses = static_cast<int>(count_);
  output.hot_pixels = static_cast<int>(hot_pixels_.known());
  output.score_margin = score_margin_;
  for (std::size_t k = 0; k < count_; ++k) {
    if (is_best_of_its_track(k)) ++output.tracks;
  }
  const Hypothesis* target = target_track_ == 0 ? nullptr : best_of(target_track_);
  if (target == nullptr) {
    output.state = ambiguous_ ? TrackerState::kAmbiguous : TrackerState::kSearching;
    return output;
  }
  output.state = TrackerState::kCoasting;
  output.residual_sigmas = math::sqrt(target->misfit);
  const std::int16_t seen = target->history[0];
  if (seen < 0) return output;

  double agreeing = 0.0;
  double all = 0.0;
  for (std::size_t k = 0; k < count_; ++k) {
    const Hypothesis& h = hypotheses_[k];
    if (h.track != target_track_) continue;
    const double weight = math::exp(std::max(h.score - target->score, -50.0));
    all += weight;
    if (h.history[0] == seen) agreeing += weight;
  }
  const bool certain = agreeing >= settings_.certainty * all;
  // Either the target is visible and the rival is missed, or vice versa.
  const double odds = math::log(settings_.certainty / (1.0 - settings_.certainty));
  const bool own = claim(target_track_, seen) > rival_claim(*target) + odds;
  const bool fits = target->misfit < kMaxMisfit && target->hits_since_gap >= settings_.hits_after_gap;
  output.candidate = seen;
  output.confirmed = certain && own && fits && deposing_images_ == 0;
  if (output.confirmed) {
    output.state = TrackerState::kTracking;
  } else {
    output.candidate = -1;
  }
  return output;
}

}  // namespace vbar::fsw::tracking
