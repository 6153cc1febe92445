// Selection of the target's track, and whether its object in this image is certain: the decision of the tracker.

#include <algorithm>

#include "fsw/math/math.h"
#include "fsw/vision/target_tracking/target_tracker.h"

namespace vbar::fsw::target_tracking {

namespace {

constexpr double kAlone = 99.0;
constexpr int kRivalHits = 3;
constexpr int kOwnObjects = 2;
constexpr int kDeposeAfter = 3;
constexpr int kReturnAfter = 3;
constexpr double kMagnitudesPerLog = 1.0857362047581296;  // 2.5 / ln 10
constexpr double kMaxHistoryLoss = 8.0;
constexpr double kHistoryGain = 0.02;        // of an image: the mean of an hour
constexpr SlopeFloors kRegular{1e-6, 1e-8};  // keep a covariance regular
// 1-sigma error of each element of a relative orbit (relative_motion.h) that was propagated through an eclipse.
constexpr double kReturn = 5e-4;

}  // namespace

// A detection that a better track shares is not one of this track: the bit of this image is cleared. Better: the
// target's, else an established one, else the one of higher score.
void TargetTracker::share_objects() {
  std::array<const Hypothesis*, kMaxHypotheses> best{};
  std::size_t tracks = 0;
  for (std::size_t k = 0; k < count_; ++k) {
    if (is_best_of_its_track(k)) best[tracks++] = &hypotheses_[k];
  }
  const auto is_better = [this](const Hypothesis& a, const Hypothesis& b) {
    if (a.track == target_track_ || b.track == target_track_) return a.track == target_track_;
    if (a.established != b.established) return a.established;
    return a.score != b.score ? a.score > b.score : a.track < b.track;
  };
  work_.shared.fill(false);
  for (std::size_t k = 0; k < count_; ++k) {
    const Hypothesis& h = hypotheses_[k];
    if (h.history[0] < 0) continue;
    std::size_t own = 0;
    while (own + 1 < tracks && best[own]->track != h.track) ++own;
    for (std::size_t t = 0; t < tracks; ++t) {
      const Hypothesis& other = *best[t];
      if (other.track != h.track && other.history[0] == h.history[0] && is_better(other, *best[own]))
        work_.shared[k] = true;
    }
  }
  for (std::size_t k = 0; k < count_; ++k) {
    Hypothesis& h = hypotheses_[k];
    if (work_.shared[k]) h.recent &= ~1U;
    if (h.history[0] >= 0 && hits_of(h.recent, settings_.confirm_images) >= settings_.confirm_hits &&
        h.misfit < kMaxMisfit) {
      h.established = true;
    }
  }
}

// The relative orbit of the target is distributed about the prediction, that of another satellite about zero with the
// covariance of an unknown motion, which is so wide that only its determinant matters.
void TargetTracker::compare_with_prediction() {
  if (!work_.has_prediction) return;
  for (std::size_t k = 0; k < count_; ++k) {
    Hypothesis& hypothesis = hypotheses_[k];
    const SlopeState state = slope_state(hypothesis.motion, work_.view, work_.bend, work_.bend_rate);
    // Errors common to all images are changes of the relative orbit; as slopes and rates of one image, independent of
    // each other, they would conceal a difference in the drift. The centre of brightness of a resolved body moves with
    // the Sun, at the orbital rate, like an eccentricity or inclination.
    const double floor = math::hypot(settings_.shape_floor, hypothesis.sigma);
    const double unknown = settings_.motion.shape_sigma;
    const Matrix5 unit = state.jacobian * state.jacobian.transpose();
    const Matrix5 common = floor * floor * unit;
    const SlopeDistance as_other =
        slope_distance(Vector5::Zero(), state.covariance + unknown * unknown * unit, kRegular);
    double evidence = evidence_for(work_.prediction, state, common, as_other.log_determinant, hypothesis.distance);
    if (work_.kept_prediction) {
      hypothesis.kept_identity =
          evidence_for(*work_.kept_prediction, state, common, as_other.log_determinant, hypothesis.kept_distance);
    }
    if (work_.is_search) evidence -= evidence_for_known(hypothesis, state, unit, as_other.log_determinant);
    hypothesis.identity = evidence - history_loss(hypothesis);
  }
}

/// Log-likelihood ratio of moving as predicted against any motion, and the squared distance from the prediction.
/// `common`: covariance of errors that all images of a track have in common.
double TargetTracker::evidence_for(const Prediction& prediction, const SlopeState& state, const Matrix5& common,
                                   double log_determinant_of_any, double& distance) const {
  const SlopeDistance as_target =
      slope_distance(state.slopes - prediction.slopes, state.covariance + prediction.covariance + common, kRegular);
  distance = as_target.square;
  return 0.5 * (log_determinant_of_any - as_target.log_determinant - as_target.square);
}

/// Log-likelihood ratio of being a satellite that was seen beside the target against any. That one still moves as it
/// did is no evidence for the target, nor if it returns from eclipse as a new track.
double TargetTracker::evidence_for_known(const Hypothesis& hypothesis, const SlopeState& state, const Matrix5& unit,
                                         double log_determinant_of_any) const {
  double strongest = 0.0;
  for (std::size_t k = 0; k < count_; ++k) {
    const Hypothesis& known = hypotheses_[k];
    if (!is_another(known) || !is_best_of_its_track(k)) continue;
    const SlopeState then = slope_state(known.motion, work_.view, work_.bend, work_.bend_rate);
    const bool is_itself = known.track == hypothesis.track;
    const SlopeDistance as_known =
        slope_distance(is_itself ? Vector5(Vector5::Zero()) : Vector5(state.slopes - then.slopes),
                       state.covariance + then.covariance + kReturn * kReturn * unit, kRegular);
    strongest = std::max(strongest, 0.5 * (log_determinant_of_any - as_known.log_determinant - as_known.square));
  }
  return strongest;
}

// Log-likelihood that the history of the target takes from a track, if it is searched. All objects have nearly the same
// phase angle, so that the change of brightness with it cancels in the comparison of two.
double TargetTracker::history_loss(const Hypothesis& hypothesis) const {
  if (!work_.is_search) return 0.0;
  double loss = is_another(hypothesis) ? settings_.beside_loss : 0.0;
  const double distance = math::abs(work_.prediction.along_track_m);
  if (!(distance > 0.0)) return loss;
  loss += extent_loss(hypothesis, distance);
  if (!target_log_power_) return loss;
  const double log_power = hypothesis.log_flux + 2.0 * math::log(distance);
  const double magnitudes = kMagnitudesPerLog * (log_power - *target_log_power_);
  // The error of the distance is one of brightness.
  const double of_distance = 2.0 * kMagnitudesPerLog * std::min(work_.prediction.along_track_sigma_fraction, 1.0);
  const double sigma = math::hypot(settings_.history_sigma, of_distance);
  return loss + std::min(0.5 * magnitudes * magnitudes / (sigma * sigma), kMaxHistoryLoss);
}

/// The same for the apparent size, where that of the target is resolved at `distance`, m: another satellite of its
/// size, or of its brightness, is smaller further away.
double TargetTracker::extent_loss(const Hypothesis& hypothesis, double distance) const {
  if (!target_extent_m_) return 0.0;
  const double expected = *target_extent_m_ / distance;
  if (expected < settings_.resolved_rad) return 0.0;
  const double seen = std::max(hypothesis.apparent_radius, 0.5 * settings_.resolved_rad);
  const double of_distance = std::min(work_.prediction.along_track_sigma_fraction, 1.0);
  const double sigmas = math::log(seen / expected) / math::hypot(settings_.size_sigma, of_distance);
  return std::min(0.5 * sigmas * sigmas, kMaxHistoryLoss);
}

// A target that was certain where it was predicted leaves its brightness, and the tracks beside it are not its own.
void TargetTracker::note_history(const Hypothesis& target) {
  const double distance = math::abs(work_.prediction.along_track_m);
  if (!work_.is_prediction_narrow || work_.is_search || !(distance > 0.0)) return;
  const double log_power = target.log_flux + 2.0 * math::log(distance);
  target_log_power_ =
      target_log_power_ ? *target_log_power_ + kHistoryGain * (log_power - *target_log_power_) : log_power;
  const double extent_m = target.apparent_radius * distance;
  if (target.apparent_radius >= settings_.resolved_rad)
    target_extent_m_ = target_extent_m_ ? *target_extent_m_ + kHistoryGain * (extent_m - *target_extent_m_) : extent_m;
  for (std::size_t k = 0; k < count_; ++k) {
    Hypothesis& h = hypotheses_[k];
    if (h.track != target_track_ && h.established && h.images_beside < settings_.beside_images) ++h.images_beside;
  }
}

// A short track is another satellite's if it includes objects that the target's does not.
bool TargetTracker::is_rival(const Hypothesis& h, const Hypothesis& target) const {
  return h.track != target.track && (h.established || objects_of_its_own(h, target) >= kOwnObjects);
}

void TargetTracker::choose_target() {
  // The track most likely to be the target, and the most likely of the others.
  const Hypothesis* best = nullptr;
  for (std::size_t k = 0; k < count_; ++k) {
    const Hypothesis& h = hypotheses_[k];
    if (h.hits < kRivalHits || !is_best_of_its_track(k)) continue;
    if (best == nullptr || h.identity > best->identity) best = &h;
  }
  score_margin_ = 0.0;
  ambiguous_ = false;
  if (best == nullptr) {
    target_track_ = 0;
    return;
  }
  score_margin_ = kAlone;
  for (std::size_t k = 0; k < count_; ++k) {
    const Hypothesis& h = hypotheses_[k];
    if (h.hits < kRivalHits || !is_best_of_its_track(k) || !is_rival(h, *best)) continue;
    score_margin_ = std::min(score_margin_, best->identity - h.identity);
  }

  const Hypothesis* target = target_track_ == 0 ? nullptr : best_of(target_track_);
  if (target == nullptr) {
    target_track_ = 0;
    deposing_images_ = 0;
    // The only track in view may be another satellite's while the target is out of sight.
    const bool is_possible =
        best->distance < settings_.identity_gate && (!work_.is_search || best->identity > settings_.least_identity);
    ambiguous_ = is_possible && score_margin_ < settings_.identity_margin;
    if (best->established && is_possible && !ambiguous_ && images_watched_ >= settings_.confirm_images) {
      target_track_ = best->track;
    }
    return;
  }
  // The target track is kept unless the prediction contradicts it for some time. Only objects in the gate about the
  // prediction continue it. In a narrow gate they are the target's: the motion of a track, which once an orbit errs by
  // 1e-3 of the distance, contradicts no more.
  const bool misplaced =
      target->history[0] >= 0 && target->distance > settings_.identity_gate && !work_.is_prediction_narrow;
  const bool beaten = best->track != target_track_ && best->established &&
                      best->identity - target->identity > settings_.identity_margin;
  deposing_images_ = misplaced || beaten ? deposing_images_ + 1 : 0;
  if (deposing_images_ >= kDeposeAfter) {
    target_track_ = 0;
    deposing_images_ = 0;
  }
}

// The orbit that was replaced predicts all five parameters of a motion. The target is the object that moves so, if the
// present orbit does not explain it and the object that has been taken for the target does not move so. An orbit that
// was replaced for a small change explains the target nearly as well as its successor, and does not return.
void TargetTracker::return_to_kept() {
  is_as_kept_ = false;
  if (!work_.kept_prediction) {
    returning_images_ = 0;
    return;
  }
  const Hypothesis* best = nullptr;
  for (std::size_t k = 0; k < count_; ++k) {
    const Hypothesis& h = hypotheses_[k];
    if (!h.established || h.history[0] < 0 || !is_best_of_its_track(k) || h.kept_distance > settings_.identity_gate)
      continue;
    if (best == nullptr || h.kept_identity > best->kept_identity) best = &h;
  }
  const Hypothesis* const target = target_track_ == 0 ? nullptr : best_of(target_track_);
  const bool is_better = best != nullptr &&
                         best->kept_identity - std::max(best->identity, 0.0) > settings_.identity_margin &&
                         (target == nullptr || target->track == best->track ||
                          best->kept_identity - target->kept_identity > settings_.identity_margin);
  returning_images_ = is_better ? returning_images_ + 1 : 0;
  if (returning_images_ < kReturnAfter) return;
  target_track_ = best->track;
  deposing_images_ = 0;
  returning_images_ = 0;
  is_as_kept_ = true;
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

// The strongest association of another satellite's track with the target's candidate.
double TargetTracker::rival_claim(const Hypothesis& target) const {
  const std::int16_t candidate = target.history[0];
  double strongest = -kAlone;
  for (std::size_t k = 0; k < count_; ++k) {
    const Hypothesis& h = hypotheses_[k];
    if (h.history[0] != candidate || !is_rival(h, target)) continue;
    strongest = std::max(strongest, claim(h.track, candidate));
  }
  return strongest;
}

TrackerOutput TargetTracker::report() {
  TrackerOutput output;
  output.hypotheses = static_cast<int>(count_);
  output.hot_pixels = static_cast<int>(hot_pixels_.known());
  output.score_margin = score_margin_;
  output.is_as_kept = is_as_kept_;
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
    note_history(*target);
  } else {
    output.candidate = -1;
  }
  return output;
}

// Pruning of hypotheses: the part of the tracker that deletes them.

namespace {

constexpr double kDropScore = -7.0;
// An unestablished track that was missed in this number of consecutive images is deleted.
constexpr int kPatience = 3;
constexpr std::size_t kScan = 5;        // images after which only one hypothesis of a track remains
constexpr std::size_t kSame = 3;        // images that two hypotheses must share to be one
constexpr double kSameDistance = 25.0;  // chi-square, 5 degrees of freedom: 1e-4

}  // namespace

void TargetTracker::erase_marked() {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < count_; ++k) {
    if (work_.erased[k]) continue;
    if (kept != k) hypotheses_[kept] = hypotheses_[k];
    ++kept;
  }
  count_ = kept;
}

