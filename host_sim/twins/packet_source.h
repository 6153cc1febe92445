#pragma once
// All measurements of the flight software come from a PacketSource: a digital twin, the driver of a testbed, or a
// recorded log.

#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "fsw/packets/packet.h"
#include "host_sim/io/serial_line.h"
#include "host_sim/truth/attitude/attitude_motion.h"
#include "host_sim/truth/forces/thrust_force.h"

namespace vbar::twins {

/// One space packet, whole.
using Packet = std::vector<std::uint8_t>;

/// Identifies an image as its tiles do.
struct ImageKey {
  std::uint8_t spacecraft = 0;  ///< as in the headers of the packets
  std::uint8_t unit = 0;
  std::int32_t image = 0;
  friend auto operator<=>(const ImageKey&, const ImageKey&) = default;
};

/// An image in a form in which a log keeps it.
struct LoggedImage {
  ImageKey key;
  std::vector<std::uint8_t> bytes;  ///< an LCM message
  friend bool operator==(const LoggedImage&, const LoggedImage&) = default;
};

/// The truth about one spacecraft.
struct SpacecraftTruth {
  std::string name;
  fsw::orbit::CartesianState orbit;
  std::optional<truth::AttitudeState> attitude = std::nullopt;  ///< if it has one
  // For a source that requests them (TruthDetail); empty for others.
  std::optional<fsw::Vector3> acceleration_eci = std::nullopt;  ///< the point mass included, m/s^2
  std::optional<fsw::Vector3> angular_acceleration_body =
      std::nullopt;  ///< rate of change of the angular rate in body axes, rad/s^2
};

/// The truth at one instant.
struct TruthSnapshot {
  fsw::GpsTime time;
  std::vector<SpacecraftTruth> spacecraft;
  fsw::Matrix3 R_itrf_gcrf = fsw::Matrix3::Identity();  ///< the Earth's true orientation

  /// Returns the spacecraft with a name; null if there is none.
  [[nodiscard]] const SpacecraftTruth* find(std::string_view name) const {
    for (const SpacecraftTruth& candidate : spacecraft)
      if (candidate.name == name) return &candidate;
    return nullptr;
  }
};

enum class TruthDetail { kStates, kAccelerations };

/// The true motion near the present, for a device with a latency, without future burns and pointing
/// commands.
class TruthOutlook {
 public:
  TruthOutlook() = default;
  TruthOutlook(const TruthOutlook&) = delete;
  TruthOutlook& operator=(const TruthOutlook&) = delete;
  virtual ~TruthOutlook() = default;

  static constexpr fsw::Duration kHorizon = fsw::duration_of_seconds(1);

  /// Returns the truth at a time, accelerations included. Throws std::out_of_range for a time before the present or
  /// beyond the horizon.
  [[nodiscard]] virtual TruthSnapshot at(fsw::GpsTime time) = 0;
};

/// A true value of a source or an actuator (an achieved pose, an error), or its cost;
/// for the record only.
struct Note {
  std::string name;  ///< with the unit, if it has one: "pointing_error_rad"
  double value = 0.0;
  std::string text = {};  ///< beside the value or, with a value of NaN, in its place
};

enum class MeasurementStatus {
  kReady,   ///< the packets are available (possibly none), or pending
  kFailed,  ///< no packets for this epoch
};

/// Output of a source that is completed after measure().
struct Completion {
  std::vector<Packet> packets;
  std::vector<Note> notes;
  std::string failure = {};  ///< if there are no packets: the reason, one sentence
  /// Recording as Measurement::recording, for an image that was taken after measure().
  std::optional<LoggedImage> recording = std::nullopt;
};

struct Measurement {
  MeasurementStatus status = MeasurementStatus::kFailed;
  std::vector<Packet> packets;
  /// Packets that another thread is still producing: collected at `available`, when the simulation waits for them
  /// up to the source's time limit. They must not depend on when they are collected: a pure function of what measure()
  /// was given, or recorded.
  std::future<Completion> pending;
  /// The exposure of the pending image (vbar_host.image_recipe), from which a digital camera can render it: a log may
  /// keep it in place of the packets if there is no recording.
  std::optional<LoggedImage> recipe;
  /// The pixels of an image that cannot be rendered again (vbar_host.recorded_image): a log keeps them in place of the
  /// packets, before the flight software receives these.
  std::optional<LoggedImage> recording;
  fsw::GpsTime available;  ///< when the packets leave the sensor: the epoch or later
  bool bypasses_link =
      false;  ///< at the flight computer by then already (recorded delivery, wired to the board): no link is simulated
  std::vector<Note> notes;
  std::string reason;  ///< kFailed: one sentence
};

/// Upset of a simulated device between two measurements.
struct Upset {
  enum class Kind : std::uint8_t {
    kCycleSlip,  ///< carriers slip by `value` whole cycles, undetected by the receiver
    kClockJump,  ///< its clock jumps by `value`, s
    kReset,      ///< it starts again: no signal is tracked, clock and ambiguities are new
  };
  Kind kind = Kind::kReset;
  double value = 0.0;
  /// Satellite of kCycleSlip: "G05"; "highest", that of the highest elevation at the last epoch; "all", each by another
  /// multiple of `value`.
  std::string satellite = {};
};

enum class StopReason { kCompleted, kInterrupted, kFailed };

class PacketSource {
 public:
  PacketSource() = default;
  PacketSource(const PacketSource&) = delete;
  PacketSource& operator=(const PacketSource&) = delete;
  virtual ~PacketSource() = default;

