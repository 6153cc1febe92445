#include "emulators/grand/receiver/measurement_engine.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "host_sim/twins/gnss/system_time.h"
#include "host_sim/twins/gnss/tracking.h"

namespace vbar::grand::bench {
namespace {

using fsw::gnss::kSpeedOfLight;
using twins::gnss::Signal;
using twins::gnss::System;
namespace oem = twins::gnss::oem;

constexpr std::int64_t kUpdate_ns = 10'000'000;
constexpr std::int64_t kUpdatesPerSecond = 100;
constexpr double kBlock_s = 0.1;
constexpr double kBitSynchronisation_s = 1.0;
constexpr int kSecondsOfVelocity = 60;      ///< a point solution of this age still predicts Doppler
constexpr double kAssumedNearer_m = 4.1e6;  ///< than its orbit's radius is a satellite, before a position is known
constexpr double kMinCn0_dbhz = 15.0;

std::vector<Signal> signals_of(System system) {
  switch (system) {
    case System::kGps:
      return {Signal::kGpsL1, Signal::kGpsL2};
    case System::kGalileo:
      return {Signal::kGalileoE1};
    case System::kBeidou:
      return {Signal::kBeidouB1I};
  }
  return {};
}

std::size_t index_of(Signal signal) {
  return static_cast<std::size_t>(signal);
}

double amplitude(double cn0_dbhz) {
  return std::sqrt(2.0 * std::pow(10.0, cn0_dbhz / 10.0) * kUpdate_s);
}

}  // namespace

MeasurementEngine::MeasurementEngine(const ReceiverSettings& settings,
                                     std::shared_ptr<const twins::gnss::Constellation> constellation,
                                     std::uint64_t seed, std::string_view vehicle)
    : settings_(settings),
      constellation_(std::move(constellation)),
      clock_(settings.clock, settings.steering_bandwidth_hz, seed, vehicle),
      search_(settings.search, constellation_, seed, vehicle),
      smoothing_s_(settings.loops.smoothing_s) {
  for (std::size_t k = 0; k < constellation_->size(); ++k) {
    const twins::gnss::SatelliteId id = constellation_->id(k);
    const std::vector<Signal> signals = signals_of(id.system);
    satellites_.push_back({channels_.size(), signals.size() > 1});
    receptions_.emplace_back(id);
    for (const Signal signal : signals) {
      channels_.emplace_back(settings.loops, id, signal, seed, vehicle);
      satellite_of_channel_.push_back(k);
    }
  }
  bit_synchronised_.resize(channels_.size());
  rf_.resize(channels_.size());
  rf_first_.resize(satellites_.size());
  tracked_.resize(satellites_.size());
  epoch_.ranges.reserve(channels_.size());
  engine::RandomStream stream(seed, "grand/receiver/" + std::string(vehicle) + "/biases");
  for (SignalBias& bias : biases_) {
    bias.code_m = stream.normal() * settings.loops.code_bias_sigma_m;
    bias.carrier_fraction_cycles = stream.uniform();
  }
}

void MeasurementEngine::restart(StoredData stored) {
  stored_ = stored;
  restarted_ = true;
  for (SignalChannel& channel : channels_) channel.stop();
  for (MessageReception& reception : receptions_) reception.forget();
  std::fill(bit_synchronised_.begin(), bit_synchronised_.end(), false);
  clock_.restart();
  clock_.enable_steering(true);
  search_.restart();
  approximate_position_.reset();
  solution_.reset();
  smoothing_s_ = settings_.loops.smoothing_s;
  elevation_cutoff_ = -1.5707963267948966;
  corrections_known_ = stored != StoredData::kNothing;
  new_sets_.clear();
  new_corrections_ = false;
  last_epoch_ = -1;
}

void MeasurementEngine::begin_after_restart(fsw::GpsTime time) {
  restarted_ = false;
  if (stored_ != StoredData::kEphemerides) return;
  constexpr std::int64_t kFrame_ns = 30 * fsw::kNanosecondsPerSecond;
  const fsw::GpsTime frame{(time.ns / kFrame_ns - 1) * kFrame_ns};
  for (std::size_t k = 0; k < receptions_.size(); ++k)
    receptions_[k].keep(constellation_->broadcast_set(k, frame), frame);
}

// Both lists are ordered by satellite and signal.
void MeasurementEngine::match(const RfBlock& block) {
  std::fill(rf_.begin(), rf_.end(), nullptr);
  std::size_t channel = 0;
  for (const RfSignal& signal : block.signals) {
    const auto before = [&signal](const SignalChannel& c) {
      return c.satellite() != signal.satellite ? c.satellite() < signal.satellite : c.signal() < signal.signal;
    };
    while (channel < channels_.size() && before(channels_[channel])) ++channel;
    if (channel == channels_.size()) break;
    const SignalChannel& here = channels_[channel];
    if (here.satellite() == signal.satellite && here.signal() == signal.signal) rf_[channel] = &signal;
  }
  for (std::size_t k = 0; k < satellites_.size(); ++k) {
    rf_first_[k] = rf_[satellites_[k].first_channel];
    tracked_[k] = channels_[satellites_[k].first_channel].active();
  }
}

void MeasurementEngine::stop_all() {
  for (SignalChannel& channel : channels_)
    if (channel.active()) channel.stop();
  std::fill(bit_synchronised_.begin(), bit_synchronised_.end(), false);
}

void MeasurementEngine::advance(const RfBlock& block, double cn0_offset_db, const Listener& listener) {
  if (restarted_) begin_after_restart(block.begin);
  if (block.snapped || (expected_begin_ && *expected_begin_ != block.begin)) stop_all();
  expected_begin_ = block.begin + RfBlock::kLength;
  clock_.advance(block.begin);
  setting_m_ = clock_.setting_m();
  for (std::size_t k = 0; k < twins::gnss::kSignals; ++k)
    setting_cycles_[k] = clock_.setting_cycles(twins::gnss::kSignalStructures[k].frequency_hz);
  match(block);
  search(block.begin, cn0_offset_db);
  start_second_signals(cn0_offset_db);
  const std::uint32_t wanted = wanted_updates(listener);
  advance_channels(cn0_offset_db, wanted);
  receive_messages(*expected_begin_);
  for (std::size_t k = 0; k < kUpdatesPerBlock; ++k) {
    if (((wanted >> k) & 1U) == 0) continue;
    measure(k, clock_.epoch(k).number % kUpdatesPerSecond == 0);
    listener.on_epoch(epoch_);
  }
}

std::uint32_t MeasurementEngine::wanted_updates(const Listener& listener) {
  std::uint32_t wanted = 0;
  for (std::size_t k = 0; k < kUpdatesPerBlock; ++k) {
    const std::int64_t number = clock_.epoch(k).number;
    // Where the clock has been set back, an epoch may come twice; it counts once.
    if (number == last_epoch_) continue;
    last_epoch_ = number;
    if (number % kUpdatesPerSecond == 0 || listener.wants(number)) wanted |= 1U << k;
  }
  return wanted;
}

void MeasurementEngine::search(fsw::GpsTime time, double cn0_offset_db) {
  SearchKnowledge knowledge;
  knowledge.elevation_cutoff = elevation_cutoff_;
  const bool has_almanac = stored_ != StoredData::kNothing && clock_.status() >= TimeStatus::kApproximate;
  if (solution_ && seconds_since_solution_ < kSecondsOfVelocity) {
    knowledge.position_ecef = solution_->position_ecef;
    knowledge.velocity = true;
  } else if (has_almanac && approximate_position_) {
    knowledge.position_ecef = approximate_position_;
  }
  search_.advance(time, rf_first_, clock_.oscillator_rate_mps(), cn0_offset_db, tracked_, knowledge, found_);
  for (const std::size_t satellite : found_) {
    const std::size_t channel = satellites_[satellite].first_channel;
    channels_[channel].start_from_search(*rf_[channel], clock_.oscillator_m().front(), clock_.oscillator_rate_mps());
  }
}

void MeasurementEngine::start_second_signals(double cn0_offset_db) {
  for (const Satellite& satellite : satellites_) {
    if (!satellite.has_second) continue;
    const SignalChannel& first = channels_[satellite.first_channel];
    const std::size_t second = satellite.first_channel + 1;
    if (channels_[second].active() && !first.active()) channels_[second].stop();
    const bool ready = first.phase_lock() && bit_synchronised_[satellite.first_channel];
    if (channels_[second].active() || !ready || rf_[second] == nullptr ||
        rf_[second]->cn0_dbhz + cn0_offset_db < settings_.search.threshold_dbhz)
      continue;
    channels_[second].start_from(first, *rf_[second], clock_.oscillator_m().front());
  }
}

void MeasurementEngine::advance_channels(double cn0_offset_db, std::uint32_t snapshots) {
  for (std::size_t k = 0; k < channels_.size(); ++k) {
    SignalChannel& channel = channels_[k];
    if (!channel.active()) {
      bit_synchronised_[k] = false;
      continue;
    }
    const bool second = channel.signal() == Signal::kGpsL2;
    LoopInput input;
    input.signal = rf_[k];
    input.oscillator_m = &clock_.oscillator_m();
    input.amplitude = rf_[k] != nullptr ? amplitude(rf_[k]->cn0_dbhz + cn0_offset_db) : 0.0;
    input.aiding_m = second ? &channels_[k - 1].motion_m() : nullptr;
    input.snapshots = snapshots;
    channel.advance(input, smoothing_s_);
    if (!channel.active() && !second)
      search_.lost(satellite_of_channel_[k], channel.rate_hz() * twins::gnss::wavelength_m(channel.signal()));
    if (channel.phase_lock() && channel.lock_time_s() >= kBitSynchronisation_s) bit_synchronised_[k] = true;
    if (!channel.active()) bit_synchronised_[k] = false;
  }
}

void MeasurementEngine::receive_messages(fsw::GpsTime end) {
  new_sets_.clear();
  new_corrections_ = false;
  for (std::size_t k = 0; k < satellites_.size(); ++k) {
    const std::size_t first = satellites_[k].first_channel;
    SignalChannel& channel = channels_[first];
    const bool locked = channel.phase_lock() && channel.lock_time_s() >= kBitSynchronisation_s && rf_[first] != nullptr;
    const double travel_s = locked ? rf_[first]->code_m.at(kBlock_s) / kSpeedOfLight : 0.0;
    const MessageReception::News news =
        receptions_[k].receive(end - fsw::nearest_duration(travel_s), locked, *constellation_, k);
    if (!locked) continue;
    if (news.sign_of_bits && !channel.resolve_half_cycle()) receptions_[k].restart();
    if (satellites_[k].has_second && channel.parity_known()) {
      SignalChannel& second = channels_[first + 1];
      const bool due = news.sign_of_bits || !second.parity_known();
      if (due && second.phase_lock() && second.lock_time_s() >= kBitSynchronisation_s) second.resolve_half_cycle();
    }
    if (news.ephemeris) new_sets_.push_back(k);
    if (news.corrections) corrections_known_ = new_corrections_ = true;
    if ((news.time_of_week || news.ephemeris) && receptions_[k].set() && !clock_.is_set()) {
      const double sqrt_a = receptions_[k].set()->ephemeris.sqrt_a;
      clock_.set_coarse(travel_s, (sqrt_a * sqrt_a - kAssumedNearer_m) / kSpeedOfLight);
      last_epoch_ = -1;
    }
  }
}

void MeasurementEngine::add_record(std::size_t index, std::size_t k, double after_update_s) {
  const SignalChannel& channel = channels_[index];
  const Measurement m = channel.measurement(k);
  const bool second = channel.signal() == Signal::kGpsL2;
  const bool synchronised = second ? bit_synchronised_[index - 1] : bit_synchronised_[index];
  if (!m.code_lock || !synchronised || !clock_.is_set()) return;
  const double wavelength = twins::gnss::wavelength_m(channel.signal());
  const SignalBias& bias = biases_[index_of(channel.signal())];
  const double motion_cycles = (m.loop.rate_hz + m.loop.acceleration_hz_per_s * after_update_s / 2.0) * after_update_s;

  twins::gnss::TrackingSettings loops;
  loops.carrier_loop_bandwidth_hz = settings_.loops.carrier_bandwidth_hz;
  loops.code_loop_bandwidth_hz = second ? settings_.loops.code_bandwidth_l2_hz : settings_.loops.code_bandwidth_hz;
  loops.integration_s = kUpdate_s;
  const double cn0_dbhz = std::max(m.cn0_dbhz, kMinCn0_dbhz);

  oem::RangeRecord record;
  record.satellite = channel.satellite();
  record.signal = channel.signal();
  record.channel = static_cast<int>(satellite_of_channel_[index] % 32);
  record.pseudorange_m = m.smoothed_code_m + motion_cycles * wavelength + setting_m_ + bias.code_m;
  record.carrier_phase_cycles =
      m.loop.phase_cycles + motion_cycles + setting_cycles_[index_of(channel.signal())] + bias.carrier_fraction_cycles;
  record.doppler_hz = -(m.loop.rate_hz + m.loop.acceleration_hz_per_s * after_update_s);
  record.pseudorange_sigma_m = twins::gnss::code_noise_m(loops, channel.signal(), cn0_dbhz);
  record.carrier_sigma_cycles = twins::gnss::carrier_noise_m(loops, channel.signal(), cn0_dbhz) / wavelength;
  record.cn0_dbhz = m.cn0_dbhz;
  record.lock_time_s = m.lock_time_s;
  record.tracking = {static_cast<unsigned>(m.state), m.phase_lock, m.parity_known, m.code_lock};
  epoch_.ranges.push_back(record);
  epoch_satellites_.push_back(satellite_of_channel_[index]);
}

void MeasurementEngine::measure(std::size_t k, bool whole_second) {
  const SteeredClock::Epoch at = clock_.epoch(k);
  epoch_.number = at.number;
  epoch_.reading = fsw::GpsTime{at.number * kUpdate_ns};
  epoch_.after_begin_s = static_cast<double>(k) * kUpdate_s + at.after_update_s;
  epoch_.ranges.clear();
  epoch_satellites_.clear();
  for (std::size_t c = 0; c < channels_.size(); ++c)
    if (channels_[c].active()) add_record(c, k, at.after_update_s);
  epoch_.satellites_tracked = 0;
  for (std::size_t r = 0; r < epoch_.ranges.size(); ++r) {
    const auto same = [this, r](std::size_t other) { return epoch_satellites_[other] == epoch_satellites_[r]; };
    const bool with_before = r > 0 && same(r - 1);
    const bool with_next = r + 1 < epoch_.ranges.size() && same(r + 1);
    epoch_.ranges[r].grouped = with_before || with_next;
    if (!with_before) ++epoch_.satellites_tracked;
  }
  solve(whole_second);
  if (whole_second) apply_elevation_cutoff();
}

void MeasurementEngine::solve(bool whole_second) {
  solution_input_.clear();
  for (std::size_t r = 0; r < epoch_.ranges.size(); ++r) {
    const oem::RangeRecord& record = epoch_.ranges[r];
    const auto& set = receptions_[epoch_satellites_[r]].set();
    if (record.signal != Signal::kGpsL1 || !record.tracking.phase_lock || !set) continue;
    solution_input_.push_back({&set->ephemeris, record.pseudorange_m,
                               -record.doppler_hz * twins::gnss::wavelength_m(record.signal),
                               record.pseudorange_sigma_m});
  }
  const std::optional<fsw::Vector3> start =
      solution_ ? std::optional<fsw::Vector3>(solution_->position_ecef) : approximate_position_;
  epoch_.solution = solve_own(solution_input_, epoch_.reading, start);
  if (epoch_.solution) solution_ = epoch_.solution;
  if (!whole_second) return;
  if (epoch_.solution) {
    seconds_since_solution_ = 0;
    clock_.take_solution(epoch_.solution->clock_offset_s, epoch_.solution->clock_drift);
  } else {
    ++seconds_since_solution_;
    clock_.take_no_solution();
  }
}

void MeasurementEngine::apply_elevation_cutoff() {
  constexpr double kNone = -1.57;
  if (!epoch_.solution || elevation_cutoff_ < kNone) return;
  const fsw::Vector3 up = epoch_.solution->position_ecef.normalized();
  for (std::size_t k = 0; k < satellites_.size(); ++k) {
    SignalChannel& channel = channels_[satellites_[k].first_channel];
    if (!channel.active() || !receptions_[k].set()) continue;
    const fsw::Vector3 satellite =
        twins::gnss::satellite_state(receptions_[k].set()->ephemeris, epoch_.reading).position_ecef;
    const double sin_elevation = (satellite - epoch_.solution->position_ecef).normalized().dot(up);
    if (sin_elevation < std::sin(elevation_cutoff_)) channel.stop();
  }
}

void MeasurementEngine::report(ReceiverReport& report) const {
  report.time_status = static_cast<int>(clock_.status());
  report.clock_offset_s = clock_.true_offset_s();
  report.signals_searched = search_.busy_engines();
  for (const SignalChannel& channel : channels_) {
    report.signals_tracked += channel.code_lock() ? 1 : 0;
    report.signals_phase_locked += channel.phase_lock() ? 1 : 0;
    report.phase_locks_lost += channel.phase_locks_lost();
  }
  for (const MessageReception& reception : receptions_) report.ephemerides += reception.set() ? 1 : 0;
}

}  // namespace vbar::grand::bench
