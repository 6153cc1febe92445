#include "fsw/vision/target_tracking/target_tracker.h"

#include <algorithm>

#include "fsw/math/math.h"

namespace vbar::fsw::target_tracking {
namespace {

constexpr double kMinProbability = 1e-3;
constexpr double kMaxProbability = 0.99;
// Below this detection probability a missed detection carries no information.
constexpr double kExpected = 0.5;
// A new track's score before its first object: a false detection is more likely.
constexpr double kBirthScore = -2.0;
constexpr double kNarrowGate = 0.02;  // other objects in it
constexpr double kFluxGain = 0.2;
// Limit of the brightness term: the target may show a glint or a penumbra.
constexpr double kMaxDislike = 4.5;
constexpr double kMisfitGain = 0.15;
constexpr double kUnknownDistance = 0.5;  // 1 sigma over the distance of the target

double determinant_of(const Matrix2& m) {
  return m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
}

bool is_direction(const Vector3& d) {
  const double norm = d.squaredNorm();
  return norm > 0.99 && norm < 1.01;
}

}  // namespace

Result<TrackerOutput> TargetTracker::step(const TrackerInput& input) {
  const Status checked = check(input);
  if (checked != Status::kOk) return checked;
  const Result<ServicerView> view = servicer_view(input.servicer);
  if (!view.ok()) return view.status();

  work_.view = view.value();
  work_.has_prediction = input.prediction.has_value();
  work_.is_search = input.is_search && work_.has_prediction;
  work_.kept_prediction = work_.has_prediction ? input.kept : std::nullopt;
  work_.prediction = work_.has_prediction ? *input.prediction : Prediction{};
  const double per_m = -0.5 / work_.view.semi_major_axis;
  work_.bend = per_m * work_.prediction.along_track_m;
  work_.bend_rate = per_m * work_.prediction.along_track_rate;
  const double probability = std::clamp(input.detection_probability, kMinProbability, kMaxProbability);
  work_.detection_probability = probability;
  work_.log_miss = math::log(1.0 - probability);

  select_eligible(input);
  propagate_all(input);
  make_branches();
  grow();
  prune();
  share_objects();
  compare_with_prediction();
  if (probability > kExpected) ++images_watched_;
  choose_target();
  return_to_kept();
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
    if (!math::is_finite(candidate.direction_rtn.sum() + candidate.sigma + candidate.apparent_radius + object.flux_dn +
                         object.centroid_px.sum())) {
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
  for (const std::optional<Prediction>* prediction : {&input.prediction, &input.kept}) {
    if (!prediction->has_value()) continue;
    const Prediction& p = **prediction;
    if (!math::is_finite(p.slopes.sum() + p.covariance.sum() + p.along_track_m + p.along_track_rate +
                         p.along_track_sigma_fraction)) {
      return Status::kNotFinite;
    }
  }
  return Status::kOk;
}

// Removes known hot pixels and objects far from the prediction.
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
      const double determinant = determinant_of(s);
      const double square = s(1, 1) * offset.x() * offset.x() - 2.0 * s(0, 1) * offset.x() * offset.y() +
                            s(0, 0) * offset.y() * offset.y();
      is_in_gate = square <= settings_.prediction_gate * determinant;
      if (!is_in_gate && !is_in_surroundings(measurement.value().slopes)) continue;
    }
    Eligible& eligible = work_.eligible[work_.eligible_count++];
    eligible.measurement = measurement.value();
    eligible.sigma = candidate.sigma;
    eligible.apparent_radius = candidate.apparent_radius;
    eligible.is_in_gate = is_in_gate;
    eligible.log_flux = math::log(candidate.object.flux_dn > 1.0 ? candidate.object.flux_dn : 1.0);
    eligible.handicap =
        candidate.object.sharpness >= settings_.hot_pixels.min_sharpness ? -settings_.sharp_object_loss : 0.0;
    eligible.index = static_cast<std::int16_t>(k);
  }
  const double count = static_cast<double>(std::max<std::size_t>(input.candidates.size() - hot, 1));
  work_.log_density = math::log(count / settings_.field_sr);
  Matrix2 about_prediction = work_.prediction.covariance.topLeftCorner<2, 2>();
  about_prediction.diagonal().array() += settings_.slope_floor * settings_.slope_floor;
  work_.is_prediction_narrow =
      work_.has_prediction && is_narrow(settings_.prediction_gate, determinant_of(about_prediction));
}

