#pragma once
// Commands of emulated Skydel instances, without sockets: one instance per vehicle, the first is the main instance of
// the start by 1PPS, the others are its workers.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/grand/control/control_servers.h"
#include "hil_drivers/grand/wire/skydel.h"

namespace vbar::grand::bench {

class SkydelCommands {
 public:
  using Json = wire::Json;
  /// Sends the result of a command that is answered later.
  using Answer = std::function<void(const Json& result)>;

  SkydelCommands(Engine& engine, const ControlSettings& settings, std::vector<std::uint16_t> hil_ports);

  /// Executes a command of an instance. Returns the result, FailureResult for anything that a real instance rejects;
  /// empty if `later` gives it.
  std::optional<Json> execute(std::size_t instance, const Json& command, const Answer& later);

  /// Returns true if a sample for this instance's vehicle is expected.
  [[nodiscard]] bool expects_samples(std::size_t instance);
  [[nodiscard]] bool sends_vehicle_info(std::size_t instance) const { return instances_[instance].vehicle_info; }
  /// Records the state of extrapolation. The worst state since the last question is reported.
  void note_progress(std::size_t instance);

 private:
  enum class Role { kNone, kMain, kWorker };
  struct Instance {
    bool has_config = false;
    bool has_target = false;
    bool has_signals = false;
    bool is_hil = false;
    bool vehicle_info = false;
    Role role = Role::kNone;
    std::optional<fsw::GpsTime> start = std::nullopt;
    std::optional<fsw::Duration> join = std::nullopt;
    int worst_extrapolation = 0;
    std::uint64_t snaps_reported = 0;
    fsw::Duration worst_at = {};
  };
  enum class Stage { kIdle, kArmed, kPps0, kStarted };
  struct Call {
    std::size_t instance;
    const Json& command;
    const Answer& later;
  };
  using Handler = std::optional<Json> (SkydelCommands::*)(const Call& call);
  /// States of an instance in which a command is permitted, as the API documents them for each.
  enum Permission : unsigned { kNoConfig = 1U, kIdle = 2U, kSimulating = 4U };
  static constexpr unsigned kAlways = kNoConfig | kIdle | kSimulating;
  struct Command {
    std::string_view name;
    unsigned permission;
    Handler handler;
  };
  static const std::vector<Command>& commands();

  // Handlers return the result or throw a Refusal.
  std::optional<Json> get_hil_port(const Call& call);
  std::optional<Json> get_version(const Call& call);
  std::optional<Json> get_engine_latency(const Call& call);
  std::optional<Json> set_engine_latency(const Call& call);
  std::optional<Json> get_streaming_buffer(const Call& call);
  std::optional<Json> new_config(const Call& call);
  std::optional<Json> set_modulation_target(const Call& call);
  std::optional<Json> change_signals(const Call& call);
  std::optional<Json> enable_log(const Call& call);
  std::optional<Json> set_log_rate(const Call& call);
  std::optional<Json> set_start_time(const Call& call);
  std::optional<Json> set_vehicle_trajectory(const Call& call);
  std::optional<Json> set_join(const Call& call);
  std::optional<Json> enable_main(const Call& call);
  std::optional<Json> enable_worker(const Call& call);
  std::optional<Json> set_sync_server(const Call& call);
  std::optional<Json> set_sync_client(const Call& call);
  std::optional<Json> arm(const Call& call);
  std::optional<Json> wait_for_pps(const Call& call);
  std::optional<Json> start(const Call& call);
  std::optional<Json> get_time_at_pps0(const Call& call);
  std::optional<Json> begin_vehicle_info(const Call& call);
  std::optional<Json> end_vehicle_info(const Call& call);
  std::optional<Json> get_state(const Call& call);
  std::optional<Json> get_extrapolation(const Call& call);
  std::optional<Json> stop(const Call& call);

  /// Adopts the engine's state, which may have stopped or restarted by itself.
  void follow_engine();
  [[nodiscard]] Instance& of(const Call& call) { return instances_[call.instance]; }
  void require_permission(std::size_t instance, const Command& command) const;
  void require_main(const Call& call) const;
  /// Returns true for the main instance and its workers.
  [[nodiscard]] bool takes_part(std::size_t index) const {
    return index == 0 || instances_[index].role == Role::kWorker;
  }
  /// Returns what an instance lacks before it can be armed; empty if nothing.
  [[nodiscard]] std::string missing(std::size_t index) const;
  [[nodiscard]] static Json success(const Call& call) { return wire::skydel_result("SuccessResult", call.command); }

  Engine& engine_;
  ControlSettings settings_;
  std::vector<std::uint16_t> hil_ports_;
  std::vector<Instance> instances_;
  Stage stage_ = Stage::kIdle;
  std::uint64_t run_ = 0;  ///< counts arming and stopping, so that an edge of an earlier run has no effect
  /// Expires with this object: the engine keeps callbacks.
  std::shared_ptr<int> alive_ = std::make_shared<int>(0);
};

}  // namespace vbar::grand::bench
