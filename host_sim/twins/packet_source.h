#pragma once
// Whatever the flight software senses comes from a PacketSource: a digital twin, the driver of a testbed, a recorded
// log.

#include <cstdint>
#include <future>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/attitude/attitude_state.h"

namespace vbar::twins {

/// One space packet, whole.
using Packet = std::vector<std::uint8_t>;

/// The truth about one spacecraft.
struct SpacecraftTruth {
  std::string name;
  fsw::orbit::CartesianState orbit;
  std::optional<truth::AttitudeState> attitude;  ///< if it has one
};

/// The truth at one instant.
struct TruthSnapshot {
  fsw::GpsTime time;
  std::vector<SpacecraftTruth> spacecraft;
  fsw::Matrix3 R_itrf_gcrf = fsw::Matrix3::Identity();  ///< the Earth's true orientation

  /// Null if there is none of that name.
  [[nodiscard]] const SpacecraftTruth* find(std::string_view name) const {
    for (const SpacecraftTruth& candidate : spacecraft)
      if (candidate.name == name) return &candidate;
    return nullptr;
  }
};

/// Something a source or an actuator knows about its own truth (an achieved pose, an error it made); for the report
/// only.
struct Note {
  std::string name;  ///< with the unit, if it has one: "pointing_error_rad"
  double value = 0.0;
};

enum class MeasurementStatus {
  kReady,   ///< the packets are there (possibly none: nothing to be seen)
  kLater,   ///< not yet: ask again for the same epoch; simulated time waits in lock-step
  kFailed,  ///< there will be none for this epoch
};

struct Measurement {
  MeasurementStatus status = MeasurementStatus::kFailed;
  std::vector<Packet> packets;
  /// More packets, still in the making on another thread: asked for at `available`, when the simulation waits for them.
  /// They must be a pure function of what measure() was given, so that it does not matter when they were made.
  std::future<std::vector<Packet>> pending;
  /// From what the pending packets can be made again (for images, an encoded vbar_host.image_recipe): a log may keep it
  /// in their place. Empty: they cannot be.
  std::vector<std::uint8_t> recipe;
  fsw::GpsTime available;  ///< when the packets leave the sensor: the epoch or later
  bool bypasses_link =
      false;  ///< at the flight computer by then already (recorded delivery, wired to the board): no link is simulated
  std::vector<Note> notes;
  std::string reason;  ///< kFailed: one sentence
};

class PacketSource {
 public:
  PacketSource() = default;
  PacketSource(const PacketSource&) = delete;
  PacketSource& operator=(const PacketSource&) = delete;
  virtual ~PacketSource() = default;

  /// The first epoch at or after `from` at which it measures; none if it never will again.
  [[nodiscard]] virtual std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const = 0;

  /// Measures at the epoch of `truth`. Epochs come in order; the same one again only after kLater.
  virtual Measurement measure(const TruthSnapshot& truth) = 0;
};

/// The first of start, start + period, ... at or after `from`; period > 0.
[[nodiscard]] constexpr fsw::GpsTime next_periodic_epoch(fsw::GpsTime start, fsw::Duration period, fsw::GpsTime from) {
  if (from <= start) return start;
  const std::int64_t periods = ((from - start).ns + period.ns - 1) / period.ns;
  return start + fsw::Duration{periods * period.ns};
}

}  // namespace vbar::twins
