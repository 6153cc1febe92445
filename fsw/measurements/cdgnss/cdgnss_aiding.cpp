#include "fsw/measurements/cdgnss/cdgnss_aiding.h"

#include <Eigen/Geometry>

#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"
#include "fsw/orbit/gravity_field.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::measurements {
namespace {

// Gate of a baseline's normalised innovation squared: 5 sigma of three degrees of freedom.
constexpr double kBaselineGate = 25.0;

constexpr double square(double x) {
  return x * x;
}

bool has_burn_since(GpsTime time, const filter::RelativeNavigationFilter& filter) {
  for (const filter::Impulse& impulse : filter.impulses()) {
    if (impulse.time >= time) return true;
  }
  return false;
}

}  // namespace

void CdgnssAiding::configure(const CarrierSettings& settings) {
  has_changed_ = has_changed_ || !(settings.filter == settings_.filter) ||
                 settings.servicer_antenna_body_m != settings_.servicer_antenna_body_m ||
                 settings.target_antenna_body_m != settings_.target_antenna_body_m;
  settings_ = settings;
  filter_.configure(settings.filter);
}

bool CdgnssAiding::process(const PairEpoch& pair, filter::RelativeNavigationFilter& filter) {
  const GpsTime tag = pair.ours.receiver_time;
  last_update_ = CarrierUpdate{};
  if (!filter.absolute_orbit().started() || tag != filter.epoch() || pair.theirs.receiver_time != tag) {
    ++counters_.not_admitted;
    return false;
  }
  if (!aid_.is_on()) aid_.go_to(AidState::kWaiting, tag);
  if (filter.is_confirmed_by_others(kSource)) share_orbit();
  watch(tag, filter);
  const auto their_point = gnss::single_point(pair.theirs, pair.ephemerides, pair.frame);
  if (!their_point.ok() || !pair.R_eci_servicer || !pair.R_eci_target) {
    ++counters_.no_solution;
    return false;
  }
  if (!admit(pair, their_point.value(), filter)) {
    ++counters_.not_admitted;
    return false;
  }
  filter_.activate_blocks(filter);
  const AntennaPlatform servicer{.R_eci_body = *pair.R_eci_servicer,
                                 .antenna_body_m = settings_.servicer_antenna_body_m,
                                 .clock_m = pair.servicer_clock_m};
  const AntennaPlatform target{.R_eci_body = *pair.R_eci_target,
                               .antenna_body_m = settings_.target_antenna_body_m,
                               .clock_m = their_point.value().clock_m};
  gnss::form_differences(pair.ours, pair.theirs, pair.ephemerides, pair.frame, differences_);
  last_update_ = filter_.process_epoch(differences_, servicer, target, filter);
  last_pair_ = tag;
  ++counters_.pairs;
  counters_.codes_rejected += last_update_.codes_rejected;
  counters_.phases_rejected += last_update_.phases_rejected;
  counters_.slips += last_update_.slips;
  aid_.consistency().add(last_update_.code_nis + last_update_.phase_nis,
                         last_update_.codes_used + last_update_.phases_used);
  judge(tag, filter);
  return true;
}

/// Judges, after an update, whether the codes contradict the orbit; otherwise the integers.
void CdgnssAiding::judge(GpsTime time, filter::RelativeNavigationFilter& filter) {
  const bool is_contradicted = last_update_.codes_rejected > last_update_.codes_used;
  contradicted_in_a_row_ = is_contradicted ? contradicted_in_a_row_ + 1 : 0;
  if (contradicted_in_a_row_ >= kMaxContradicted || !filter.has_relative()) {
    give_up(time, filter);
    return;
  }
  if (last_update_.codes_used > 0) filter.confirm_relative(kSource);
  aid_.go_to(AidState::kAiding, time);
  if (last_update_.displacement_ratio > 0.0) aid_.note_inconsistency(math::sqrt(last_update_.displacement_ratio));
  judge_integers(filter);
  judge_antennas(filter);
}

/// Held integers that the phases contradict are released one by one or together: an inconsistency either way.
void CdgnssAiding::judge_integers(filter::RelativeNavigationFilter& filter) {
  const std::int32_t releases = ambiguities_.report().releases;
  ambiguities_.update(filter_, filter, last_update_, settings_.ambiguities);
  if (last_update_.contradictions == 0 && ambiguities_.report().releases == releases) return;
  const std::int32_t used = last_update_.phases_used;
  aid_.note_inconsistency(used > 0 ? last_update_.phase_nis / used : 0.0);
}

