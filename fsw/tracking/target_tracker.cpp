#include "fsw/tracking/target_tracker.h"

#include <algorithm>

#include "fsw/math/math.h"

namespace vbar::fsw::tracking {
namespace {

constexpr double kLeastProbability = 1e-3;
constexpr double kMostProbability = 0.99;
// Below it an image says nothing by not showing the target.
constexpr double kExpected = 0.5;
// A new track's score before its first object: it is sooner a false detection.
constexpr double kBirthScore = -2.0;
constexpr double kDropScore = -7.0;
// An unestablished track that was missed so often in a row is dropped.
constexpr int kPatience = 3;
constexpr std::size_t kScan = 5;  // images after which only one account of a track remains
constexpr std::size_t kSame = 3;  // images that two accounts must share to be one
constexpr double kSameDistance = 25.0;  // chi-square, 4 degrees of freedom: 5e-5
constexpr double kAlone = 99.0;
constexpr double kNarrowGate = 0.02;  // false detections in it
constexpr int kRivalHits = 3;
constexpr int kOwnObjects = 2;
constexpr int kDeposeAfter = 3;
constexpr double kFluxGain = 0.2;
constexpr double kMisfitGain = 0.15;
constexpr double kMostMisfit = 9.0;  // (3 sigma)^2

bool is_direction(const Vector3& d) {
  const double norm = d.squaredNorm();
  return norm > 0.99 && norm < 1.01;
}

}  // namespace

void TargetTracker::forget_tracks() {
  count_ = 0;
  target_track_ = 0;
  images_watched_ = 0;
  deposing_images_ = 0;
}

Result<TrackerOutput> TargetTracker::step(const TrackerInput& input) {
  const Status checked = check(input);
  if (checked != Status::kOk) return checked;
  const Result<ServicerView> view = servicer_view(input.servicer);
  if (!view.ok()) return view.status();

  work_.view = view.value();
  work_.has_prediction = input.prediction.has_value();
  work_.prediction = work_.has_prediction ? *input.prediction : Prediction{};
  const double per_m = -0.5 / work_.view.semi_major_axis;
  work_.bend = per_m * work_.prediction.along_track_m;
  work_.bend_rate = per_m * work_.prediction.along_track_rate;
  const double probability = std::clamp(input.detection_probability, kLeastProbability, kMostProbability);
  work_.detection_probability = probability;
  work_.log_miss = math::log(1.0 - probability);
  const double dt = has_image_ ? seconds(input.time - time_) : 0.0;

  select_eligible(input);
  propagate_all(input);
  make_branches();
  grow();
  compare_with_prediction(dt);
  prune();
  if (probability > kExpected) ++images_watched_;
  choose_target();
  has_image_ = true;
  time_ = input.time;
  return report();
}

Status TargetTracker::check(const TrackerInput& input) const {
  if (has_image_ && input.time <= time_) return Status::kInvalidArgument;
  if (input.candidates.size() > kMaxCandidates) return Status::kTooLong;
  if (!(input.detection_probability >= 0.0 && input.detection_probability <= 1.0)) return Status::kOutOfRange;
  for (const Candidate& candidate : input.candidates) {
    const imaging::DetectedObject& object = candidate.object;
    if (!math::is_finite(candidate.direction_rtn.sum() + candidate.sigma + object.flux_dn + object.centroid_px.sum())) {
      return Status::kNotFinite;
    }
    if (!is_direction(candidate.direction_rtn) || !(candidate.sigma > 0.0)) return Status::kOutOfRange;
  }
  GpsTime last = has_image_ ? time_ : GpsTime{};
  for (const OwnBurn& burn : input.burns) {
    if (!math::is_finite(burn.dv_rtn.sum() + burn.sigma)) return Status::kNotFinite;
    if (burn.sigma < 0.0) return Status::kOutOfRange;
    if (burn.time < last || burn.time > input.time) return Status::kInvalidArgument;
    last = burn.time;
  }
  if (input.prediction) {
    const Prediction& p = *input.prediction;
    if (!math::is_finite(p.slopes.sum() + p.covariance.sum() + p.along_track_m + p.along_track_rate +
                         p.along_track_sigma_fraction)) {
      return Status::kNotFinite;
    }
  }
  return Status::kOk;
}

// Leaves out known hot pixels and what is far from the prediction.
void TargetTracker::select_eligible(const TrackerInput& input) {
  hot_pixels_.begin_image();
  work_.eligible_count = 0;
  std::size_t hot = 0;
  const Vector2 predicted = work_.prediction.slopes.head<2>();
  for (std::size_t k = 0; k < input.candidates.size(); ++k) {
    const Candidate& candidate = input.candidates[k];
    if (hot_pixels_.see(candidate.object)) {
      ++hot;
      continue;
    }
    const Result<SlopeMeasurement> measurement =
        slope_measurement(candidate.direction_rtn, candidate.sigma, settings_.motion);
    if (!measurement.ok()) continue;
    bool is_in_gate = true;
    if (work_.has_prediction) {
      const Vector2 offset = measurement.value().slopes - predicted;
      Matrix2 s = work_.prediction.covariance.topLeftCorner<2, 2>();
      s.diagonal() += measurement.value().variance;
      s.diagonal().array() += settings_.slope_floor * settings_.slope_floor;
      const double determinant = s(0, 0) * s(1, 1) - s(0, 1) * s(1, 0);
      const double square = s(1, 1) * offset.x() * offset.x() - 2.0 * s(0, 1) * offset.x() * offset.y() +
                            s(0, 0) * offset.y() * offset.y();
      is_in_gate = square <= settings_.prediction_gate * determinant;
      if (!is_in_gate && !(offset.squaredNorm() < settings_.surroundings * settings_.surroundings)) continue;
    }
    Eligible& eligible = work_.eligible[work_.eligible_count++];
    eligible.measurement = measurement.value();
    eligible.is_in_gate = is_in_gate;
    eligible.log_flux = math::log(candidate.object.flux_dn > 1.0 ? candidate.object.flux_dn : 1.0);
    eligible.handicap =
        candidate.object.pixels <= settings_.hot_pixels.most_pixels ? -settings_.small_object_loss : 0.0;
    eligible.index = static_cast<std::int16_t>(k);
  }
  const double count = static_cast<double>(std::max<std::size_t>(input.candidates.size() - hot, 1));
  work_.log_density = math::log(count / settings_.field_sr);
}

void TargetTracker::propagate_all(const TrackerInput& input) {
  const ServicerView& view = work_.view;
  for (std::size_t k = 0; k < count_; ++k) {
    RelativeMotion& motion = hypotheses_[k].motion;
    GpsTime now = time_;
    bool alive = true;
    for (const OwnBurn& burn : input.burns) {
      alive = alive && propagate(motion, view.mean_motion, seconds(burn.time - now), settings_.motion);
      const double latitude = view.latitude - view.latitude_rate * seconds(input.time - burn.time);
      apply_burn(motion, burn, latitude, view, work_.prediction, settings_.motion);
      now = burn.time;
    }
    alive = alive && propagate(motion, view.mean_motion, seconds(input.time - now), settings_.motion);
    work_.erased[k] = !alive;
  }
  erase_marked();
}

double TargetTracker::gain_of(const Hypothesis& parent, const Innovation& innovation, const Eligible& candidate) const {
  const double likelihood = math::log(work_.detection_probability) - math::log(math::kTwoPi) -
                            0.5 * math::log(innovation.determinant) - 0.5 * innovation.distance - work_.log_density;
  double brightness = 0.0;
  if (parent.hits > 0) {
    constexpr double kMagnitudesPerLog = 1.0857362047581296;  // 2.5 / ln 10
    const double off = (candidate.log_flux - parent.log_flux) * kMagnitudesPerLog / settings_.magnitude_sigma;
    brightness = -std::min(0.5 * off * off, 2.0);
  }
  return likelihood + brightness + candidate.handicap;
}

void TargetTracker::make_branches() {
  work_.branch_count = 0;
  const auto add = [this](std::int16_t parent, std::int16_t candidate, bool established, double score) {
    if (work_.branch_count < kMaxBranches) {
      work_.branches[work_.branch_count++] = {parent, candidate, established, score};
    }
  };
  for (std::size_t h = 0; h < count_; ++h) {
    const Hypothesis& parent = hypotheses_[h];
    const std::int16_t place = static_cast<std::int16_t>(h);
    add(place, kMissed, parent.established, parent.score + work_.log_miss);
    for (std::size_t c = 0; c < work_.eligible_count; ++c) {
      const Eligible& candidate = work_.eligible[c];
      if (parent.track == target_track_ && !candidate.is_in_gate) continue;
      const Innovation innovation = innovation_of(parent.motion, work_.view, work_.bend, candidate.measurement);
      if (!(innovation.distance <= settings_.association_gate) || !(innovation.determinant > 0.0)) continue;
      add(place, static_cast<std::int16_t>(c), parent.established,
          parent.score + gain_of(parent, innovation, candidate));
    }
  }
  for (std::size_t c = 0; c < work_.eligible_count; ++c) {
    add(-1, static_cast<std::int16_t>(c), false, kBirthScore + work_.eligible[c].handicap);
  }
}

Hypothesis TargetTracker::child_of(const Branch& branch) {
  const bool is_birth = branch.parent < 0;
  Hypothesis child;
  if (is_birth) {
    child.motion = unknown_motion(settings_.motion);
    child.track = next_track_++;
    child.history.fill(kUnborn);
  } else {
    child = hypotheses_[static_cast<std::size_t>(branch.parent)];
  }
  const bool is_hit = branch.candidate >= 0;
  const bool is_expected = work_.detection_probability > kExpected;
  child.score = branch.score;
  std::copy(child.history.begin(), child.history.end() - 1, child.history.begin() + 1);
  child.history[0] = kMissed;
  if (is_hit || is_expected) child.recent = (child.recent << 1U) | (is_hit ? 1U : 0U);
  if (!is_hit) {
    if (is_expected) ++child.images_since_hit;
    // Eclipses count as gaps whether or not the target was expected.
    int unseen = 0;
    while (unseen < static_cast<int>(kHistory) && child.history[static_cast<std::size_t>(unseen)] == kMissed) ++unseen;
    if (unseen >= settings_.gap_images) child.hits_since_gap = 0;
    return child;
  }
  const Eligible& candidate = work_.eligible[static_cast<std::size_t>(branch.candidate)];
  const Innovation innovation = innovation_of(child.motion, work_.view, work_.bend, candidate.measurement);
  // After a gap a narrow gate, in which hardly anything else can be, needs no further proof.
  const double gate_sr = math::kPi * settings_.association_gate * math::sqrt(innovation.determinant);
  const bool is_narrow = gate_sr * math::exp(work_.log_density) < kNarrowGate;
  update(child.motion, innovation);
  child.history[0] = candidate.index;
  child.misfit += kMisfitGain * (0.5 * innovation.distance - child.misfit);
  child.log_flux += (is_birth ? 1.0 : kFluxGain) * (candidate.log_flux - child.log_flux);
  child.images_since_hit = 0;
  ++child.hits;
  child.hits_since_gap = is_narrow && child.established && child.hits_since_gap == 0 ? settings_.hits_after_gap
                                                                                     : child.hits_since_gap + 1;
  if (hits_of(child.recent, settings_.confirm_images) >= settings_.confirm_hits && child.misfit < kMostMisfit) {
    child.established = true;
  }
  return child;
}

// The best branches become the hypotheses.
void TargetTracker::grow() {
  const auto end = work_.branches.begin() + static_cast<std::ptrdiff_t>(work_.branch_count);
  std::sort(work_.branches.begin(), end, [](const Branch& a, const Branch& b) {
    if (a.established != b.established) return a.established;
    if (a.score != b.score) return a.score > b.score;
    if (a.parent != b.parent) return a.parent < b.parent;
    return a.candidate < b.candidate;
  });
  const std::size_t kept = std::min(work_.branch_count, kMaxHypotheses);
  for (std::size_t k = 0; k < kept; ++k) work_.children[k] = child_of(work_.branches[k]);
  std::copy_n(work_.children.begin(), kept, hypotheses_.begin());
  count_ = kept;
}

void TargetTracker::compare_with_prediction(double dt) {
  const double faded = math::exp(-dt / settings_.identity_memory_s);
  for (std::size_t k = 0; k < count_; ++k) {
    Hypothesis& hypothesis = hypotheses_[k];
    if (!work_.has_prediction) continue;
    const SlopeState state = slope_state(hypothesis.motion, work_.view, work_.bend, work_.bend_rate);
    hypothesis.identity_now =
        distance_between(state.slopes, state.covariance, work_.prediction.slopes, work_.prediction.covariance,
                         settings_.slope_floor, settings_.rate_floor);
    hypothesis.identity = std::max(hypothesis.identity * faded, hypothesis.identity_now);
  }
}

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

void TargetTracker::prune() {
  work_.erased.fill(false);
  for (std::size_t k = 0; k < count_; ++k) {
    const Hypothesis& hypothesis = hypotheses_[k];
    const int patience = hypothesis.established ? settings_.give_up_images : kPatience;
    const bool hopeless = !hypothesis.established && hypothesis.score < kDropScore;
    const Hypothesis* best = best_of(hypothesis.track);
    // Accounts that parted from the track's best one more than kScan images ago.
    const bool parted = best != nullptr && hypothesis.history[kScan - 1] != best->history[kScan - 1];
    if (hopeless || parted || hypothesis.images_since_hit >= patience) work_.erased[k] = true;
  }
  erase_marked();

  merge_accounts();
  merge_tracks();
}

// Of two accounts of a track that share the last images the better stays.
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

// Of two tracks that have become the same the target's stays, else an established one, else the better: the other is a
// ghost that lives on the first one's objects.
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
  return distance_between(left.slopes, left.covariance, right.slopes, right.covariance, 1e-6, 1e-8) < kSameDistance;
}

void TargetTracker::choose_target() {
  // The track nearest to the prediction, and the nearest of its rivals.
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
  // A target stays the target unless the prediction speaks against it for some time.
  const bool misplaced = target->history[0] >= 0 && target->identity_now > settings_.identity_gate;
  const bool beaten = best->track != target_track_ && best->established &&
                      0.5 * (target->identity_now - best->identity) > settings_.identity_margin;
  deposing_images_ = misplaced || beaten ? deposing_images_ + 1 : 0;
  if (deposing_images_ >= kDeposeAfter) {
    target_track_ = 0;
    deposing_images_ = 0;
  }
}

// By how much a track's best account with the candidate in this image beats its best one without; no account with it
// or none without: -kAlone or kAlone.
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

// The strongest claim of another satellite's track to the target's candidate. A short track is another satellite's if
// it saw objects that the target's did not.
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
  // Either the target shows and the rival is missed, or the other way round.
  const double odds = math::log(settings_.certainty / (1.0 - settings_.certainty));
  const bool own = claim(target_track_, seen) > rival_claim(*target) + odds;
  const bool fits = target->misfit < kMostMisfit && target->hits_since_gap >= settings_.hits_after_gap;
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