bool TargetTracker::is_best_of_its_track(std::size_t k) const {
  for (std::size_t j = 0; j < count_; ++j) {
    if (hypotheses_[j].track != hypotheses_[k].track || j == k) continue;
    if (hypotheses_[j].score > hypotheses_[k].score || (hypotheses_[j].score == hypotheses_[k].score && j < k)) {
      return false;
    }
  }
  return true;
}

const Hypothesis* TargetTracker::best_of(std::uint32_t track) const {
  const Hypothesis* best = nullptr;
  for (std::size_t k = 0; k < count_; ++k) {
    const Hypothesis& hypothesis = hypotheses_[k];
    if (hypothesis.track == track && (best == nullptr || hypothesis.score > best->score)) best = &hypothesis;
  }
  return best;
}

/// Images without an object after which a hypothesis is deleted. The camera of a search looks elsewhere at times: a
/// satellite known as another one must not return as a new track.
int TargetTracker::patience_with(const Hypothesis& hypothesis) const {
  if (!hypothesis.established) return kPatience;
  return work_.is_search && is_another(hypothesis) ? settings_.remember_images : settings_.give_up_images;
}

void TargetTracker::prune() {
  work_.erased.fill(false);
  for (std::size_t k = 0; k < count_; ++k) {
    const Hypothesis& hypothesis = hypotheses_[k];
    const int patience = patience_with(hypothesis);
    const bool hopeless = !hypothesis.established && hypothesis.score < kDropScore;
    const Hypothesis* best = best_of(hypothesis.track);
    // Hypotheses that separated from the track's best one more than kScan images ago.
    const bool parted = best != nullptr && hypothesis.history[kScan - 1] != best->history[kScan - 1];
    if (hopeless || parted || hypothesis.images_since_hit >= patience) work_.erased[k] = true;
  }
  erase_marked();

  merge_accounts();
  merge_tracks();
}