/// A baseline between antennas that are not where they are assumed is fixed and precise, and wrong. Its motion
/// contradicts the dynamics of the orbit, which the offsets of the antennas then follow.
void CdgnssAiding::judge_antennas(filter::RelativeNavigationFilter& filter) {
  const double misfit = filter_.antenna_misfit(filter.estimate());
  if (!(misfit > kMaxAntennaMisfit)) return;
  ambiguities_.release(filter_, filter, misfit * filter_.antenna_sigma_m());
  filter_.widen_antennas(filter, misfit);
  aid_.note_inconsistency(misfit);
}

void CdgnssAiding::suspend(GpsTime now, filter::RelativeNavigationFilter& filter) {
  CarrierFilter::deactivate_epoch_states(filter);
  filter_.deactivate_channels(filter);
  ambiguities_.reset();
  aid_.go_to(AidState::kSuspended, now);
}

void CdgnssAiding::watch(GpsTime now, filter::RelativeNavigationFilter& filter) {
  if (has_changed_) {
    discard(filter);
    has_changed_ = false;
    if (aid_.is_on()) aid_.go_to(AidState::kWaiting, now);
  }
  if (aid_.state() == AidState::kFailed && now - aid_.since() > kFailedPause) aid_.go_to(AidState::kWaiting, now);
  if (!last_pair_) return;
  const Duration silent = now - *last_pair_;
  if (aid_.state() == AidState::kAiding && silent > kSilence) {
    CarrierFilter::deactivate_epoch_states(filter);
    aid_.go_to(AidState::kSuspended, now);
  }
  if (aid_.state() != AidState::kSuspended) return;
  if (silent > kKept) {
    filter_.deactivate_channels(filter);
    ambiguities_.reset();
  }
  if (silent > kEmpiricalKept) filter::deactivate_block<filter::EmpiricalAcceleration>(filter.estimate());
}

/// Whether the pair may update the relative orbit; begins the orbit if there is none.
bool CdgnssAiding::admit(const PairEpoch& pair, const gnss::SinglePoint& their_point,
                         filter::RelativeNavigationFilter& filter) {
  const GpsTime tag = pair.ours.receiver_time;
  const bool has_blocks = filter::is_active<ServicerAntenna>(filter.estimate());
  if ((aid_.state() == AidState::kAiding || aid_.state() == AidState::kSuspended) && !has_blocks) {
    // The filter has discarded its estimate.
    discard(filter);
    aid_.go_to(AidState::kWaiting, tag);
  }
  if (filter.solution_status() <= filter::SolutionStatus::kApriori || (must_begin_ && owns_orbit_)) {
    aid_.go_to(AidState::kStarting, tag);
    return begin_orbit(pair, their_point, filter);
  }
  switch (aid_.state()) {
    case AidState::kAiding:
    case AidState::kSuspended:
      return true;
    case AidState::kFailed:
      return false;
    case AidState::kOff:
    case AidState::kWaiting:
    case AidState::kStarting:
      break;
  }
  aid_.go_to(AidState::kStarting, tag);
  agreeing_in_a_row_ = agrees(pair, their_point, filter) ? agreeing_in_a_row_ + 1 : 0;
  return agreeing_in_a_row_ >= kMinAgreeing;
}

/// Differences of single-point solutions cancel errors of orbits and clocks.
std::optional<CdgnssAiding::CodeBaseline> CdgnssAiding::code_baseline(
    const PairEpoch& pair, const gnss::SinglePoint& their_point, const filter::RelativeNavigationFilter& filter) const {
  const auto our_point = gnss::single_point(pair.ours, pair.ephemerides, pair.frame);
  if (!our_point.ok()) return std::nullopt;
  const double apart_s = (their_point.clock_m - our_point.value().clock_m) / gnss::kSpeedOfLight;
  CodeBaseline baseline;
  baseline.relative_eci = their_point.position_eci - *pair.R_eci_target * settings_.target_antenna_body_m -
                          our_point.value().position_eci + *pair.R_eci_servicer * settings_.servicer_antenna_body_m +
                          apart_s * filter.servicer().velocity_eci;
  baseline.noise_m = math::hypot(our_point.value().sigma_m, their_point.sigma_m);
  baseline.sigma_m = math::hypot(settings_.start_sigma_m, baseline.noise_m);
  return baseline;
}

