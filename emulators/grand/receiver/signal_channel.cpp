#include "emulators/grand/receiver/signal_channel.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace vbar::grand::bench {
namespace {

constexpr double kBlock_s = 0.1;
constexpr int kPullInBlocks = 2;
constexpr int kBlocksToLock = 10;     ///< the mean of cos 2x is one over 1 s
constexpr int kBlocksPerPullIn = 30;  ///< without phase lock after this time the loop of frequency is closed again
constexpr int kBlocksToGiveUp = 60;   ///< without phase lock for this time the search begins again
constexpr int kCn0Blocks = 10;
// Noise alone has a power of 20 +- 6.3 in a block and stays below this in 96 of 100; a signal of 28 dB-Hz has 146
// +- 23.
constexpr double kPowerOfNothing = 32.0;
constexpr double kHandoverError_hz = 20.0;
constexpr double kHandoverError_chips = 0.25;
constexpr double kL2HandoverError_hz = 0.5;

double wrapped_to_half_cycle(double cycles) {
  return cycles - std::nearbyint(cycles);
}

}  // namespace

SignalChannel::SignalChannel(const LoopSettings& settings, twins::gnss::SatelliteId satellite,
                             twins::gnss::Signal signal, std::uint64_t seed, std::string_view vehicle)
    : settings_(settings),
      satellite_(satellite),
      signal_(signal),
      wavelength_m_(twins::gnss::wavelength_m(signal)),
      noise_(seed, "grand/receiver/" + std::string(vehicle) + "/" + twins::gnss::name_of(satellite) + "/" +
                       twins::gnss::structure(signal).name),
      loops_(settings, signal) {}

void SignalChannel::begin(double phase_cycles, double rate_hz, double code_m) {
  loops_.start(phase_cycles, rate_hz, code_m);
  state_ = ChannelState::kPullIn;
  blocks_in_state_ = blocks_without_lock_ = 0;
  code_lock_ = parity_known_ = faded_ = false;
  half_cycle_ = 0.0;
  lock_blocks_ = 0;
  smoothing_count_ = 0.0;
  power_sum_ = 0.0;
  power_blocks_ = 0;
  cn0_dbhz_ = 0.0;
}

void SignalChannel::start_from_search(const RfSignal& rf, double oscillator_m, double oscillator_drift_mps) {
  const double chip_m = fsw::gnss::kSpeedOfLight / twins::gnss::structure(signal_).chip_rate_hz;
  const double rate_hz = (rf.carrier_m.rate_at(0.0) + oscillator_drift_mps) / wavelength_m_;
  const double code_m = rf.code_m.at(0.0) + oscillator_m;
  const double phase_cycles = std::floor(code_m / wavelength_m_) + noise_.uniform(0.0, 1.0);
  begin(phase_cycles, rate_hz + noise_.uniform(-kHandoverError_hz, kHandoverError_hz),
        code_m + noise_.uniform(-kHandoverError_chips, kHandoverError_chips) * chip_m);
}

void SignalChannel::start_from(const SignalChannel& first, const RfSignal& rf, double oscillator_m) {
  const double rate_hz = first.rate_hz() * first.wavelength_m_ / wavelength_m_;
  const double code_m = rf.code_m.at(0.0) + oscillator_m;
  const double phase_cycles = std::floor(code_m / wavelength_m_) + noise_.uniform(0.0, 1.0);
  begin(phase_cycles, rate_hz + noise_.uniform(-kL2HandoverError_hz, kL2HandoverError_hz),
        first.loops_.predicted_code_m());
}

void SignalChannel::stop() {
  if (phase_lock()) ++phase_locks_lost_;
  state_ = ChannelState::kIdle;
  code_lock_ = parity_known_ = false;
}

void SignalChannel::advance(const LoopInput& input, double smoothing_s) {
  loops_.advance(input, noise_, snapshots_.data(), motion_m_);
  power_sum_ += loops_.power();
  faded_ = state_ != ChannelState::kPullIn && loops_.power() < kPowerOfNothing;
  if (++power_blocks_ == kCn0Blocks) estimate_cn0();
  ++blocks_in_state_;
  decide();
  if (phase_lock()) {
    ++lock_blocks_;
    smooth(smoothing_s);
  }
}

