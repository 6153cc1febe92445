// Pruning of hypotheses: the part of the tracker that deletes them.

#include "fsw/math/math.h"
#include "fsw/tracking/target_tracker.h"

namespace vbar::fsw::tracking {
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

void TargetTracker::prune() {
  work_.erased.fill(false);
  for (std::size_t k = 0; k < count_; ++k) {
    const Hypothesis& hypothesis = hypotheses_[k];
    const int patience = hypothesis.established ? settings_.give_up_images : kPatience;
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

}  // namespace vbar::fsw::tracking