/// Returns true about the predictions, where objects outside their gates are tracked too.
bool TargetTracker::is_in_surroundings(const Vector2& slopes) const {
  const double around = settings_.surroundings * settings_.surroundings;
  return (slopes - work_.prediction.slopes.head<2>()).squaredNorm() < around ||
         (work_.kept_prediction && (slopes - work_.kept_prediction->slopes.head<2>()).squaredNorm() < around);
}

/// Returns true if an object of the hypothesis would be a candidate of this image. Another satellite can leave the
/// surroundings of the target, and return half an orbit later: it is not missed meanwhile.
bool TargetTracker::is_expected(const Hypothesis& hypothesis) const {
  if (!(work_.detection_probability > kExpected)) return false;
  if (!work_.has_prediction || !hypothesis.established || hypothesis.track == target_track_) return true;
  const SlopeState state = slope_state(hypothesis.motion, work_.view, work_.bend, work_.bend_rate);
  return is_in_surroundings(state.slopes.head<2>());
}

/// Returns true if few other objects are to be expected in a gate with this determinant of the covariance.
bool TargetTracker::is_narrow(double gate, double determinant) const {
  return math::kPi * gate * math::sqrt(determinant) * math::exp(work_.log_density) < kNarrowGate;
}

void TargetTracker::propagate_all(const TrackerInput& input) {
  const ServicerView& view = work_.view;
  // A burn turns the bearing of a satellite by an angle that its distance decides: that of another one is unknown.
  Prediction of_another = work_.prediction;
  of_another.along_track_sigma_fraction = std::max(of_another.along_track_sigma_fraction, kUnknownDistance);
  for (std::size_t k = 0; k < count_; ++k) {
    RelativeMotion& motion = hypotheses_[k].motion;
    const Prediction& prediction = is_another(hypotheses_[k]) ? of_another : work_.prediction;
    GpsTime now = time_;
    bool alive = true;
    for (const OwnBurn& burn : input.burns) {
      alive = alive && propagate(motion, view, seconds(burn.time - now), settings_.motion);
      const double latitude = view.latitude - view.latitude_rate * seconds(input.time - burn.time);
      apply_burn(motion, burn, latitude, view, prediction, settings_.motion);
      now = burn.time;
    }
    alive = alive && propagate(motion, view, seconds(input.time - now), settings_.motion);
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
    brightness = -std::min(0.5 * off * off, kMaxDislike);
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
  const bool is_missed = !is_hit && is_expected(child);
  child.score = branch.score;
  std::copy(child.history.begin(), child.history.end() - 1, child.history.begin() + 1);
  child.history[0] = kMissed;
  if (is_hit || is_missed) child.recent = (child.recent << 1U) | (is_hit ? 1U : 0U);
  if (!is_hit) {
    if (is_missed) ++child.images_since_hit;
    // Eclipses count as gaps whether or not the target was expected.
    int unseen = 0;
    while (unseen < static_cast<int>(kHistory) && child.history[static_cast<std::size_t>(unseen)] == kMissed) ++unseen;
    if (unseen >= settings_.gap_images) child.hits_since_gap = 0;
    return child;
  }
  const Eligible& candidate = work_.eligible[static_cast<std::size_t>(branch.candidate)];
  const Innovation innovation = innovation_of(child.motion, work_.view, work_.bend, candidate.measurement);
  // After a gap a narrow gate, in which false detections are unlikely, is sufficient.
  const bool is_in_narrow_gate = is_narrow(settings_.association_gate, innovation.determinant);
  update(child.motion, innovation);
  child.history[0] = candidate.index;
  child.misfit += kMisfitGain * (0.5 * innovation.distance - child.misfit);
  const double gain = is_birth ? 1.0 : kFluxGain;
  child.log_flux += gain * (candidate.log_flux - child.log_flux);
  child.apparent_radius += gain * (candidate.apparent_radius - child.apparent_radius);
  child.sigma = candidate.sigma;
  child.images_since_hit = 0;
  ++child.hits;
  child.hits_since_gap = is_in_narrow_gate && child.established && child.hits_since_gap == 0 ? settings_.hits_after_gap
                                                                                             : child.hits_since_gap + 1;
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

}  // namespace vbar::fsw::target_tracking
