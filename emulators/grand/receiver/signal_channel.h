#pragma once
// Channel of the receiver: the loops of one signal, the conclusions from their correlations (lock, C/N0), the count of
// the carrier and the smoothed pseudorange.

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "emulators/grand/receiver/tracking_loops.h"

namespace vbar::grand::bench {

/// State of a channel as numbered in the tracking status word of RANGE.
enum class ChannelState : std::uint8_t { kIdle = 0, kSearch = 1, kPullIn = 2, kPhaseLock = 4, kFrequencyLock = 7 };

/// Measurement of a channel at one update.
struct Measurement {
  ChannelState state = ChannelState::kIdle;
  bool code_lock = false;
  bool phase_lock = false;
  bool parity_known = false;
  LoopSnapshot loop;  ///< phase: with the carrier's count and, once known, the right half cycle
  double smoothed_code_m = 0.0;
  double cn0_dbhz = 0.0;
  double lock_time_s = 0.0;
};

class SignalChannel {
 public:
  SignalChannel(const LoopSettings& settings, twins::gnss::SatelliteId satellite, twins::gnss::Signal signal,
                std::uint64_t seed, std::string_view vehicle);

  [[nodiscard]] twins::gnss::SatelliteId satellite() const { return satellite_; }
  [[nodiscard]] twins::gnss::Signal signal() const { return signal_; }

  /// Begins to track the signal, handed over by the search with errors of +-20 Hz and a quarter of a chip. `rf` is the
  /// signal as it is radiated.
  void start_from_search(const RfSignal& rf, double oscillator_m, double oscillator_drift_mps);
  /// Begins to track L2, handed over by the tracked L1: its rate is known to 0.5 Hz, its code to the ionosphere.
  void start_from(const SignalChannel& first, const RfSignal& rf, double oscillator_m);
  void stop();

  /// Computes the updates of one block. `smoothing_s` is that of the command CSMOOTH.
  void advance(const LoopInput& input, double smoothing_s);

  /// Resolves the half cycle by the sign of the bits that the message gave. Returns false if the opposite sign had been
  /// assumed (the loop slipped by half cycles): the count restarts.
  bool resolve_half_cycle();
  void forget_half_cycle() { parity_known_ = false; }

  [[nodiscard]] bool active() const { return state_ != ChannelState::kIdle; }
  [[nodiscard]] ChannelState state() const { return state_; }
  [[nodiscard]] bool code_lock() const { return code_lock_; }
  [[nodiscard]] bool phase_lock() const { return state_ == ChannelState::kPhaseLock; }
  [[nodiscard]] bool parity_known() const { return parity_known_; }
  [[nodiscard]] double lock_time_s() const { return lock_blocks_ * 0.1; }
  [[nodiscard]] double cn0_dbhz() const { return cn0_dbhz_; }
  [[nodiscard]] double rate_hz() const { return loops_.last().rate_hz; }
  [[nodiscard]] double code_m() const { return loops_.last().code_m; }
  [[nodiscard]] const BlockSeries& motion_m() const { return motion_m_; }
  [[nodiscard]] std::uint64_t phase_locks_lost() const { return phase_locks_lost_; }

  /// Returns the measurement at update `k` of the last block, which `LoopInput::snapshots` requested.
  [[nodiscard]] Measurement measurement(std::size_t k) const;

 private:
  void begin(double phase_cycles, double rate_hz, double code_m);
  void begin_count();
  void lose_phase_lock();
  void estimate_cn0();
  void smooth(double smoothing_s);
  void decide();
  [[nodiscard]] bool half_cycle_off() const;

  LoopSettings settings_;
  twins::gnss::SatelliteId satellite_;
  twins::gnss::Signal signal_;
  double wavelength_m_;
  NormalNoise noise_;
  TrackingLoops loops_;
  BlockSeries motion_m_{};
  std::array<LoopSnapshot, kUpdatesPerBlock> snapshots_{};

  ChannelState state_ = ChannelState::kIdle;
  int blocks_in_state_ = 0;
  int blocks_without_lock_ = 0;
  bool code_lock_ = false;
  bool parity_known_ = false;
  bool faded_ = false;              ///< the last block held noise only: its measurements are worthless
  double half_cycle_ = 0.0;         ///< 0 or 0.5, added to the phase
  double count_origin_cycles_ = 0;  ///< an integer, so that the phase starts near the pseudorange
  std::int64_t lock_blocks_ = 0;
  double smoothed_minus_carrier_m_ = 0.0;
  double smoothing_count_ = 0.0;
  double power_sum_ = 0.0;
  int power_blocks_ = 0;
  double cn0_dbhz_ = 0.0;
  std::uint64_t phase_locks_lost_ = 0;
};

}  // namespace vbar::grand::bench
