#include "emulators/grand/control/skydel_commands.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <sstream>

#include <fmt/format.h>

namespace vbar::grand::bench {
namespace {

using wire::Json;

constexpr std::int64_t kMaxPort = 65535;
constexpr std::int64_t kMaxJoin_ms = 10'000;
constexpr std::int64_t kMaxDelay_ms = 600'000;
constexpr std::int64_t kMaxLatency_ms = 1000;

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

ReportedState reported(EngineState state, bool has_config, bool is_complete) {
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
  if (!has_config) return {"None", wire::kSkydelStateNone, wire::kSkydelSubStateNone};
  if (!is_complete) return {"Incomplete", wire::kSkydelStateIdle, wire::kSkydelSubStateConfigNotValid};
  return {"Ready", wire::kSkydelStateIdle, wire::kSkydelSubStateConfigValid};
}

// Values that the API documents for the fields of its commands.
constexpr std::array<std::string_view, 8> kTargets{"DTA-2116", "DTA-2115B", "File", "N310",
                                                   "None",     "NoneRT",    "X300", "Wavefront Controller"};
constexpr std::array<std::string_view, 4> kBands{"LowerL", "UpperL", "S-Band", "C-Band"};
constexpr std::array<std::string_view, 35> kSignals{
    "L1CA",    "L1C",    "L1P",     "L1ME",     "L1MR",     "L2C",      "L2P",      "L2ME",    "L2MR",
    "L5",      "G1",     "G2",      "E1",       "E5a",      "E5b",      "B1",       "B2",      "B1C",
    "B2a",     "B3I",    "SBASL1",  "QZSSL1CA", "QZSSL1CB", "QZSSL1C",  "QZSSL2C",  "QZSSL5",  "QZSSL1S",
    "QZSSL5S", "QZSSL6", "NAVICL1", "NAVICL5",  "NAVICS",   "PULSARXL", "PULSARX1", "PULSARX5"};
constexpr std::array<std::int64_t, 5> kRates_hz{12'500'000, 25'000'000, 50'000'000, 60'000'000, 100'000'000};
constexpr std::array<std::int64_t, 3> kLogRates_hz{10, 100, 1000};
constexpr std::int64_t kMaxGain_db = 115;
// Start time of a new configuration, which the API does not state.
constexpr fsw::GpsTime kDefaultStart{fsw::kNanosecondsPerSecond * 995'126'400};  // 2011-07-19 16:00:00

template <class Known, class Value>
void require_known(const Json& command, std::string_view field, const Known& known, const Value& value) {
  if (std::ranges::find(known, value) == std::end(known))
    throw Refusal(fmt::format("{}: {} {} is not one of {}", wire::name_of(command), field,
                              wire::printable(fmt::format("{}", value)), fmt::join(known, ", ")));
}

/// A published optional field is null or, as older clients do, missing.
bool is_given(const Json& command, const char* field) {
  const auto found = command.find(field);
  return found != command.end() && !found->is_null();
}

}  // namespace

const std::vector<SkydelCommands::Command>& SkydelCommands::commands() {
  using S = SkydelCommands;
  static const std::vector<Command> kCommands = {
      {"GetVersion", kAlways, &S::get_version},
      {"GetHilPort", kAlways, &S::get_hil_port},
      {"GetEngineLatency", kAlways, &S::get_engine_latency},
      {"SetEngineLatency", kNoConfig | kIdle, &S::set_engine_latency},
      {"GetStreamingBuffer", kAlways, &S::get_streaming_buffer},
      {"New", kNoConfig | kIdle, &S::new_config},
      {"SetModulationTarget", kIdle, &S::set_modulation_target},
      {"ChangeModulationTargetSignals", kIdle, &S::change_signals},
      {"EnableLogRaw", kIdle, &S::enable_log},
      {"EnableLogHILInput", kIdle, &S::enable_log},
      {"SetLogRawRate", kIdle, &S::set_log_rate},
      {"SetGpsStartTime", kIdle, &S::set_start_time},
      {"SetVehicleTrajectory", kIdle, &S::set_vehicle_trajectory},
      {"SetHilTjoin", kIdle, &S::set_join},
      {"EnableMainInstanceSync", kIdle, &S::enable_main},
      {"EnableMasterPps", kIdle, &S::enable_main},  // its name before API 23.11
      {"EnableWorkerInstanceSync", kIdle, &S::enable_worker},
      {"EnableSlavePps", kIdle, &S::enable_worker},
      {"SetSyncServer", kNoConfig | kIdle, &S::set_sync_server},
      {"SetSyncClient", kNoConfig | kIdle, &S::set_sync_client},
      {"ArmPPS", kIdle, &S::arm},
      {"WaitAndResetPPS", kSimulating, &S::wait_for_pps},
      {"StartPPS", kSimulating, &S::start},
      {"GetComputerSystemTimeSinceEpochAtPps0", kSimulating, &S::get_time_at_pps0},
      {"BeginVehicleInfo", kAlways, &S::begin_vehicle_info},
      {"EndVehicleInfo", kAlways, &S::end_vehicle_info},
      {"GetSimulatorState", kAlways, &S::get_state},
      {"GetHilExtrapolationState", kSimulating, &S::get_extrapolation},
      {"Stop", kSimulating | kIdle, &S::stop},
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
    require_permission(instance, *found);
    return (this->*found->handler)({instance, command, later});
  } catch (const Refusal& refusal) {
    return wire::skydel_failure(command, refusal.what());
  } catch (const wire::WireError& error) {
    return wire::skydel_failure(command, error.what());
  }
}

void SkydelCommands::follow_engine() {
  const EngineState state = engine_.state();
  if (stage_ == Stage::kIdle || state == EngineState::kArmed || state == EngineState::kStreaming) return;
  stage_ = Stage::kIdle;
  ++run_;
  for (Instance& instance : instances_) instance.join.reset();  // must be set before every simulation
  // After a restart nothing is configured.
  if (state == EngineState::kIdle) instances_.assign(instances_.size(), {});
}

bool SkydelCommands::expects_samples(std::size_t instance) {
  follow_engine();
  return takes_part(instance) && instances_[instance].is_hil && stage_ != Stage::kIdle;
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

void SkydelCommands::require_permission(std::size_t instance, const Command& command) const {
  if (stage_ != Stage::kIdle) {
    if ((command.permission & kSimulating) == 0U)
      throw Refusal(
          fmt::format("{} is not permitted while the simulation is armed or running; send Stop first", command.name));
  } else if (!instances_[instance].has_config) {
    if ((command.permission & kNoConfig) == 0U)
      throw Refusal(fmt::format("{} is not permitted without a configuration; send New first", command.name));
  } else if ((command.permission & kIdle) == 0U) {
    throw Refusal(fmt::format("{} is not permitted before the simulation is armed; send ArmPPS first", command.name));
  }
}

void SkydelCommands::require_main(const Call& call) const {
  if (instances_[call.instance].role != Role::kMain)
    throw Refusal("This instance is not the main instance; send EnableMainInstanceSync to the first instance");
}

std::optional<Json> SkydelCommands::get_version(const Call& call) {
  return wire::skydel_result("VersionResult", call.command, {{"Version", kEmulatedVersion}});
}

std::optional<Json> SkydelCommands::get_hil_port(const Call& call) {
  return wire::skydel_result("HilPortResult", call.command, {{"Port", hil_ports_[call.instance]}});
}

std::optional<Json> SkydelCommands::get_engine_latency(const Call& call) {
  return wire::skydel_result("GetEngineLatencyResult", call.command, {{"Latency", settings_.engine_latency_ms}});
}

// The latency itself is the scenario's: the emulated engine has no preferences.
std::optional<Json> SkydelCommands::set_engine_latency(const Call& call) {
  if (wire::integer_field(call.command, "Latency", 0, kMaxLatency_ms) != settings_.engine_latency_ms)
    throw Refusal(
        fmt::format("The emulated Skydel has a latency of {} ms; its scenario sets it", settings_.engine_latency_ms));
  return success(call);
}

std::optional<Json> SkydelCommands::get_streaming_buffer(const Call& call) {
  return wire::skydel_result("GetStreamingBufferResult", call.command, {{"Size", settings_.streaming_buffer_ms}});
}

std::optional<Json> SkydelCommands::new_config(const Call& call) {
  const bool discards = wire::bool_field(call.command, "DiscardCurrentConfig");
  if (is_given(call.command, "LoadDefaultConfig"))
    static_cast<void>(wire::bool_field(call.command, "LoadDefaultConfig"));
  if (of(call).has_config && !discards)
    throw Refusal("The current configuration is not saved, and DiscardCurrentConfig is false");
  const bool vehicle_info = of(call).vehicle_info;  // a subscription of the client, not a part of the configuration
  of(call) = {};
  of(call).has_config = true;
  of(call).vehicle_info = vehicle_info;
  if (call.instance == 0) engine_.reset();
  return success(call);
}

std::optional<Json> SkydelCommands::set_modulation_target(const Call& call) {
  Instance& instance = of(call);
  for (const char* field : {"Type", "Path", "Address", "Id"}) static_cast<void>(wire::text_field(call.command, field));
  static_cast<void>(wire::bool_field(call.command, "ClockIsExternal"));
  require_known(call.command, "Type", kTargets, wire::text_field(call.command, "Type"));
  instance.has_target = true;
  return success(call);
}

std::optional<Json> SkydelCommands::change_signals(const Call& call) {
  Instance& instance = of(call);
  if (!instance.has_target) throw Refusal("There is no modulation target; send SetModulationTarget first");
  static_cast<void>(wire::integer_field(call.command, "Output", 0, 3));
  const auto rate = [&](std::string_view field) {
    const std::int64_t hz = wire::integer_field(call.command, field, 1, kRates_hz.back());
    require_known(call.command, field, kRates_hz, hz);
    return hz;
  };
  if (rate("MaxRate") < rate("MinRate")) throw Refusal("MaxRate is below MinRate");
  require_known(call.command, "Band", kBands, wire::text_field(call.command, "Band"));
  std::istringstream signals(wire::text_field(call.command, "Signal"));
  for (std::string signal; std::getline(signals, signal, ',');)
    require_known(call.command, "Signal", kSignals, std::string_view(signal));
  static_cast<void>(wire::text_field(call.command, "Id"));
  static_cast<void>(wire::integer_field(call.command, "Gain", -kMaxGain_db, kMaxGain_db));
  static_cast<void>(wire::bool_field(call.command, "GaussianNoise"));
  if (is_given(call.command, "CentralFrequency"))
    static_cast<void>(wire::number_field(call.command, "CentralFrequency"));
  instance.has_signals = true;
  return success(call);
}

// The emulated instance writes no logs.
std::optional<Json> SkydelCommands::enable_log(const Call& call) {
  static_cast<void>(wire::bool_field(call.command, "Enabled"));
  return success(call);
}

std::optional<Json> SkydelCommands::set_log_rate(const Call& call) {
  require_known(call.command, "Rate", kLogRates_hz, wire::integer_field(call.command, "Rate", 1, kLogRates_hz.back()));
  return success(call);
}

std::optional<Json> SkydelCommands::set_start_time(const Call& call) {
  Instance& instance = of(call);
  const fsw::GpsTime time = wire::skydel_date_field(call.command, "Start");
  // The engine has the configuration of the main instance; arm() compares the others with it.
  if (call.instance == 0) require(engine_.set_start_time(time));
  instance.start = time;
  return success(call);
}

std::optional<Json> SkydelCommands::set_vehicle_trajectory(const Call& call) {
  Instance& instance = of(call);
  const std::string type = wire::text_field(call.command, "Type");
  if (type != "HIL")
    throw Refusal(fmt::format("The emulated Skydel has no trajectory \"{}\", only \"HIL\"", wire::printable(type)));
  instance.is_hil = true;
  return success(call);
}

std::optional<Json> SkydelCommands::set_join(const Call& call) {
  Instance& instance = of(call);
  if (!instance.is_hil) throw Refusal("The vehicle's trajectory is not HIL; send SetVehicleTrajectory first");
  const fsw::Duration join = milliseconds(wire::integer_field(call.command, "HilTjoin", 1, kMaxJoin_ms));
  if (join < milliseconds(settings_.engine_latency_ms))
    throw Refusal(fmt::format("HilTjoin is below the engine latency of {} ms", settings_.engine_latency_ms));
  if (call.instance == 0) require(engine_.set_join(join));
  instance.join = join;
  return success(call);
}

std::optional<Json> SkydelCommands::enable_main(const Call& call) {
  Instance& instance = of(call);
  if (!wire::bool_field(call.command, "Enabled")) {
    if (instance.role == Role::kMain) instance.role = Role::kNone;
    return success(call);
  }
  if (call.instance != 0) throw Refusal("Only the first instance of the emulated Skydel can be the main instance");
  instance.role = Role::kMain;
  return success(call);
}

std::optional<Json> SkydelCommands::enable_worker(const Call& call) {
  Instance& instance = of(call);
  if (!wire::bool_field(call.command, "Enabled")) {
    if (instance.role == Role::kWorker) instance.role = Role::kNone;
    return success(call);
  }
  if (call.instance == 0) throw Refusal("The first instance of the emulated Skydel is the main instance");
  instance.role = Role::kWorker;
  return success(call);
}

std::optional<Json> SkydelCommands::set_sync_server(const Call& call) {
  static_cast<void>(wire::integer_field(call.command, "Port", 1, kMaxPort));
  return success(call);
}

std::optional<Json> SkydelCommands::set_sync_client(const Call& call) {
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
  if (!instance.is_hil) return "no trajectory (SetVehicleTrajectory)";
  if (!instance.join) return "no join time (SetHilTjoin)";
  if (index == 0) return "";
  if (instance.start.value_or(kDefaultStart) != main.start.value_or(kDefaultStart))
    return "another start time than the main instance";
  if (instance.join != main.join) return "another HilTjoin than the main instance";
  return "";
}

std::optional<Json> SkydelCommands::arm(const Call& call) {
  require_main(call);
  for (std::size_t k = 0; k < instances_.size(); ++k)
    if (const std::string reason = takes_part(k) ? missing(k) : ""; !reason.empty())
      throw Refusal(fmt::format("Instance {} has {}", k, reason));
  if (!instances_.front().start) require(engine_.set_start_time(kDefaultStart));
  require(engine_.arm());
  stage_ = Stage::kArmed;
  ++run_;
  return success(call);
}

std::optional<Json> SkydelCommands::wait_for_pps(const Call& call) {
  require_main(call);
  if (stage_ == Stage::kStarted) throw Refusal("The simulation has been started already");
  engine_.on_next_edge.emplace_back([this, alive = std::weak_ptr<int>(alive_), run = run_, later = call.later,
                                     result = success(call), command = call.command] {
    if (alive.expired()) return;
    if (run != run_ || stage_ == Stage::kIdle)
      return later(wire::skydel_failure(command, "The simulation was stopped before the edge of the 1PPS"));
    if (stage_ == Stage::kArmed) stage_ = Stage::kPps0;
    later(result);
  });
  return std::nullopt;
}

std::optional<Json> SkydelCommands::start(const Call& call) {
  require_main(call);
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
  of(call).vehicle_info = true;
  return success(call);
}

std::optional<Json> SkydelCommands::end_vehicle_info(const Call& call) {
  of(call).vehicle_info = false;
  return success(call);
}

std::optional<Json> SkydelCommands::get_state(const Call& call) {
  const Instance& instance = of(call);
  const ReportedState state =
      reported(engine_.state(), instance.has_config, instance.has_target && instance.has_signals);
  return wire::skydel_result(
      "SimulatorStateResult", call.command,
      {{"State", state.text}, {"StateId", state.state}, {"SubStateId", state.sub_state}, {"Error", engine_.error()}});
}

std::optional<Json> SkydelCommands::get_extrapolation(const Call& call) {
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
  for (Instance& instance : instances_) instance.join.reset();
  return success(call);
}

}  // namespace vbar::grand::bench