// Narrow- over wide-band power (van Dierendonck 1996): M = 10 correlations of 1 ms in each of 10 ms. Of their
// wide-band power only the part beside the narrow-band sum is drawn here, chi-square of 18 degrees of freedom each.
void SignalChannel::estimate_cn0() {
  constexpr double kCorrelations = 10.0;
  constexpr double kShort_s = kUpdate_s / kCorrelations;
  constexpr double kUpdates = kCn0Blocks * static_cast<double>(kUpdatesPerBlock);
  constexpr double kDegrees = 2.0 * (kCorrelations - 1.0) * kUpdates;
  const double rest = kDegrees + std::sqrt(2.0 * kDegrees) * noise_();
  const double ratio = ((kCorrelations - 1.0) * power_sum_ - rest) / (kCorrelations * rest);
  cn0_dbhz_ = ratio > 0.0 ? 10.0 * std::log10(ratio / kShort_s) : 0.0;
  cn0_dbhz_ = std::max(cn0_dbhz_, 0.0);
  power_sum_ = 0.0;
  power_blocks_ = 0;
  loops_.set_amplitude_estimate(std::sqrt(2.0 * std::pow(10.0, cn0_dbhz_ / 10.0) * kUpdate_s));
  code_lock_ = cn0_dbhz_ >= settings_.code_lock_threshold_dbhz;
  if (!code_lock_) stop();
}

void SignalChannel::decide() {
  switch (state_) {
    case ChannelState::kIdle:
    case ChannelState::kSearch:
      return;
    case ChannelState::kPullIn:
      if (blocks_in_state_ < kPullInBlocks) return;
      loops_.set_mode(LoopMode::kPhase);
      state_ = ChannelState::kFrequencyLock;
      blocks_in_state_ = 0;
      return;
    case ChannelState::kFrequencyLock:
      ++blocks_without_lock_;
      if (blocks_in_state_ >= kBlocksToLock && loops_.cos_2x() > settings_.phase_lock_threshold) {
        begin_count();
      } else if (blocks_without_lock_ >= kBlocksToGiveUp) {
        stop();
      } else if (blocks_in_state_ >= kBlocksPerPullIn) {
        loops_.set_mode(LoopMode::kPullIn);
        state_ = ChannelState::kPullIn;
        blocks_in_state_ = 0;
      }
      return;
    case ChannelState::kPhaseLock:
      if (faded_ || loops_.cos_2x() < settings_.phase_lock_threshold) lose_phase_lock();
      return;
  }
}

void SignalChannel::begin_count() {
  state_ = ChannelState::kPhaseLock;
  blocks_in_state_ = blocks_without_lock_ = 0;
  lock_blocks_ = 0;
  smoothing_count_ = 0.0;
  const LoopSnapshot& now = loops_.last();
  count_origin_cycles_ = std::nearbyint(now.code_m / wavelength_m_ - now.phase_cycles);
}

void SignalChannel::lose_phase_lock() {
  ++phase_locks_lost_;
  parity_known_ = false;
  half_cycle_ = 0.0;
  lock_blocks_ = 0;
  blocks_without_lock_ = 0;
  loops_.set_mode(LoopMode::kPullIn);
  state_ = ChannelState::kPullIn;
  blocks_in_state_ = 0;
}

// P^ = P/M + (1 - 1/M)(P^ + dL), as the mean of code minus carrier: M = min(k, tau/dt).
void SignalChannel::smooth(double smoothing_s) {
  const LoopSnapshot& now = loops_.last();
  const double difference_m = now.code_m - (now.phase_cycles + count_origin_cycles_) * wavelength_m_;
  smoothing_count_ = std::min(smoothing_count_ + 1.0, std::max(1.0, smoothing_s / kBlock_s));
  smoothed_minus_carrier_m_ += (difference_m - smoothed_minus_carrier_m_) / smoothing_count_;
}

bool SignalChannel::half_cycle_off() const {
  const double error = wrapped_to_half_cycle(loops_.phase_error_cycles());
  return std::abs(error) > 0.25;
}

bool SignalChannel::resolve_half_cycle() {
  const double half = half_cycle_off() ? 0.5 : 0.0;
  const bool consistent = !parity_known_ || half == half_cycle_;
  parity_known_ = true;
  half_cycle_ = half;
  if (!consistent) begin_count();
  return consistent;
}

Measurement SignalChannel::measurement(std::size_t k) const {
  Measurement m;
  m.state = state_;
  m.code_lock = code_lock_ && !faded_;
  m.phase_lock = phase_lock();
  m.parity_known = parity_known_;
  m.loop = snapshots_[k];
  m.loop.phase_cycles += count_origin_cycles_;
  m.smoothed_code_m = m.phase_lock && smoothing_count_ > 1.0
                          ? smoothed_minus_carrier_m_ + m.loop.phase_cycles * wavelength_m_
                          : m.loop.code_m;
  m.loop.phase_cycles += half_cycle_;
  m.cn0_dbhz = cn0_dbhz_;
  m.lock_time_s = lock_time_s();
  return m;
}

}  // namespace vbar::grand::bench
