#pragma once
// RF generator that moves vehicles along trajectories it receives: the interface of the driver, for any protocol. A
// kind of generator is a file beside this one and one line in the list of generator_kinds().

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fsw/core/gps_time.h"
#include "hil_drivers/grand/wire/trajectory_sample.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::grand {

enum class Pace { kLockStep, kRealTime };

/// Configuration of every generator before a run.
struct GeneratorPlan {
  fsw::GpsTime start;                 ///< time of the first sample; whole second
  std::vector<std::string> vehicles;  ///< in the order of the `vehicle` arguments below
  fsw::Duration sample_period;
  fsw::Duration join;  ///< duration in which a new sample is joined to the motion so far
  Pace pace = Pace::kLockStep;
  std::string host;
  std::vector<std::uint16_t> control_ports;  ///< port of each vehicle's instance, or of the one machine
  std::uint16_t hil_port = 0;                ///< 0: the generator's own answer, or its control port
};

/// Continuation of the trajectory by the generator, as it reports it.
enum class Extrapolation { kDeterministic = 0, kNonDeterministic = 1, kSnap = 2 };

struct GeneratorState {
  std::string text;  ///< the generator's own words: "Streaming RF"
  bool is_streaming = false;
  std::string error = {};  ///< error that the generator reports, if any
  std::optional<Extrapolation> extrapolation = std::nullopt;
};

/// Generator of a run. All functions throw std::runtime_error, one sentence with generator, command and answer, if the
/// generator rejects a command, does not answer or has closed the connection.
class Generator {
 public:
  Generator() = default;
  Generator(const Generator&) = delete;
  Generator& operator=(const Generator&) = delete;
  virtual ~Generator() = default;

  /// Configures the generator with a sample of time 0 for each vehicle. Afterwards only start() is missing.
  virtual void prepare(std::span<const TrajectorySample> first) = 0;

  /// Starts the generator. Real time: returns the host's clock (std::chrono::steady_clock) at the generator's time 0,
  /// as exactly as the generator states it; empty if only its edges state it. Lock-step: the generator runs as far as
  /// its samples reach.
  virtual std::optional<std::chrono::steady_clock::time_point> start() = 0;

  virtual void send(std::size_t vehicle, const TrajectorySample& sample) = 0;

  /// Waits until the vehicle has been moved up to `time` (since start) or `deadline` has passed; returns the time
  /// reached, as the generator reports it. Empty: it has reported none by then.
  virtual std::optional<fsw::Duration> wait_for(std::size_t vehicle, fsw::Duration time,
                                                std::chrono::steady_clock::time_point deadline) = 0;

  /// Requests the state; about once a second in real time.
  virtual GeneratorState state(std::size_t vehicle) = 0;

  /// Returns true if the generator has named itself an emulation since prepare(); false if its protocol has no question
  /// for it.
  [[nodiscard]] virtual bool is_emulated() const { return false; }

  /// Ends the radiation. Does not throw.
  virtual void stop() noexcept = 0;
};

/// Settings of one kind of generator beyond the plan, as read from [testbed.grand.<name>].
struct GeneratorSettings {
  GeneratorSettings() = default;
  GeneratorSettings(const GeneratorSettings&) = default;
  GeneratorSettings& operator=(const GeneratorSettings&) = default;
  virtual ~GeneratorSettings() = default;
};

struct GeneratorKind {
  std::string_view name;  ///< the value of testbed.grand.generator
  /// Reads the kind's own table; throws MissionError.
  std::shared_ptr<const GeneratorSettings> (*read)(const mission::TableReader& section);
  std::unique_ptr<Generator> (*make)(const GeneratorPlan& plan, const GeneratorSettings& settings);
  bool has_instance_per_vehicle = false;  ///< one instance per vehicle, with a control port each, in sequence
};

/// Returns all kinds of this program; the first is the default.
[[nodiscard]] std::span<const GeneratorKind* const> generator_kinds();

// Skydel (Safran): one instance per vehicle, each with a control connection and a port for samples; the first is the
// main instance of the start by 1PPS.

extern const GeneratorKind kSkydelKind;

// Spirent SimGEN: one connection for commands; motion of all vehicles as datagrams to the UDP port of the same number
// in real time, as lines of the connection in lock-step.

extern const GeneratorKind kSimgenKind;

// Generator whose datagrams and control lines the mission file describes (IFEN: no interface document is public).

extern const GeneratorKind kTemplateKind;

}  // namespace vbar::grand
