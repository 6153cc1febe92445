#pragma once
// Normal noise for the hot loop: the numbers of an engine::RandomStream through a table of the normal quantile. Cubic
// interpolation deviates from the quantile by at most 3e-5; the outer 3 % are computed exactly.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "emulators/grand/radio_field/rf_block.h"
#include "emulators/grand/receiver/receiver_settings.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::grand::bench {

/// Quantile of the standard normal distribution at p = (bits + 1/2)/2^64.
class NormalTable {
 public:
  static const NormalTable& instance();

  [[nodiscard]] double quantile(std::uint64_t bits) const {
    const std::size_t cell = bits >> 56U;
    if (cell < kTail || cell >= kCells - kTail) return engine::normal_quantile(engine::open_unit_interval(bits));
    const double u = static_cast<double>((bits << 8U) >> 12U) * 0x1p-52;
    const std::array<double, 4>& c = cells_[cell];
    return ((c[3] * u + c[2]) * u + c[1]) * u + c[0];
  }

 private:
  static constexpr std::size_t kCells = 256;
  static constexpr std::size_t kTail = 4;
  NormalTable();
  std::array<std::array<double, 4>, kCells> cells_{};
};

class NormalNoise {
 public:
  NormalNoise(std::uint64_t seed, std::string_view name) : stream_(seed, name), table_(&NormalTable::instance()) {}

  double operator()() { return table_->quantile(stream_.bits()); }
  /// Returns a number uniform on (low, high), from the same stream.
  double uniform(double low, double high) { return stream_.uniform(low, high); }

 private:
  engine::RandomStream stream_;
  const NormalTable* table_;
};

// Carrier and code loop of one signal, updated every 10 ms.
//
// With x the phase error, y the code error in chips, A = sqrt(2 C/N0 T), n unit noise, d the early-late spacing:
//
//   I = A R(y) cos x + n,   Q = A R(y) sin x + n,   R(y) = 1 - |y|
//   E - L = 2 A y cos x + sqrt(2 d) n,              |y| <= d/2
//   carrier: dx = atan(Q/I);  third order, w = B/0.7845:
//     acc += w^3 T dx,  rate += acc T + 1.1 w^2 T dx,  phase += rate T + acc T^2/2 + 2.4 w T dx
//   second order, w = B/0.53:  rate += w^2 T dx,  phase += rate T + 1.414 w T dx   (Kaplan, Hegarty 2017, 8.3.4)
//   code: aided by the carrier, first order: y += 4 Bd T (E-L)/(2 A)
//
// A frequency loop precedes the phase loop: the angle between consecutive correlations, which is insensitive to data
// bits as well, corrects the rate. The loop follows the received range including the receiver's own oscillator; a
// stable point lies at every half cycle. Slips and losses of lock are results of these equations.

inline constexpr double kUpdate_s = 0.01;
inline constexpr std::size_t kUpdatesPerBlock = 10;

/// Values at each update of a block.
using BlockSeries = std::array<double, kUpdatesPerBlock>;

/// Estimate of the loops at an update, the correction by this update included.
struct LoopSnapshot {
  double phase_cycles = 0.0;  ///< phase of the received range, from an arbitrary origin
  double rate_hz = 0.0;
  double acceleration_hz_per_s = 0.0;
  double code_m = 0.0;  ///< received range by the code
};

/// Input of one signal's loops in a block.
struct LoopInput {
  const RfSignal* signal = nullptr;           ///< null: noise only
  const BlockSeries* oscillator_m = nullptr;  ///< c times the offset of the receiver's oscillator, at each update
  double amplitude = 0.0;                     ///< A
  const BlockSeries* aiding_m = nullptr;      ///< motion by another signal's carrier; null: by the own one
  std::uint32_t snapshots = 0;                ///< bit k: the estimate at update k is wanted
};

enum class LoopMode : std::uint8_t { kPullIn, kPhase };

class TrackingLoops {
 public:
  TrackingLoops(const LoopSettings& settings, twins::gnss::Signal signal);

  /// Starts in pull-in, with the values of the search (or of another signal).
  void start(double phase_cycles, double rate_hz, double code_m);
  /// Changes from pull-in to tracking of the phase, and back (with the present rate).
  void set_mode(LoopMode mode);

  /// Computes the updates of one block. Estimates requested by `input.snapshots` go to `snapshots[k]`, the carrier's
  /// motion during each interval to `motion_m`.
  void advance(const LoopInput& input, NormalNoise& noise, LoopSnapshot* snapshots, BlockSeries& motion_m);

  /// Sets the estimate of the amplitude A, by which the code discriminator is normalised.
  void set_amplitude_estimate(double amplitude);

  /// Returns the block's sum of I^2 + Q^2, and the mean of cos 2x: (I^2 - Q^2)/(I^2 + Q^2) averaged over 1 s.
  [[nodiscard]] double power() const { return power_; }
  [[nodiscard]] double cos_2x() const { return cos_2x_; }
  [[nodiscard]] const LoopSnapshot& last() const { return last_; }
  /// Returns the code's range predicted to the next update.
  [[nodiscard]] double predicted_code_m() const { return code_m_; }
  /// Returns the phase of the received range minus that of the loop at the last update, whole cycles included: for the
  /// bits of the message, whose sign depends on its half cycles.
  [[nodiscard]] double phase_error_cycles() const { return phase_error_cycles_; }
  [[nodiscard]] LoopMode mode() const { return mode_; }

 private:
  struct Correlation {
    double i = 0.0;
    double q = 0.0;
    double early_minus_late = 0.0;
  };
  Correlation correlate(const LoopInput& input, double x, double y, NormalNoise& noise) const;
  void update_frequency(const Correlation& now);
  void update_phase(double dx_cycles);

  // Constants.
  double wavelength_m_;
  double chip_m_;
  double spacing_;
  double code_bandwidth_hz_;
  double gain_acceleration_, gain_rate_, gain_phase_;

  LoopMode mode_ = LoopMode::kPullIn;
  double phase_ = 0.0;  ///< phase predicted to the next update, cycles; so are the following
  double rate_ = 0.0;   ///< at the last update
  double acceleration_ = 0.0;
  double correction_ = 0.0;  ///< correction of the phase by the last update
  double code_m_ = 0.0;
  double amplitude_estimate_ = 0.0;
  double code_gain_ = 0.0;
  Correlation before_{};
  double power_ = 0.0;
  double cos_2x_ = 0.0;
  double phase_error_cycles_ = 0.0;
  LoopSnapshot last_;
};

}  // namespace vbar::grand::bench
