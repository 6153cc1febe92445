#pragma once
// Receiver's own position, velocity and time: least squares of GPS L1 code and Doppler, iterated from its last
// position, with the ephemerides it has received. Neither ionosphere nor truth enters.
// State: position (m, ECEF), clock offset (s); then velocity (m/s), clock drift.

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "emulators/grand/radio_field/rf_block.h"
#include "emulators/grand/receiver/message_reception.h"
#include "emulators/grand/receiver/receiver_settings.h"
#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "host_sim/twins/gnss/oem_encoder.h"
#include "host_sim/twins/gnss/satellite.h"

namespace vbar::grand::bench {

struct SolutionInput {
  const twins::gnss::Ephemeris* ephemeris = nullptr;
  double pseudorange_m = 0.0;
  double range_rate_mps = 0.0;
  double sigma_m = 1.0;
};

struct OwnSolution {
  fsw::Vector3 position_ecef = fsw::Vector3::Zero();  ///< at the epoch
  fsw::Vector3 velocity_ecef = fsw::Vector3::Zero();
  fsw::Vector3 position_sigma_m = fsw::Vector3::Zero();
  fsw::Vector3 velocity_sigma_mps = fsw::Vector3::Zero();
  double clock_offset_s = 0.0;  ///< reading minus GPS time
  double clock_drift = 0.0;
  double clock_sigma_s = 0.0;
  int satellites = 0;
};

/// Solves for an epoch. `reading` is the epoch by the receiver's clock, `start` a position within some thousand
/// kilometres, or none. No solution with fewer than four satellites, a singular geometry, without convergence or away
/// from the Earth.
std::optional<OwnSolution> solve_own(const std::vector<SolutionInput>& input, fsw::GpsTime reading,
                                     const std::optional<fsw::Vector3>& start);

// Measurements of a receiver and its data, without its ports: by the emulated loops (measurement_engine.h) or by
// another program on baseband samples (../samples/gnss_sdr).

/// State for the record of the emulator; it enters no byte of the receiver.
struct ReceiverReport {
  int time_status = 20;  ///< as in the header of a log
  int signals_searched = 0;
  int signals_tracked = 0;  ///< number of signals with code lock
  int signals_phase_locked = 0;
  int ephemerides = 0;
  double clock_offset_s = 0.0;  ///< true: clock minus GPS time; 0 until the clock has been set
  std::uint64_t epochs = 0;
  std::uint64_t phase_locks_lost = 0;
  std::uint64_t logs = 0, logs_dropped = 0;
  std::uint64_t commands = 0, commands_refused = 0;
  std::uint64_t garbage_bytes = 0;  ///< received at a wrong baud rate
};

/// Measurements of one epoch of the receiver's clock.
struct EpochData {
  std::int64_t number = 0;  ///< number of 10 ms of the reading
  fsw::GpsTime reading;
  double after_begin_s = 0.0;  ///< time of the epoch since the beginning of the block
  std::vector<twins::gnss::oem::RangeRecord> ranges;
  std::optional<OwnSolution> solution;
  int satellites_tracked = 0;
};

class Measurements {
 public:
  Measurements() = default;
  Measurements(const Measurements&) = delete;
  Measurements& operator=(const Measurements&) = delete;
  virtual ~Measurements() = default;

  /// Discards everything but what is stored.
  virtual void restart(StoredData stored) = 0;

  struct Listener {
    std::function<bool(std::int64_t epoch)> wants;   ///< returns true if a log is due at this epoch
    std::function<void(const EpochData&)> on_epoch;  ///< called for these and for every whole second
  };
  /// Advances by the 100 ms of the block.
  virtual void advance(const RfBlock& block, double cn0_offset_db, const Listener& listener) = 0;

  // Commands; those that do not apply are accepted without effect.
  virtual void set_approximate_time(fsw::GpsTime /*time*/) {}
  virtual void set_approximate_position(const fsw::Vector3& /*position_ecef*/) {}
  virtual void enable_steering(bool /*on*/) {}
  virtual void set_smoothing(double /*smoothing_s*/) {}
  virtual void set_elevation_cutoff(double /*elevation*/) {}

  [[nodiscard]] virtual twins::gnss::oem::TimeStatus time_status() const = 0;
  /// Returns true if the clock has been set by a time of week received.
  [[nodiscard]] bool time_is_set() const { return time_status() >= twins::gnss::oem::TimeStatus::kCoarse; }
  /// Returns the reading of the clock at the end of the block, whole milliseconds.
  [[nodiscard]] virtual fsw::GpsTime reading() const = 0;

  /// Messages received, by the constellation's index.
  [[nodiscard]] virtual std::size_t satellites() const = 0;
  [[nodiscard]] virtual const MessageReception& reception(std::size_t satellite) const = 0;
  [[nodiscard]] virtual bool corrections_known() const = 0;
  /// Events of the last block: satellites with a new set, and whether ionosphere and UTC were received.
  [[nodiscard]] virtual const std::vector<std::size_t>& new_sets() const = 0;
  [[nodiscard]] virtual bool new_corrections() const = 0;

  /// Fills the state of clock, search and tracking.
  virtual void report(ReceiverReport& report) const = 0;
};

}  // namespace vbar::grand::bench