// Two hypotheses of a track that share the last images: the better one stays.
void TargetTracker::merge_accounts() {
  work_.erased.fill(false);
  for (std::size_t a = 0; a < count_; ++a) {
    for (std::size_t b = a + 1; b < count_ && !work_.erased[a]; ++b) {
      const Hypothesis& left = hypotheses_[a];
      const Hypothesis& right = hypotheses_[b];
      if (work_.erased[b] || left.track != right.track || !share_recent(left, right, kSame)) continue;
      work_.erased[left.score >= right.score ? b : a] = true;
    }
  }
  erase_marked();
}

// Two tracks that have become equal: the target's stays, else an established one, else the better one. The other is a
// duplicate that is maintained by the first one's objects.
void TargetTracker::merge_tracks() {
  std::array<std::size_t, kMaxHypotheses> best{};
  std::size_t tracks = 0;
  for (std::size_t k = 0; k < count_; ++k) {
    if (is_best_of_its_track(k)) best[tracks++] = k;
  }
  std::array<bool, kMaxHypotheses> is_ghost{};
  for (std::size_t a = 0; a < tracks; ++a) {
    for (std::size_t b = a + 1; b < tracks && !is_ghost[a]; ++b) {
      const Hypothesis& left = hypotheses_[best[a]];
      const Hypothesis& right = hypotheses_[best[b]];
      if (is_ghost[b] || !agree(left, right) || !moves_as(left, right)) continue;
      bool left_stays = left.score >= right.score;
      if (left.established != right.established) left_stays = left.established;
      if (left.track == target_track_ || right.track == target_track_) left_stays = left.track == target_track_;
      is_ghost[left_stays ? b : a] = true;
    }
  }
  work_.erased.fill(false);
  for (std::size_t t = 0; t < tracks; ++t) {
    if (!is_ghost[t]) continue;
    const std::uint32_t ghost = hypotheses_[best[t]].track;
    for (std::size_t k = 0; k < count_; ++k) {
      if (hypotheses_[k].track == ghost) work_.erased[k] = true;
    }
  }
  erase_marked();
}

bool TargetTracker::moves_as(const Hypothesis& a, const Hypothesis& b) const {
  const SlopeState left = slope_state(a.motion, work_.view, work_.bend, work_.bend_rate);
  const SlopeState right = slope_state(b.motion, work_.view, work_.bend, work_.bend_rate);
  // The floors only keep the sum regular.
  return slope_distance(left.slopes - right.slopes, left.covariance + right.covariance, {1e-6, 1e-8}).square <
         kSameDistance;
}

}  // namespace vbar::fsw::target_tracking
