#pragma once
// Interface of the emulated generator for its control protocols: the servers (../control) call it, it calls them back.

#include <cstddef>
#include <functional>
#include <string>

#include "fsw/core/gps_time.h"
#include "hil_drivers/grand/wire/trajectory_sample.h"

namespace vbar::grand::bench {

enum class EngineState { kIdle, kConfigured, kArmed, kStreaming, kStopped, kError };

/// State and counters of one vehicle.
struct VehicleReport {
  fsw::Duration time;           ///< end of the motion so far, since start
  int extrapolation = 0;        ///< 0 deterministic, 1 non-deterministic (no sample for 1 s), 2 snap
  double extrapolated_s = 0.0;  ///< time since the last sample
  std::uint64_t samples = 0, late = 0, doubled = 0, snaps = 0;
  std::uint64_t out_of_order = 0;  ///< older than the sample in use, ignored
  std::uint64_t rejected = 0;      ///< not usable: not finite, not in an orbit, more than 10 s ahead
};

/// Engine of the generator. Single-threaded: everything is called from the event loop of the program.
class Engine {
 public:
  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;

  [[nodiscard]] virtual std::size_t vehicles() const = 0;
  [[nodiscard]] virtual EngineState state() const = 0;
  [[nodiscard]] virtual std::string error() const = 0;

  /// Discards configuration and motion.
  virtual void reset() = 0;
  /// Each command returns an empty text, or the reason of a rejection, one sentence.
  virtual std::string set_start_time(fsw::GpsTime time) = 0;
  virtual std::string set_join(fsw::Duration join) = 0;
  virtual std::string arm() = 0;
  /// Begins to radiate: in lock-step at once and as far as the samples reach; in real time `delay` after the last edge
  /// of the 1PPS (PPS0).
  virtual std::string start(fsw::Duration delay) = 0;
  virtual void stop() = 0;

  /// Processes a sample; one whose time has passed is used from now on and counted as late.
  virtual void sample(std::size_t vehicle, const TrajectorySample& sample) = 0;

  [[nodiscard]] virtual VehicleReport report(std::size_t vehicle) const = 0;
  /// Returns the motion at report().time: a generator sends it back as vehicle information.
  [[nodiscard]] virtual TrajectorySample flown(std::size_t vehicle) const = 0;
  /// Returns CLOCK_REALTIME, ms, at the PPS edge after which start() counts; 0 before it.
  [[nodiscard]] virtual std::int64_t system_time_at_pps0_ms() const = 0;

  /// Called by the engine whenever it has moved the vehicle further and all bytes that left the receiver by then have
  /// been written to its lines. Several servers may listen.
  std::vector<std::function<void(std::size_t vehicle)>> on_progress;
  /// Called at the next edge of the 1PPS, once, then forgotten (WaitAndResetPPS).
  std::vector<std::function<void()>> on_next_edge;
};

}  // namespace vbar::grand::bench
