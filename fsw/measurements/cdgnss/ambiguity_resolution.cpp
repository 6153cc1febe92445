#include "fsw/measurements/cdgnss/ambiguity_resolution.h"

#include <optional>
#include <span>

namespace vbar::fsw::measurements {
namespace {

static_assert(kPhaseChannels <= gnss::kMaxFloatAmbiguities);

/// The reference channel of the double differences of a signal: a held one if there is one, otherwise the one tracked
/// longest.
std::optional<std::size_t> reference_of(const PhaseChannels& channels, gnss::Signal signal) {
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < kPhaseChannels; ++k) {
    const PhaseChannel& channel = channels[k];
    if (!channel.in_use || channel.signal != signal || channel.epochs == 0) continue;
    if (!best) {
      best = k;
      continue;
    }
    const PhaseChannel& so_far = channels[*best];
    if (channel.fixed != so_far.fixed ? channel.fixed : channel.epochs > so_far.epochs) best = k;
  }
  return best;
}

}  // namespace

void AmbiguityResolution::reset() {
  suspicious_in_a_row_ = 0;
  contradicted_ = 0;
  report_.tracked = 0;
  report_.fixed = 0;
}

void AmbiguityResolution::update(CarrierFilter& carrier, filter::RelativeNavigationFilter& filter,
                                 const CarrierUpdate& epoch, const AmbiguitySettings& settings) {
  count(carrier);
  watch(carrier, filter, epoch, settings);
  if (settings.enabled) decide(carrier, filter, settings);
  count(carrier);
}

void AmbiguityResolution::count(const CarrierFilter& carrier) {
  report_.tracked = 0;
  report_.fixed = 0;
  for (std::size_t k = 0; k < kPhaseChannels; ++k) {
    const PhaseChannel& channel = carrier.channels()[k];
    if (!channel.in_use || channel.epochs == 0) continue;
    ++report_.tracked;
    if (channel.fixed) ++report_.fixed;
  }
}

void AmbiguityResolution::watch(CarrierFilter& carrier, filter::RelativeNavigationFilter& filter,
                                const CarrierUpdate& epoch, const AmbiguitySettings& settings) {
  // A single undetected cycle slip is corrected by the others. If many contradict at once, the few that agree with
  // the state may be the wrong ones.
  contradicted_ = contradicted_ / 2 + epoch.contradictions;
  const std::int32_t held_before = report_.fixed + contradicted_;
  const bool many_contradict = held_before > kMinHeld && 3 * contradicted_ > held_before;
  if (is_fixed() && epoch.phases_used + epoch.phases_rejected >= kMinHeld) {
    const bool disagree = epoch.phase_nis > settings.suspicious_nis * epoch.phases_used;
    const bool rejected = 3 * (epoch.phases_rejected + epoch.slips) > epoch.phases_used + epoch.phases_rejected;
    suspicious_in_a_row_ = disagree || rejected ? suspicious_in_a_row_ + 1 : 0;
  }
  if (!many_contradict && suspicious_in_a_row_ < settings.suspicious_epochs) return;
  release(carrier, filter, settings.release_sigma_m);
}

void AmbiguityResolution::release(CarrierFilter& carrier, filter::RelativeNavigationFilter& filter,
                                  double position_sigma_m) {
  carrier.release(filter, position_sigma_m);
  suspicious_in_a_row_ = 0;
  contradicted_ = 0;
  ++report_.releases;
}

void AmbiguityResolution::decide(CarrierFilter& carrier, filter::RelativeNavigationFilter& filter,
                                 const AmbiguitySettings& settings) {
  gather(carrier, settings.min_epochs);
  if (offer_.count == 0) return;
  fill(carrier, filter);
  gnss::ValidationCriteria criteria;
  criteria.min_success_rate = settings.min_success_rate;
  criteria.min_ratio = settings.min_ratio;
  // The held integers already fix the baseline: a single further one is accepted.
  criteria.min_count = is_fixed() ? 1 : static_cast<std::size_t>(kMinHeld);
  const auto decision =
      gnss::decide_ambiguities(std::span(floats_).first(offer_.count),
                               std::span(covariance_).first(offer_.count * offer_.count), criteria, workspace_);
  if (!decision.ok()) {
    report_.rejection_reason = gnss::RejectionReason::kSearch;
    return;
  }
  const gnss::AmbiguityDecision& decided = decision.value();
  report_.rejection_reason = decided.rejection_reason;
  report_.success_rate = decided.success_rate;
  report_.ratio = decided.ratio;
  for (std::size_t k = 0; k < decided.count; ++k) {
    const std::size_t place = decided.position[k];
    carrier.hold(filter, offer_.place[place], offer_.reference[place], decided.whole[k]);
  }
  if (decided.count > 0) ++report_.fixes;
}

void AmbiguityResolution::gather(const CarrierFilter& carrier, int min_epochs) {
  offer_.count = 0;
  for (std::size_t signal = 0; signal < gnss::kSignals; ++signal) {
    const std::optional<std::size_t> reference = reference_of(carrier.channels(), static_cast<gnss::Signal>(signal));
    if (!reference) continue;
    for (std::size_t k = 0; k < kPhaseChannels; ++k) {
      const PhaseChannel& channel = carrier.channels()[k];
      const bool is_offered = channel.in_use && static_cast<std::size_t>(channel.signal) == signal && k != *reference &&
                              !channel.fixed && channel.epochs >= min_epochs;
      if (!is_offered) continue;
      offer_.place[offer_.count] = static_cast<std::uint8_t>(k);
      offer_.reference[offer_.count] = static_cast<std::uint8_t>(*reference);
      ++offer_.count;
    }
  }
}

void AmbiguityResolution::fill(const CarrierFilter& carrier, const filter::RelativeNavigationFilter& filter) {
  const filter::Estimate& estimate = filter.estimate();
  for (std::size_t c = 0; c < offer_.count; ++c) {
    const int c1 = CarrierFilter::ambiguity_index(offer_.place[c]);
    const int c0 = CarrierFilter::ambiguity_index(offer_.reference[c]);
    const double c_wavelength = gnss::wavelength(carrier.channels()[offer_.place[c]].signal);
    floats_[c] = (estimate.mean(c1) - estimate.mean(c0)) / c_wavelength;
    for (std::size_t r = 0; r < offer_.count; ++r) {
      const int r1 = CarrierFilter::ambiguity_index(offer_.place[r]);
      const int r0 = CarrierFilter::ambiguity_index(offer_.reference[r]);
      const double r_wavelength = gnss::wavelength(carrier.channels()[offer_.place[r]].signal);
      const double metres2 = estimate.covariance(r1, c1) - estimate.covariance(r1, c0) - estimate.covariance(r0, c1) +
                             estimate.covariance(r0, c0);
      covariance_[c * offer_.count + r] = metres2 / (r_wavelength * c_wavelength);
    }
  }
}

}  // namespace vbar::fsw::measurements
