#pragma once
// Receiver's clock: its reading, and how the receiver sets and steers it.
//
// reading = GPS time + oscillator offset + setting. The loops see the oscillator; a setting changes the reading alone,
// and pseudorange and phase by c times as much. So that double differences remain integers, a setting is a multiple of
// 1/2.046 MHz: all carriers used have a whole number of cycles in it (L1 770, L2 600, B1I 763); milliseconds have too.
//
// With CLOCKADJUST the frequency is steered once a second by the receiver's own point solution: against its drift, and
// in proportion to its offset. (An integral of the offset in the place of the measured drift, at 0.03 Hz, leaves 28 ns
// of the random walk of frequency of the twin's oscillator: sqrt(S_g/(4 zeta w^3)).) The frequency moves in ramps, so
// that no carrier loop sees a step. Without it the reading is set by whole milliseconds when its offset passes half of
// one.

#include <array>
#include <cstdint>
#include <string_view>

#include "emulators/grand/receiver/tracking_loops.h"
#include "fsw/core/gps_time.h"
#include "host_sim/twins/gnss/oem_encoder.h"
#include "host_sim/twins/gnss/point_solution.h"

namespace vbar::grand::bench {

using twins::gnss::oem::TimeStatus;

class SteeredClock {
 public:
  SteeredClock(const twins::gnss::ClockSettings& settings, double steering_bandwidth_hz, std::uint64_t seed,
               std::string_view vehicle);

  /// Discards the time and the steering; the oscillator continues. The reading then counts from zero.
  void restart();
  /// Sets the reading by SETAPPROXTIME from the next block on (rounded to a millisecond of the oscillator's own time).
  void set_approximate(fsw::GpsTime reading);
  void enable_steering(bool on) { steering_enabled_ = on; }
  [[nodiscard]] bool steering_enabled() const { return steering_enabled_; }

  /// Advances the oscillator over the block that begins at `begin`.
  void advance(fsw::GpsTime begin);

  /// Returns c times the oscillator's offset at each update of the block, and its rate at the beginning, m/s.
  [[nodiscard]] const BlockSeries& oscillator_m() const { return oscillator_m_; }
  [[nodiscard]] double oscillator_rate_mps() const;

  /// The multiple of 10 ms of the reading that is nearest to update `k` of the block (number, from GPS time zero), and
  /// the time from that update until the clock shows it, s.
  struct Epoch {
    std::int64_t number = 0;
    double after_update_s = 0.0;
  };
  [[nodiscard]] Epoch epoch(std::size_t k) const { return epochs_[k]; }

  /// Returns the reading at the end of the block, whole milliseconds, as it has been set by now.
  [[nodiscard]] fsw::GpsTime reading_at_end() const;

  /// Returns the metres to be added to ranges and phases by the loops: c times the setting.
  [[nodiscard]] double setting_m() const;
  /// Returns the setting in cycles of a carrier, a whole number.
  [[nodiscard]] double setting_cycles(double frequency_hz) const;

  /// Sets the reading by a time of week received, as if the signal had travelled for `assumed_travel_s`, instead of
  /// `travel_s`. Takes effect at the next block.
  void set_coarse(double travel_s, double assumed_travel_s);
  /// Processes a point solution, once a second: estimated offset of the reading (s), its drift, or none.
  void take_solution(double offset_s, double drift);
  void take_no_solution();

  [[nodiscard]] TimeStatus status() const { return status_; }
  [[nodiscard]] bool is_set() const { return status_ >= TimeStatus::kCoarse; }
  /// Returns the true offset of the reading at the beginning of the block.
  [[nodiscard]] double true_offset_s() const;

 private:
  void find_epochs();
  void take_first_solutions(double offset_s, double drift);
  void steer(double offset_s, double drift);
  void set_by_steps(double offset_s);
  void set_by_milliseconds(double offset_s);

  twins::gnss::CrystalOscillator oscillator_;
  double proportional_gain_;
  double jump_threshold_s_;
  bool steering_enabled_ = true;

  TimeStatus status_ = TimeStatus::kUnknown;
  fsw::GpsTime begin_;
  std::int64_t setting_ms_ = 0;
  std::int64_t setting_steps_ = 0;  ///< setting in steps of 1/2.046 MHz
  bool reading_pending_ = true;     ///< the reading is to be set to pending_reading_ at the next block
  fsw::GpsTime pending_reading_;

  double steered_s_ = 0.0;      ///< offset by steering
  double steering_rate_ = 0.0;  ///< s/s
  double steering_target_ = 0.0;
  double frequency_ = 0.0;  ///< frequency that cancels the oscillator's drift
  bool loop_closed_ = false;
  int seconds_to_set_ = 0;
  int seconds_within_ = 0;
  int seconds_without_solution_ = 0;

  BlockSeries oscillator_m_{};
  std::array<Epoch, kUpdatesPerBlock> epochs_{};
};

}  // namespace vbar::grand::bench
