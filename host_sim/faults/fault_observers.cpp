#include "host_sim/faults/fault_observers.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <span>

#include "fsw/packets/messages.h"

namespace vbar::faults {

using fsw::GpsTime;

void AidWatch::change(GpsTime time, std::int32_t aiding) {
  if (!changes_.empty() && changes_.back().time == time) {
    changes_.back().aiding = aiding;
  } else {
    changes_.push_back({time, aiding});
  }
}

void AidWatch::take(GpsTime time, const fsw::packets::PacketView& packet) {
  const std::int32_t present = changes_.empty() ? 0 : changes_.back().aiding;
  if (const auto health = fsw::packets::decode<telemetry_health>(packet); health.ok()) {
    // The computer began again: its events of this step, before the health packet or after it, still hold.
    if (health.value().step == 0 && has_stepped_) change(time, time == reported_at_ ? present & reported_ : 0);
    has_stepped_ = true;
    return;
  }
  const auto event = fsw::packets::decode<telemetry_event>(packet);
  if (!event.ok() || event.value().event != telemetry_event::kEventAid) return;
  const std::int32_t source = event.value().device;
  if (time != reported_at_) reported_ = 0;
  reported_at_ = time;
  reported_ |= source;
  const bool is_aiding = event.value().after == telemetry_event::kAidAiding;
  change(time, is_aiding ? present | source : present & ~source);
}

std::int32_t AidWatch::before(GpsTime time) const {
  const auto later = std::ranges::lower_bound(changes_, time, {}, &Change::time);
  return later == changes_.begin() ? 0 : std::prev(later)->aiding;
}

std::optional<GpsTime> AidWatch::first_with(std::int32_t sources, GpsTime from) const {
  auto change = std::ranges::upper_bound(changes_, from, {}, &Change::time);
  const std::int32_t present = change == changes_.begin() ? 0 : std::prev(change)->aiding;
  if ((present & sources) == sources) return from;
  change =
      std::find_if(change, changes_.end(), [sources](const Change& one) { return (one.aiding & sources) == sources; });
  return change == changes_.end() ? std::nullopt : std::optional(change->time);
}

namespace {

using fsw::gnss::Observation;
using fsw::gnss::ObservationEpoch;

/// Lock times are sent in steps of a fraction of a second.
constexpr double kLockTolerance_s = 1.0;
/// Longest gap over which observations are continued.
constexpr double kLongestGap_s = 15.0;
constexpr std::size_t kPastSamples = 5;
constexpr double kLongestPast_s = 70.0;
/// Cycles: the continuation amplifies the noise of single phases 16-fold, which reaches 0.6 at low elevations.
constexpr double kMinSlip = 0.75;

/// The lower one of an even number; `values` must not be empty.
double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

std::vector<std::uint8_t> bytes_in(const fsw::packets::PacketView& packet) {
  const auto bytes_of = [](const auto& message) {
    const auto count = std::clamp<std::ptrdiff_t>(message.count, 0, std::ssize(message.data));
    return std::vector<std::uint8_t>(std::begin(message.data), std::begin(message.data) + count);
  };
  if (const auto own = fsw::packets::decode<gnss_bytes>(packet); own.ok()) return bytes_of(own.value());
  const auto other = fsw::packets::decode<crosslink_gnss_bytes>(packet);
  return other.ok() ? bytes_of(other.value()) : std::vector<std::uint8_t>();
}

/// The polynomial through the samples (Lagrange) at `time`.
template <class Sample>
double continued(std::span<const Sample> samples, fsw::GpsTime time) {
  double value = 0.0;
  for (const Sample& one : samples) {
    double weight = 1.0;
    for (const Sample& other : samples)
      if (&other != &one) weight *= fsw::seconds(time - other.time) / fsw::seconds(one.time - other.time);
    value += weight * one.phase_m;
  }
  return value;
}

}  // namespace

std::vector<ReceiverEpoch> ReceiverObserver::take(const fsw::packets::PacketView& packet) {
  std::vector<ReceiverEpoch> epochs;
  for (const std::uint8_t byte : bytes_in(packet)) {
    if (decoder_.push(byte) != fsw::gnss::ReceiverUpdate::kObservations) continue;
    // One that comes out of order shows nothing.
    if (decoder_.observations().receiver_time > last_) epochs.push_back(compare(decoder_.observations()));
  }
  return epochs;
}

ReceiverEpoch ReceiverObserver::compare(const ObservationEpoch& epoch) {
  ReceiverEpoch found;
  found.time = epoch.receiver_time;
  found.carriers = epoch.count;
  last_ = epoch.receiver_time;
  std::vector<double> jumps_s;
  for (const Observation& now : std::span(epoch.observations).first(epoch.count)) {
    const auto [place, is_new] = carriers_.try_emplace({now.satellite, now.signal});
    Carrier& carrier = place->second;
    const double lambda = fsw::gnss::wavelength(now.signal);
    const double elapsed_s = is_new ? 0.0 : fsw::seconds(epoch.receiver_time - carrier.time);
    const bool is_locked = !is_new && now.lock_time_s > carrier.last.lock_time_s + elapsed_s - kLockTolerance_s;
    const bool is_continued = !is_new && elapsed_s < kLongestGap_s;
    if (!is_new) ++found.known;
    if (!is_new && !is_locked) ++found.restarted;
    if (is_continued) {
      const double rate_mps = -0.5 * lambda * (now.doppler_hz + carrier.last.doppler_hz);
      jumps_s.push_back((now.pseudorange_m - carrier.last.pseudorange_m - rate_mps * elapsed_s) /
                        fsw::gnss::kSpeedOfLight);
    }
    if (!is_locked) carrier.past.clear();
    if (carrier.past.size() > kPastSamples) carrier.past.erase(carrier.past.begin());
    const Sample sample{epoch.receiver_time, lambda * now.carrier_phase_cycles};
    const bool is_compared = is_continued && carrier.past.size() == kPastSamples &&
                             fsw::seconds(sample.time - carrier.past.front().time) < kLongestPast_s;
    carrier.difference_m.reset();
    if (is_compared)
      carrier.difference_m = sample.phase_m - continued(std::span<const Sample>(carrier.past), sample.time);
    carrier.past.push_back(sample);
    carrier.time = epoch.receiver_time;
    carrier.last = now;
  }
  if (!jumps_s.empty()) found.clock_jump_s = median(std::move(jumps_s));
  find_slips(found);
  return found;
}

void ReceiverObserver::find_slips(ReceiverEpoch& found) {
  std::vector<Carrier*> compared;
  std::vector<double> differences_m;
  for (auto& [key, carrier] : carriers_) {
    if (carrier.time != found.time || !carrier.difference_m) continue;
    compared.push_back(&carrier);
    differences_m.push_back(*carrier.difference_m);
  }
  if (compared.empty()) return;
  const double common_m = median(std::move(differences_m));
  for (Carrier* const carrier : compared) {
    const double cycles = (*carrier->difference_m - common_m) / fsw::gnss::wavelength(carrier->last.signal);
    if (std::abs(cycles) < kMinSlip) continue;
    found.slips.push_back({carrier->last.satellite, cycles});
    carrier->past.erase(carrier->past.begin(), carrier->past.end() - 1);  // the next differences would contain it again
  }
}

}  // namespace vbar::faults
