#include "emulators/grand/samples/gnss_sdr_measurements.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "host_sim/twins/gnss/system_time.h"
#include "host_sim/twins/gnss/tracking.h"

namespace vbar::grand::bench {
namespace {

namespace oem = twins::gnss::oem;
using twins::gnss::SatelliteId;
using twins::gnss::Signal;
using twins::gnss::System;
using twins::gnss::TransmittedSubframe;

constexpr int kInterval_ms = 100;
constexpr std::int64_t kEpoch_ns = 10'000'000;
constexpr std::int64_t kSubframe_s = 6;
constexpr std::int64_t kSubframesPerFrame = 5;

// The instant with this time of week that is nearest to `now`.
fsw::GpsTime nearest(std::int64_t ms_of_week, fsw::GpsTime now) {
  constexpr std::int64_t kWeek_ns = twins::gnss::kSecondsPerWeek * fsw::kNanosecondsPerSecond;
  const std::int64_t week_begin_ns = now.ns / kWeek_ns * kWeek_ns;
  std::int64_t ns = week_begin_ns + ms_of_week * 1'000'000;
  if (ns - now.ns > kWeek_ns / 2) ns -= kWeek_ns;
  if (now.ns - ns > kWeek_ns / 2) ns += kWeek_ns;
  return {ns};
}

// Data bits of each word without the inversion by the last bit of the word before; receivers report either.
bool same_data(const TransmittedSubframe& received, const TransmittedSubframe& sent) {
  constexpr std::uint32_t kData = 0x3FFFFFC0;
  bool inverted = false;
  for (std::size_t k = 0; k < sent.size(); ++k) {
    const std::uint32_t difference = (received[k] ^ sent[k]) & kData;
    if (difference != 0 && !(inverted && difference == kData)) return false;
    inverted = (sent[k] & 1U) != 0;
  }
  return true;
}

}  // namespace

GnssSdrMeasurements::GnssSdrMeasurements(const GnssSdrSettings& settings,
                                         std::shared_ptr<const twins::gnss::Constellation> constellation,
                                         std::uint64_t seed, const std::string& vehicle)
    : settings_(settings),
      constellation_(std::move(constellation)),
      baseband_(settings.samples, constellation_, seed, vehicle),
      messages_(constellation_) {
  for (std::size_t k = 0; k < constellation_->size(); ++k) {
    const SatelliteId id = constellation_->id(k);
    receptions_.push_back({MessageReception(id)});
    if (id.system == System::kGps && id.prn >= 1 && id.prn <= kCaCodes)
      index_of_prn_[static_cast<std::size_t>(id.prn)] = k;
  }
}

// gnss-sdr stores nothing: every start is a cold one.
void GnssSdrMeasurements::restart(StoredData /*stored*/) {
  process_.reset();
  epochs_.reset();
  for (Reception& reception : receptions_) {
    reception.message.forget();
    reception.frames = {-1, -1, -1};
  }
  status_ = oem::TimeStatus::kUnknown;
  reading_ = {};
  solution_.reset();
  tracked_ = 0;
  corrections_known_ = new_corrections_ = false;
  new_sets_.clear();
}

void GnssSdrMeasurements::send(const RfBlock& block, double cn0_offset_db) {
  if (!process_) {
    process_.emplace(settings_.program, settings_.directory,
                     GnssSdrConfiguration{.rate_hz = settings_.samples.rate_hz,
                                          .channels = settings_.channels,
                                          .observable_interval_ms = kInterval_ms});
    epochs_.emplace(settings_.channels, kInterval_ms);
  }
  block_ = block;
  for (RfSignal& signal : block_.signals) signal.cn0_dbhz += cn0_offset_db;
  process_->write(baseband_.samples(block_));
}

void GnssSdrMeasurements::advance(const RfBlock& block, double cn0_offset_db, const Listener& listener) {
  new_sets_.clear();
  new_corrections_ = false;
  send(block, cn0_offset_db);
  while (const auto datagram = process_->navigation()) {
    const std::optional<ReceivedSubframe> subframe = read_subframe(*datagram);
    if (subframe) take_subframe(*subframe, block.begin);
  }
  while (const auto datagram = process_->observables()) {
    const auto observables = read_observables(*datagram);
    if (observables)
      for (const Observable& observable : *observables) epochs_->take(observable);
  }
  while (const std::optional<ObservableEpoch> epoch = epochs_->next()) measure(*epoch, block.begin, listener);
}

void GnssSdrMeasurements::take_subframe(const ReceivedSubframe& received, fsw::GpsTime now) {
  const std::optional<std::size_t> index = index_of_prn_[static_cast<std::size_t>(received.prn)];
  if (!index) return;
  // The handover word, first in each word 2: time of week at which the next subframe begins.
  const auto next = static_cast<std::int64_t>(received.words[1] >> 13U & 0x1FFFFU);
  if (next >= twins::gnss::kSecondsPerWeek / kSubframe_s) return;
  const fsw::GpsTime begin = nearest(next * kSubframe_s * 1000, now) - fsw::duration_of_seconds(kSubframe_s);
  if (begin.ns < 0 || begin > now || now - begin > fsw::duration_of_seconds(10 * kSubframe_s)) return;
  const std::int64_t number = begin.ns / (kSubframe_s * fsw::kNanosecondsPerSecond);
  if (!same_data(received.words, messages_.subframe(constellation_->id(*index), number))) return;
  const auto in_frame = static_cast<std::size_t>(number % kSubframesPerFrame);
  if (in_frame < 3) {
    receptions_[*index].frames[in_frame] = number / kSubframesPerFrame;
    complete_set(*index);
  } else if (in_frame == 3) {
    corrections_known_ = new_corrections_ = true;
  }
}

void GnssSdrMeasurements::complete_set(std::size_t index) {
  Reception& reception = receptions_[index];
  const auto begin_of = [](std::int64_t frame) { return fsw::GpsTime{} + fsw::duration_of_seconds(30 * frame); };
  const auto toe_of = [&](std::int64_t frame) {
    return constellation_->broadcast_set(index, begin_of(frame)).ephemeris.toe;
  };
  if (std::ranges::any_of(reception.frames, [](std::int64_t frame) { return frame < 0; })) return;
  const fsw::GpsTime toe = toe_of(reception.frames[0]);
  if (toe_of(reception.frames[1]) != toe || toe_of(reception.frames[2]) != toe) return;
  if (reception.message.set() && reception.message.set()->ephemeris.toe == toe) return;
  const fsw::GpsTime begin = begin_of(reception.frames[0]);
  reception.message.keep(constellation_->broadcast_set(index, begin), begin);
  new_sets_.push_back(index);
}

oem::RangeRecord GnssSdrMeasurements::record_of(const ObservableEpoch::Satellite& satellite,
                                                std::int64_t rx_time_ms) const {
  const Observable& observable = satellite.observable;
  oem::RangeRecord record;
  record.satellite = {System::kGps, observable.prn};
  record.signal = Signal::kGpsL1;
  record.channel = observable.channel;
  record.pseudorange_m = observable.pseudorange_m;
  record.carrier_phase_cycles = satellite.carrier_phase_cycles;
  record.doppler_hz = observable.doppler_hz;
  record.cn0_dbhz = observable.cn0_dbhz;
  record.pseudorange_sigma_m = code_noise_m(kGnssSdrTracking, record.signal, record.cn0_dbhz);
  record.carrier_sigma_cycles =
      carrier_noise_m(kGnssSdrTracking, record.signal, record.cn0_dbhz) / wavelength_m(record.signal);
  record.lock_time_s = static_cast<double>(rx_time_ms - satellite.locked_ms) / 1e3;
  return record;
}

std::optional<OwnSolution> GnssSdrMeasurements::solve(const EpochData& epoch) {
  std::vector<SolutionInput> input;
  for (const oem::RangeRecord& record : epoch.ranges) {
    const std::optional<std::size_t> index = index_of_prn_[static_cast<std::size_t>(record.satellite.prn)];
    if (!index || !receptions_[*index].message.set()) continue;
    input.push_back({&receptions_[*index].message.set()->ephemeris, record.pseudorange_m,
                     -record.doppler_hz * wavelength_m(record.signal), record.pseudorange_sigma_m});
  }
  return solve_own(input, epoch.reading,
                   solution_ ? std::optional<fsw::Vector3>(solution_->position_ecef) : std::nullopt);
}

void GnssSdrMeasurements::measure(const ObservableEpoch& observables, fsw::GpsTime now, const Listener& listener) {
  reading_ = nearest(observables.rx_time_ms, now);
  tracked_ = static_cast<int>(observables.satellites.size());
  if (tracked_ > 0 && status_ < oem::TimeStatus::kCoarse) status_ = oem::TimeStatus::kCoarse;
  EpochData epoch;
  epoch.number = reading_.ns / kEpoch_ns;
  const bool whole_second = reading_.ns % fsw::kNanosecondsPerSecond == 0;
  if (!whole_second && !listener.wants(epoch.number)) return;
  epoch.reading = reading_;
  for (const ObservableEpoch::Satellite& satellite : observables.satellites)
    epoch.ranges.push_back(record_of(satellite, observables.rx_time_ms));
  epoch.satellites_tracked = tracked_;
  epoch.solution = solve(epoch);
  solution_ = epoch.solution;
  if (solution_) status_ = oem::TimeStatus::kFine;
  listener.on_epoch(epoch);
}

double GnssSdrMeasurements::seconds_behind() {
  if (!process_) return 0.0;
  process_->flush();
  return process_->seconds_behind();
}

void GnssSdrMeasurements::report(ReceiverReport& report) const {
  report.time_status = static_cast<int>(status_);
  report.signals_tracked = report.signals_phase_locked = tracked_;
  for (const Reception& reception : receptions_) report.ephemerides += reception.message.set() ? 1 : 0;
}

}  // namespace vbar::grand::bench
