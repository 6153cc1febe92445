#pragma once
// An RF generator that flies vehicles along trajectories it receives: what the driver asks of it, whatever its
// protocol. A kind of generator is a folder beside this file and one line in generators.cpp.

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

/// What all generators are configured with before a run.
struct GeneratorPlan {
  fsw::GpsTime start;                 ///< of the first sample; whole second
  std::vector<std::string> vehicles;  ///< in the order of the `vehicle` arguments below
  fsw::Duration sample_period;
  fsw::Duration join;  ///< during which a new sample is joined to the motion flown so far
  Pace pace = Pace::kLockStep;
  std::string host;
  std::vector<std::uint16_t> control_ports;  ///< of the vehicles' instances, or of the one machine
  std::uint16_t hil_port = 0;                ///< 0: the generator's own answer, or its control port
};

/// What the generator makes of the trajectory.
enum class Extrapolation { kDeterministic = 0, kNonDeterministic = 1, kSnap = 2 };

struct GeneratorState {
  std::string text;  ///< the generator's own words: "Streaming RF"
  bool is_streaming = false;
  std::string error = {};  ///< if the generator reports one
  std::optional<Extrapolation> extrapolation = std::nullopt;
};

/// All functions throw std::runtime_error, one sentence with generator, command and answer, if the generator refuses,
/// does not answer or has closed the connection.
class Generator {
 public:
  Generator() = default;
  Generator(const Generator&) = delete;
  Generator& operator=(const Generator&) = delete;
  virtual ~Generator() = default;

  /// Configures it with a sample of time 0 for each vehicle. Afterwards start() is all that is missing.
  virtual void prepare(std::span<const TrajectorySample> first) = 0;

  /// Real time: returns the host's clock (std::chrono::steady_clock) at the generator's time 0, as well as the
  /// generator says it; empty if only its edges state it. Lock-step: the generator runs as far as its samples reach.
  virtual std::optional<std::chrono::steady_clock::time_point> start() = 0;

  virtual void send(std::size_t vehicle, const TrajectorySample& sample) = 0;

  /// Waits until the vehicle has been flown up to `time` (since start) or `deadline` has passed; the time reached, as
  /// the generator reports it. Empty: it has reported none by then.
  virtual std::optional<fsw::Duration> wait_for(std::size_t vehicle, fsw::Duration time,
                                                std::chrono::steady_clock::time_point deadline) = 0;

  /// Asks for the state; about once a second in real time.
  virtual GeneratorState state(std::size_t vehicle) = 0;

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
  bool has_instance_per_vehicle = false;  ///< with a control port each, in sequence
};

/// All kinds of this program; the first is the default.
[[nodiscard]] std::span<const GeneratorKind* const> generator_kinds();

}  // namespace vbar::grand
