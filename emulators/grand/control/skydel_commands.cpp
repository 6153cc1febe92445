#include "emulators/grand/control/skydel_commands.h"

#include <algorithm>

#include <fmt/format.h>

namespace vbar::grand::bench {
namespace {

using wire::Json;

constexpr std::int64_t kMaxPort = 65535;
constexpr std::int64_t kMaxJoin_ms = 10'000;
constexpr std::int64_t kMaxDelay_ms = 600'000;
constexpr std::int64_t kMaxRate_hz = 1'000'000'000;

fsw::Duration milliseconds(std::int64_t ms) {
  return {ms * 1'000'000};
}

void require(const std::string& refusal) {
  if (!refusal.empty()) throw Refusal(refusal);
}

struct ReportedState {
  std::string_view text;
  int state;
  int sub_state;
};

ReportedState reported(EngineState state, bool has_config) {
  switch (state) {
    case EngineState::kArmed:
      return {"Armed", wire::kSkydelStateStarted, wire::kSkydelSubStateArmed};
    case EngineState::kStreaming:
      return {wire::kSkydelStreaming, wire::kSkydelStateStarted, wire::kSkydelSubStateStreaming};
    case EngineState::kError:
      return {"Error", wire::kSkydelStateError, wire::kSkydelSubStateError};
    case EngineState::kIdle:
    case EngineState::kConfigured:
    case EngineState::kStopped:
      break;
  }
  return {"Idle", wire::kSkydelStateIdle,
          has_config ? wire::kSkydelSubStateIdle : wire::kSkydelSubStateIdleWithoutConfig};
}

}  // namespace

const std::vector<SkydelCommands::Command>& SkydelCommands::commands() {
  using S = SkydelCommands;
  static const std::vector<Command> kCommands = {
      {"GetHilPort", &S::get_hil_port},
      {"GetEngineLatency", &S::get_engine_latency},
      {"GetStreamingBuffer", &S::get_streaming_buffer},
      {"New", &S::new_config},
      {"SetModulationTarget", &S::set_modulation_target},
      {"ChangeModulationTargetSignals", &S::change_signals},
      {"SetGpsStartTime", &S::set_start_time},
      {"SetVehicleTrajectory", &S::set_vehicle_trajectory},
      {"SetHilTjoin", &S::set_join},
      {"EnableMainInstanceSync", &S::enable_main},
      {"EnableMasterPps", &S::enable_main},  // its name before API 23.11
      {"EnableWorkerInstanceSync", &S::enable_worker},
      {"EnableSlavePps", &S::enable_worker},
      {"SetSyncServer", &S::set_sync_server},
      {"SetSyncClient", &S::set_sync_client},
      {"ArmPPS", &S::arm},
      {"WaitAndResetPPS", &S::wait_for_pps},
      {"StartPPS", &S::start},
      {"GetComputerSystemTimeSinceEpochAtPps0", &S::get_time_at_pps0},
      {"BeginVehicleInfo", &S::begin_vehicle_info},
      {"EndVehicleInfo", &S::end_vehicle_info},
      {"GetSimulatorState", &S::get_state},
      {"GetHilExtrapolationState", &S::get_extrapolation},
      {"Stop", &S::stop},
  };
  return kCommands;
}

SkydelCommands::SkydelCommands(Engine& engine, const ControlSettings& settings, std::vector<std::uint16_t> hil_ports)
    : engine_(engine), settings_(settings), hil_ports_(std::move(hil_ports)), instances_(engine.vehicles()) {}

std::optional<Json> SkydelCommands::execute(std::size_t instance, const Json& command, const Answer& later) {
  follow_engine();
  try {
    const std::string name = wire::name_of(command);
    const auto found = std::find_if(commands().begin(), commands().end(),
                                    [&](const Command& candidate) { return candidate.name == name; });
    if (found == commands().end()) throw Refusal(fmt::format("The command {} is unknown to the emulated Skydel", name));
    static_cast<void>(wire::text_field(command, "CmdUuid"));
    return (this->*found->handler)({instance, command, later});
  } catch (const Refusal& refusal) {
    return wire::skydel_error(command, refusal.what());
  } catch (const wire::WireError& error) {
    return wire::skydel_error(command, error.what());
  }
}

void SkydelCommands::follow_engine() {
  const EngineState state = engine_.state();
  if (stage_ == Stage::kIdle || state == EngineState::kArmed || state == EngineState::kStreaming) return;
  stage_ = Stage::kIdle;
  ++run_;
  for (Instance& instance : instances_) instance.vehicle_info = false;
  // After a restart nothing is configured.
  if (state == EngineState::kIdle) instances_.assign(instances_.size(), {});
}

bool SkydelCommands::expects_samples(std::size_t instance) {
  follow_engine();
  return instances_[instance].is_hil && stage_ != Stage::kIdle;
}

void SkydelCommands::note_progress(std::size_t index) {
  const VehicleReport report = engine_.report(index);
  Instance& instance = instances_[index];
  const int now = report.snaps > instance.snaps_reported ? 2 : report.extrapolation;
  instance.snaps_reported = report.snaps;
  if (now < instance.worst_extrapolation) return;
  instance.worst_extrapolation = now;
  instance.worst_at = report.time;
}

SkydelCommands::Instance& SkydelCommands::configurable(const Call& call) {
  if (!of(call).has_config) throw Refusal("There is no configuration; send New first");
  if (stage_ != Stage::kIdle) throw Refusal("The simulation is armed or running; this command needs an idle simulator");
  return of(call);
}

void SkydelCommands::require_main(const Call& call) const {
  if (instances_[call.instance].role != Role::kMain)
    throw Refusal("This instance is not the main instance; send EnableMainInstanceSync to the first instance");
}

void SkydelCommands::require_running(const Call& call) const {
  static_cast<void>(call);
  if (stage_ == Stage::kIdle) throw Refusal("The simulation is not armed; send ArmPPS first");
}

std::optional<Json> SkydelCommands::get_hil_port(const Call& call) {
  return wire::skydel_result("HilPortResult", call.command, {{"Port", hil_ports_[call.instance]}});
}

std::optional<Json> SkydelCommands::get_engine_latency(const Call& call) {
  return wire::skydel_result("GetEngineLatencyResult", call.command, {{"Latency", settings_.engine_latency_ms}});
}

std::optional<Json> SkydelCommands::get_streaming_buffer(const Call& call) {
  return wire::skydel_result("GetStreamingBufferResult", call.command, {{"Size", settings_.streaming_buffer_ms}});
}

std::optional<Json> SkydelCommands::new_config(const Call& call) {
  if (stage_ != Stage::kIdle) throw Refusal("The simulation is armed or running; send Stop first");
  const bool discards = wire::bool_field(call.command, "DiscardCurrentConfig");
  static_cast<void>(wire::bool_field(call.command, "LoadDefaultConfig"));
  if (of(call).has_config && !discards)
    throw Refusal("The current configuration is not saved, and DiscardCurrentConfig is false");
  of(call) = {};
  of(call).has_config = true;
  if (call.instance == 0) engine_.reset();
  return success(call);
}

std::optional<Json> SkydelCommands::set_modulation_target(const Call& call) {
  Instance& instance = configurable(call);
  for (const char* field : {"Type", "Path", "Address", "Id"}) static_cast<void>(wire::text_field(call.command, field));
  static_cast<void>(wire::bool_field(call.command, "ClockIsExternal"));
  instance.has_target = true;
  return success(call);
}

std::optional<Json> SkydelCommands::change_signals(const Call& call) {
  Instance& instance = configurable(call);
  if (!instance.has_target) throw Refusal("There is no modulation target; send SetModulationTarget first");
  static_cast<void>(wire::integer_field(call.command, "Output", 0, 3));
  const auto low = wire::integer_field(call.command, "MinRate", 1, kMaxRate_hz);
  if (wire::integer_field(call.command, "MaxRate", 1, kMaxRate_hz) < low) throw Refusal("MaxRate is below MinRate");
  for (const char* field : {"Band", "Signal", "Id"}) static_cast<void>(wire::text_field(call.command, field));
  static_cast<void>(wire::integer_field(call.command, "Gain", -1, 200));
  static_cast<void>(wire::bool_field(call.command, "GPU"));
  instance.has_signals = true;
  return success(call);
}

std::optional<Json> SkydelCommands::set_start_time(const Call& call) {
  Instance& instance = configurable(call);
  const fsw::GpsTime time = wire::skydel_date_field(call.command, "Start");
  // The engine has the configuration of the main instance; arm() compares the others with it.
  if (call.instance == 0) require(engine_.set_start_time(time));
  instance.start = time;
  return success(call);
}

std::optional<Json> SkydelCommands::set_vehicle_trajectory(const Call& call) {
  Instance& instance = configurable(call);
  const std::string type = wire::text_field(call.command, "Type");
  if (type != "HIL")
    throw Refusal(fmt::format("The emulated Skydel has no trajectory \"{}\", only \"HIL\"", wire::printable(type)));
  instance.is_hil = true;
  return success(call);
}

std::optional<Json> SkydelCommands::set_join(const Call& call) {
  Instance& instance = configurable(call);
  if (!instance.is_hil) throw Refusal("The vehicle's trajectory is not HIL; send SetVehicleTrajectory first");
  const fsw::Duration join = milliseconds(wire::integer_field(call.command, "HilTjoin", 1, kMaxJoin_ms));
  if (join < milliseconds(settings_.engine_latency_ms))
    throw Refusal(fmt::format("HilTjoin is below the engine latency of {} ms", settings_.engine_latency_ms));
  if (call.instance == 0) require(engine_.set_join(join));
  instance.join = join;
  return success(call);
}

std::optional<Json> SkydelCommands::enable_main(const Call& call) {
  Instance& instance = configurable(call);
  if (!wire::bool_field(call.command, "Enabled")) {
    if (instance.role == Role::kMain) instance.role = Role::kNone;
    return success(call);
  }
  if (call.instance != 0) throw Refusal("Only the first instance of the emulated Skydel can be the main instance");
  instance.role = Role::kMain;
  return success(call);
}

std::optional<Json> SkydelCommands::enable_worker(const Call& call) {
  Instance& instance = configurable(call);
  if (!wire::bool_field(call.command, "Enabled")) {
    if (instance.role == Role::kWorker) instance.role = Role::kNone;
    return success(call);
  }
  if (call.instance == 0) throw Refusal("The first instance of the emulated Skydel is the main instance");
  instance.role = Role::kWorker;
  return success(call);
}

std::optional<Json> SkydelCommands::set_sync_server(const Call& call) {
  configurable(call);
  static_cast<void>(wire::integer_field(call.command, "Port", 1, kMaxPort));
  return success(call);
}

std::optional<Json> SkydelCommands::set_sync_client(const Call& call) {
  configurable(call);
  static_cast<void>(wire::text_field(call.command, "Host"));
  static_cast<void>(wire::integer_field(call.command, "Port", 1, kMaxPort));
  return success(call);
}

std::string SkydelCommands::missing(std::size_t index) const {
  const Instance& instance = instances_[index];
  const Instance& main = instances_.front();
  if (!instance.has_config) return "no configuration (New)";
  if (!instance.has_target) return "no modulation target (SetModulationTarget)";
  if (!instance.has_signals) return "no signals (ChangeModulationTargetSignals)";
  if (!instance.start) return "no start time (SetGpsStartTime)";
  if (!instance.is_hil) return "no trajectory (SetVehicleTrajectory)";
  if (!instance.join) return "no join time (SetHilTjoin)";
  if (index == 0) return "";
  if (instance.role != Role::kWorker) return "not been made a worker (EnableWorkerInstanceSync)";
  if (instance.start != main.start) return "another start time than the main instance";
  if (instance.join != main.join) return "another HilTjoin than the main instance";
  return "";
}

std::optional<Json> SkydelCommands::arm(const Call& call) {
  configurable(call);
  require_main(call);
  for (std::size_t k = 0; k < instances_.size(); ++k)
    if (const std::string reason = missing(k); !reason.empty())
      throw Refusal(fmt::format("Instance {} has {}", k, reason));
  require(engine_.arm());
  stage_ = Stage::kArmed;
  ++run_;
  return success(call);
}

std::optional<Json> SkydelCommands::wait_for_pps(const Call& call) {
  require_main(call);
  require_running(call);
  if (stage_ == Stage::kStarted) throw Refusal("The simulation has been started already");
  engine_.on_next_edge.emplace_back([this, alive = std::weak_ptr<int>(alive_), run = run_, later = call.later,
                                     result = success(call), command = call.command] {
    if (alive.expired()) return;
    if (run != run_ || stage_ == Stage::kIdle)
      return later(wire::skydel_error(command, "The simulation was stopped before the edge of the 1PPS"));
    if (stage_ == Stage::kArmed) stage_ = Stage::kPps0;
    later(result);
  });
  return std::nullopt;
}

std::optional<Json> SkydelCommands::start(const Call& call) {
  require_main(call);
  require_running(call);
  if (stage_ == Stage::kArmed) throw Refusal("There is no PPS0; send WaitAndResetPPS first");
  if (stage_ == Stage::kStarted) throw Refusal("The simulation has been started already");
  require(engine_.start(milliseconds(wire::integer_field(call.command, "Msec", 0, kMaxDelay_ms))));
  stage_ = Stage::kStarted;
  return success(call);
}

std::optional<Json> SkydelCommands::get_time_at_pps0(const Call& call) {
  if (stage_ != Stage::kStarted) throw Refusal("The simulation has not been started; send StartPPS first");
  return wire::skydel_result("GetComputerSystemTimeSinceEpochAtPps0Result", call.command,
                             {{"Milliseconds", static_cast<double>(engine_.system_time_at_pps0_ms())}});
}

std::optional<Json> SkydelCommands::begin_vehicle_info(const Call& call) {
  require_running(call);
  of(call).vehicle_info = true;
  return success(call);
}

std::optional<Json> SkydelCommands::end_vehicle_info(const Call& call) {
  of(call).vehicle_info = false;
  return success(call);
}

std::optional<Json> SkydelCommands::get_state(const Call& call) {
  const ReportedState state = reported(engine_.state(), of(call).has_config);
  return wire::skydel_result(
      "SimulatorStateResult", call.command,
      {{"State", state.text}, {"StateId", state.state}, {"SubStateId", state.sub_state}, {"Error", engine_.error()}});
}

std::optional<Json> SkydelCommands::get_extrapolation(const Call& call) {
  require_running(call);
  note_progress(call.instance);
  Instance& instance = of(call);
  const Json result =
      wire::skydel_result("GetHilExtrapolationStateResult", call.command,
                          {{"State", instance.worst_extrapolation}, {"ElapsedTime", instance.worst_at.ns / 1'000'000}});
  instance.worst_extrapolation = 0;
  return result;
}

std::optional<Json> SkydelCommands::stop(const Call& call) {
  if (stage_ != Stage::kIdle) engine_.stop();
  stage_ = Stage::kIdle;
  ++run_;
  for (Instance& instance : instances_) instance.vehicle_info = false;
  return success(call);
}

}  // namespace vbar::grand::bench