/// From two baselines: the difference of codes cancels in the velocity what both have in common, and a velocity assumed
/// from the separation alone would leave elements so uncertain that their curvature exceeds the codes.
bool CdgnssAiding::begin_orbit(const PairEpoch& pair, const gnss::SinglePoint& their_point,
                               filter::RelativeNavigationFilter& filter) {
  const GpsTime tag = pair.ours.receiver_time;
  const auto baseline = code_baseline(pair, their_point, filter);
  if (!baseline) return false;
  const bool is_first = !first_baseline_ || tag - first_baseline_->time > kBaselinesApart ||
                        has_burn_since(first_baseline_->time, filter);
  if (is_first) {
    first_baseline_ = FirstBaseline{tag, *baseline};
    return false;
  }
  const orbit::CartesianState servicer = filter.servicer();
  const double dt = seconds(tag - first_baseline_->time);
  const Vector3& relative = baseline->relative_eci;
  // Gravity gradient of a point mass over the interval.
  const double distance = math::sqrt(servicer.position_eci.squaredNorm());
  const Vector3 up = servicer.position_eci / distance;
  const Vector3 acceleration = orbit::kMu / (distance * distance * distance) * (3.0 * up.dot(relative) * up - relative);
  const Vector3 velocity = (relative - first_baseline_->baseline.relative_eci) / dt + 0.5 * dt * acceleration;
  const double noise_m = math::hypot(baseline->noise_m, first_baseline_->baseline.noise_m);
  const orbit::CartesianState target{.position_eci = servicer.position_eci + relative,
                                     .velocity_eci = servicer.velocity_eci + velocity};
  const auto roe = orbit::roe_of_target(servicer, target);
  const auto jacobian = roe_from_target_jacobian(servicer, target);
  if (!roe.ok() || !jacobian.ok()) return false;
  Matrix6 scaled = jacobian.value();
  scaled.leftCols<3>() *= baseline->sigma_m;
  const double velocity_sigma = 2.0 * noise_m / dt;
  scaled.rightCols<3>() *=
      velocity_sigma < settings_.start_velocity_sigma ? velocity_sigma : settings_.start_velocity_sigma;
  discard(filter);
  filter.initialize_relative(roe.value(), scaled.lazyProduct(scaled.transpose()), filter::SolutionStatus::kEstimated);
  if (counters_.starts++ > 0) ++counters_.restarts;
  owns_orbit_ = true;
  must_begin_ = false;
  return true;
}

/// Whether a code baseline agrees with the relative orbit of the filter.
bool CdgnssAiding::agrees(const PairEpoch& pair, const gnss::SinglePoint& their_point,
                          const filter::RelativeNavigationFilter& filter) const {
  const auto baseline = code_baseline(pair, their_point, filter);
  const auto target = filter.target();
  if (!baseline || !target.ok()) return false;
  const Vector3 apart = baseline->relative_eci - (target.value().position_eci - filter.servicer().position_eci);
  const math::Cholesky<3> factor(filter.position_covariance_eci() + square(baseline->sigma_m) * Matrix3::Identity());
  return factor.ok() && factor.solve_lower(apart).squaredNorm() <= kBaselineGate;
}

void CdgnssAiding::discard(filter::RelativeNavigationFilter& filter) {
  filter_.deactivate_blocks(filter);
  ambiguities_.reset();
  agreeing_in_a_row_ = 0;
  contradicted_in_a_row_ = 0;
  first_baseline_.reset();
}

void CdgnssAiding::stop(GpsTime now, filter::RelativeNavigationFilter& filter) {
  if (aid_.is_on()) discard(filter);
  aid_.go_to(AidState::kOff, now);
}

/// The own blocks are discarded. An orbit that this source has initialised is initialised again at the next pair; that
/// of another source stays.
void CdgnssAiding::give_up(GpsTime time, filter::RelativeNavigationFilter& filter) {
  ++counters_.failures;
  discard(filter);
  if (owns_orbit_) filter.mark_inconsistent();
  must_begin_ = owns_orbit_;
  aid_.go_to(AidState::kFailed, time);
}

}  // namespace vbar::fsw::measurements
