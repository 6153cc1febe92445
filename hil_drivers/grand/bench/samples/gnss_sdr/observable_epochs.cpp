#include "hil_drivers/grand/bench/samples/gnss_sdr/observable_epochs.h"

#include <algorithm>
#include <cmath>

#include "host_sim/twins/gnss/satellite.h"

namespace vbar::grand::bench {
namespace {

constexpr std::int64_t kMaxWait_ms = 500;
constexpr double kWholeMillisecond = 1e-3;  // ms: a clock that shows less than a millisecond makes no epoch
constexpr std::int64_t kHalfWeek_ms = 302'400'000;

}  // namespace

void ObservableEpochs::take(const Observable& observable) {
  const double ms = observable.rx_time_s * 1e3;
  const std::int64_t rx_time_ms = std::llround(ms);
  if (observable.rx_time_s <= 0.0 || std::abs(ms - static_cast<double>(rx_time_ms)) > kWholeMillisecond) return;
  if (last_ms_ - rx_time_ms > kHalfWeek_ms) {  // a new week
    pending_.clear();
    locks_.clear();
    newest_ms_ = last_ms_ = 0;
  }
  if (rx_time_ms <= last_ms_) return;
  newest_ms_ = std::max(newest_ms_, rx_time_ms);
  Pending& pending = pending_[rx_time_ms];
  ++pending.received;
  if (observable.valid) pending.by_satellite[observable.prn] = observable;
}

std::optional<ObservableEpoch> ObservableEpochs::next() {
  if (pending_.empty()) return std::nullopt;
  const auto first = pending_.begin();
  if (first->second.received < channels_ && newest_ms_ - first->first < kMaxWait_ms) return std::nullopt;
  ObservableEpoch epoch = finished(first->first, first->second);
  last_ms_ = first->first;
  pending_.erase(first);
  return epoch;
}

ObservableEpoch ObservableEpochs::finished(std::int64_t rx_time_ms, const Pending& pending) {
  ObservableEpoch epoch{rx_time_ms, {}};
  const double wavelength_m = twins::gnss::wavelength_m(twins::gnss::Signal::kGpsL1);
  for (const auto& [prn, observable] : pending.by_satellite) {
    Lock& lock = locks_[prn];
    const bool continues = lock.last_ms != 0 && lock.channel == observable.channel &&
                           rx_time_ms - lock.last_ms <= interval_ms_ + interval_ms_ / 2;
    if (!continues)
      lock = {rx_time_ms, rx_time_ms, observable.channel,
              std::round(observable.pseudorange_m / wavelength_m - observable.carrier_phase_cycles)};
    lock.last_ms = rx_time_ms;
    epoch.satellites.push_back({observable, lock.since_ms, observable.carrier_phase_cycles + lock.added_cycles});
  }
  return epoch;
}

}  // namespace vbar::grand::bench