  /// Starts the source before the run folder exists: a device answers, is homed and calibrated. `first_epoch` is the
  /// start of the run. Throws std::runtime_error, one sentence, if the run must not start.
  virtual void start(fsw::GpsTime first_epoch) { static_cast<void>(first_epoch); }

  /// Stops the source when the run is over, however it ended: motion stops, and what is pending is completed or
  /// abandoned without delay. Called once after start(), also after one that threw. An exception is reported and has no
  /// other effect.
  virtual void stop(StopReason reason) { static_cast<void>(reason); }

  /// Returns the first epoch at or after `from` at which it measures; empty after the last one.
  [[nodiscard]] virtual std::optional<fsw::GpsTime> next_epoch(fsw::GpsTime from) const = 0;

  /// Measures at the epoch of `truth`. Epochs are in order. It should return within a second, since it cannot be
  /// interrupted: longer work is `pending`.
  virtual Measurement measure(const TruthSnapshot& truth) = 0;

  /// Receives a command of the flight software, of any kind and to any device; it takes effect at `effective`, the
  /// present or later.
  virtual void command(const fsw::packets::PacketView& packet, fsw::GpsTime effective) {
    static_cast<void>(packet);
    static_cast<void>(effective);
  }

  /// Returns the content that its snapshots need.
  [[nodiscard]] virtual TruthDetail truth_detail() const { return TruthDetail::kStates; }

  /// Returns, after start(), the receiver whose bytes reach the flight computer on a line of its own, not in packets of
  /// this source.
  [[nodiscard]] virtual std::optional<io::WiredReceiver> wired_receiver() const { return std::nullopt; }

  /// Returns whether its measurements are evaluated individually, later and by their time (images): observers of the
  /// run then receive the truth of each.
  [[nodiscard]] virtual bool truth_is_compared() const { return false; }

  /// Returns the wall-clock time that the simulation waits for pending packets before it ends the run.
  [[nodiscard]] virtual std::chrono::milliseconds wait_limit() const { return std::chrono::minutes(1); }

  /// Returns the figures so far, for the summary. Must not wait for pending packets.
  [[nodiscard]] virtual std::vector<Note> statistics() const { return {}; }

  /// Upsets the device at the next measurement. False if it cannot happen to this source, or not now.
  virtual bool upset(const Upset& upset) {
    static_cast<void>(upset);
    return false;
  }
};

/// A source as the simulation, its record and its messages refer to it.
struct NamedSource {
  std::string name;  ///< in errors, notes and the summary: "servicer/gnss"
  std::string kind;  ///< "digital", "recorded" or the name of a testbed
  std::unique_ptr<PacketSource> packets;
};

/// Returns the first of start, start + period, ... at or after `from`; period > 0.
[[nodiscard]] constexpr fsw::GpsTime next_periodic_epoch(fsw::GpsTime start, fsw::Duration period, fsw::GpsTime from) {
  if (from <= start) return start;
  const std::int64_t periods = ((from - start).ns + period.ns - 1) / period.ns;
  return start + fsw::Duration{periods * period.ns};
}

// The name under which sources note packets that were not accepted.

/// Name of a note of a measurement, and of a figure of a source's statistics: number of its packets that were not
/// accepted.
inline constexpr std::string_view kPacketsRejected = "packets_rejected";

// The true world as a run moves it: time goes on, one spacecraft flies.

class TrueWorld {
 public:
  TrueWorld() = default;
  TrueWorld(const TrueWorld&) = delete;
  TrueWorld& operator=(const TrueWorld&) = delete;
  virtual ~TrueWorld() = default;

  /// Advances the world, not back in time.
  virtual void advance_to(fsw::GpsTime time) = 0;
  /// Returns the truth at the current time.
  [[nodiscard]] virtual TruthSnapshot snapshot(TruthDetail detail) = 0;

  // The spacecraft that flies.
  /// Adds a velocity, m/s in its own RTN, at the current time.
  virtual void apply_impulse_rtn(const fsw::Vector3& dv_rtn) = 0;
  /// Begins a burn with a duration at the current time. Throws std::runtime_error where burns can be impulses only.
  virtual void begin_burn(const truth::ThrustArc& /*arc*/) {
    throw std::runtime_error("the truth of this run knows impulses only: no thruster with thrust_n can act on it");
  }
  /// Points it to a direction in its own RTN, a unit vector and its rate (1/s) at `time`, if its attitude is commanded.
  virtual void point(fsw::GpsTime time, const fsw::Vector3& boresight_rtn, const fsw::Vector3& boresight_rate_rtn) = 0;

  /// Returns the wall-clock time spent in it so far, s.
  [[nodiscard]] virtual double wall_s() const = 0;
};

}  // namespace vbar::twins
