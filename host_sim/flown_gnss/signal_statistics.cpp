#include "host_sim/flown_gnss/signal_statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vbar::flown_gnss {

using fsw::gnss::Observation;
using fsw::gnss::Signal;

double ElevationBin::sigma() const {
  return count == 0 ? 0.0 : std::sqrt(squares / static_cast<double>(count));
}

std::size_t bin_of(double elevation) {
  const double place = (elevation * 180.0 / std::numbers::pi - kFirstElevation_deg) / kBinWidth_deg;
  return static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(kElevationBins - 1)));
}

ElevationBin sum_of(const ElevationBins& bins) {
  ElevationBin sum;
  for (const ElevationBin& bin : bins) {
    sum.count += bin.count;
    sum.squares += bin.squares;
  }
  return sum;
}

double Correlation::at(std::size_t lag) const {
  if (pairs[0] == 0 || pairs[lag] == 0 || !(products[0] > 0.0)) return 0.0;
  return products[lag] / static_cast<double>(pairs[lag]) / (products[0] / static_cast<double>(pairs[0]));
}

namespace {

/// Lag, counted from `first` on, at which the correlation falls below 1/e of that at `first`.
std::optional<double> decay(const Correlation& correlation, std::size_t first) {
  const double level = correlation.at(first) / std::numbers::e;
  if (!(level > 0.0)) return std::nullopt;
  for (std::size_t lag = first + 1; lag < Correlation::kLags; ++lag) {
    if (correlation.pairs[lag] == 0) return std::nullopt;
    const double before = correlation.at(lag - 1), now = correlation.at(lag);
    if (now < level) return static_cast<double>(lag - 1 - first) + (before - level) / (before - now);
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> Correlation::time() const {
  return decay(*this, 0);
}

std::optional<double> Correlation::time_beside_white() const {
  return decay(*this, 1);
}

void SignalStatistics::add(const fsw::gnss::ObservationEpoch& epoch,
                           const std::function<double(fsw::gnss::SatelliteId)>& elevation) {
  constexpr double kGamma = (fsw::gnss::kL1_Hz / fsw::gnss::kL2_Hz) * (fsw::gnss::kL1_Hz / fsw::gnss::kL2_Hz);
  for (std::size_t k = 0; k + 1 < epoch.count; ++k) {
    const Observation& first = epoch.observations[k];
    const Observation& second = epoch.observations[k + 1];
    if (first.signal != Signal::kGpsL1 || second.signal != Signal::kGpsL2 || first.satellite != second.satellite ||
        !first.phase_usable || !second.phase_usable)
      continue;
    const double l1_m = first.carrier_phase_cycles * fsw::gnss::wavelength(Signal::kGpsL1);
    const double l2_m = second.carrier_phase_cycles * fsw::gnss::wavelength(Signal::kGpsL2);
    const double ionosphere_m = (l1_m - l2_m) / (kGamma - 1.0);
    Arc& arc = open_[first.satellite];
    const double step_s = fsw::seconds(epoch.receiver_time - arc.last);
    const bool continues = !arc.samples.empty() && step_s < 1.5 * interval_s_ && first.lock_time_s > arc.lock_l1_s &&
                           second.lock_time_s > arc.lock_l2_s;
    if (!continues) finish(arc);
    arc.last = epoch.receiver_time;
    arc.lock_l1_s = first.lock_time_s;
    arc.lock_l2_s = second.lock_time_s;
    arc.samples.push_back({elevation(first.satellite), first.pseudorange_m - l1_m - 2.0 * ionosphere_m,
                           second.pseudorange_m - l2_m - 2.0 * kGamma * ionosphere_m, l1_m - l2_m});
  }
}

namespace {

/// Adds a series of one arc, its mean removed.
void add_series(const std::vector<double>& elevations, std::vector<double> values, SignalNoise& noise) {
  double mean = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (double& value : values) value -= mean;
  for (std::size_t k = 0; k < values.size(); ++k) {
    noise.bins[bin_of(elevations[k])].add(values[k]);
    for (std::size_t lag = 0; lag < Correlation::kLags && lag <= k; ++lag) {
      const double product = values[k] * values[k - lag];
      noise.correlation.add(lag, product);
      if (std::min(elevations[k], elevations[k - lag]) > SignalNoise::kHighElevation)
        noise.high_correlation.add(lag, product);
    }
  }
}

}  // namespace

void SignalStatistics::finish(Arc& arc) {
  const std::vector<Sample> samples = std::move(arc.samples);
  arc.samples.clear();
  // Shorter arcs show little of a noise whose mean is removed.
  constexpr std::size_t kMinSamples = 30;
  if (samples.size() < kMinSamples) return;
  // A slip is a step: two second differences of opposite sign.
  constexpr double kSlip_m = 0.05;
  const auto second_difference = [&](std::size_t k) {
    return samples[k + 1].geometry_free_m - 2.0 * samples[k].geometry_free_m + samples[k - 1].geometry_free_m;
  };
  std::size_t begin = 0;
  for (std::size_t k = 1; k + 2 < samples.size(); ++k) {
    const double now_m = second_difference(k), next_m = second_difference(k + 1);
    if (std::abs(now_m) > kSlip_m && std::abs(now_m + next_m) < 0.3 * std::abs(now_m)) {
      ++steps_;
      begin = k + 1;
    }
  }
  ++arcs_;
  satellite_hours_ += static_cast<double>(samples.size()) * interval_s_ / 3600.0;
  for (std::size_t k = 3; k < samples.size(); ++k) {
    const double third_m = samples[k].geometry_free_m - 3.0 * samples[k - 1].geometry_free_m +
                           3.0 * samples[k - 2].geometry_free_m - samples[k - 3].geometry_free_m;
    if (std::abs(third_m) < 2.0 * kSlip_m) carrier_[bin_of(samples[k].elevation)].add(third_m / std::sqrt(20.0));
  }
  // The mean of code less carrier is that behind the last slip.
  std::vector<double> elevations, first, second;
  for (std::size_t k = begin; k < samples.size(); ++k) {
    elevations.push_back(samples[k].elevation);
    first.push_back(samples[k].code_l1_m);
    second.push_back(samples[k].code_l2_m);
  }
  if (first.size() < kMinSamples) return;
  add_series(elevations, first, code_l1_);
  add_series(elevations, second, code_l2_);
}

void SignalStatistics::finish() {
  for (auto& [satellite, arc] : open_) finish(arc);
  open_.clear();
}

}  // namespace vbar::flown_gnss
