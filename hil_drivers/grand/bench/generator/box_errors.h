#pragma once
// Errors that an RF generator adds to an ideal signal: constant misalignment of its channels, and a slow wander of each
// channel's carrier phase. Its 10 MHz is common to all outputs and causes no error.

#include <cstdint>
#include <string_view>
#include <vector>

#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/gnss/satellite.h"

namespace vbar::grand::bench {

/// Alignments: interchannel figures of a commercial simulator's data sheet. Channel phase: first-order Gauss-Markov.
struct BoxErrorSettings {
  double carrier_alignment_mm = 0.27;  ///< one sigma per vehicle, satellite and signal
  double code_alignment_mm = 20.0;     ///< the same of the code
  double channel_phase_mm = 0.5;       ///< one sigma
  double channel_phase_time_s = 60.0;
  friend bool operator==(const BoxErrorSettings&, const BoxErrorSettings&) = default;
};

/// Errors of one channel of one vehicle: a satellite's signal. Streams:
/// "grand/box/<vehicle>/<satellite>/<signal>/alignment" and ".../channel_phase".
class ChannelErrors {
 public:
  ChannelErrors(const BoxErrorSettings& settings, std::uint64_t seed, std::string_view vehicle,
                twins::gnss::SatelliteId satellite, twins::gnss::Signal signal);

  [[nodiscard]] double carrier_alignment_m() const { return carrier_alignment_m_; }
  [[nodiscard]] double code_alignment_m() const { return code_alignment_m_; }

  /// Channel phase at the beginning and the end of block `number` (of 100 ms, rising), m. The process continues over
  /// blocks that are left out.
  struct Wander {
    double begin_m = 0.0, end_m = 0.0;
  };
  Wander wander(std::int64_t number);

 private:
  void step_to(std::int64_t node);

  double sigma_m_;
  double blocks_per_time_constant_;
  double decay_;  ///< decay over one block
  double carrier_alignment_m_ = 0.0;
  double code_alignment_m_ = 0.0;
  engine::RandomStream stream_;
  bool started_ = false;
  std::int64_t node_ = 0;
  double phase_m_ = 0.0;
};

}  // namespace vbar::grand::bench
