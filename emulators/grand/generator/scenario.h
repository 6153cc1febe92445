#pragma once
// Faults that the emulator can inject, as its scenario file and its control line name them.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/common/faults.h"
#include "emulators/grand/control/control_servers.h"
#include "emulators/grand/radio_field/sky.h"
#include "emulators/grand/receiver/receiver_settings.h"
#include "fsw/core/gps_time.h"
#include "hil_drivers/grand/generators/generator.h"
#include "host_sim/mission/table_reader.h"
#include "host_sim/twins/gnss/constellation.h"

namespace vbar::grand::bench {

enum class FaultKind {
  kLineHangUp,           ///< the terminal of a port disappears; duration 0: permanently
  kLineGarbage,          ///< random bytes between and in place of those for the host
  kLineHalfMessages,     ///< every second run of 200 bytes for the host is missing
  kLineFlood,            ///< 20 kB of random bytes every 100 ms
  kReceiverUnanswered,   ///< commands of the host are lost
  kReceiverRefuses,      ///< commands of the host are spoiled, so that the receiver rejects them
  kReceiverBaud,         ///< the receiver's port changes its rate
  kHostBaud,             ///< the host's end of the line changes its rate
  kReceiverOff,          ///< no power; duration 0: permanently
  kRfOutage,             ///< no signal at the vehicle's RF output
  kCn0Drop,              ///< all signals of the vehicle weaker
  kGeneratorError,       ///< the generator ends the radiation and reports an error
  kGeneratorRefuses,     ///< a command of the control protocol is answered by an error
  kGeneratorUnanswered,  ///< ... is not answered
  kGeneratorDies,        ///< closes all connections and radiates nothing; after the duration it accepts connections
  kPpsMissing,
  kPpsDoubled,
  kPpsJump,   ///< all later edges have a label that is off
  kPpsDelay,  ///< the next edge has a time stamp that is late
  kSamplesLost,
  kSamplesDoubled,
  kSamplesSwapped,  ///< a sample is handled after its successor
  kBenchExit,       ///< the program ends at once, with exit code 3
};

/// Keys of a kind beside time_s and kind.
struct FaultRule {
  std::string_view name;
  FaultKind kind;
  bool has_vehicle;
  bool has_port;
  bool has_duration;
  std::string_view value_key = {};  ///< key of the number that belongs to it
  mission::Range value_range = {};
  std::string_view text_key = {};  ///< key of a text that belongs to it
};

inline constexpr std::array<FaultRule, 23> kFaultRules{{
    {"line_hang_up", FaultKind::kLineHangUp, true, true, true},
    {"line_garbage", FaultKind::kLineGarbage, true, true, true},
    {"line_half_messages", FaultKind::kLineHalfMessages, true, true, true},
    {"line_flood", FaultKind::kLineFlood, true, true, true},
    {"receiver_unanswered", FaultKind::kReceiverUnanswered, true, true, true},
    {"receiver_refuses", FaultKind::kReceiverRefuses, true, true, true},
    {"receiver_baud", FaultKind::kReceiverBaud, true, true, false, "baud", {2400.0, 460800.0}},
    {"host_baud", FaultKind::kHostBaud, true, true, false, "baud", {2400.0, 460800.0}},
    {"receiver_off", FaultKind::kReceiverOff, true, false, true},
    {"rf_outage", FaultKind::kRfOutage, true, false, true},
    {"cn0_drop", FaultKind::kCn0Drop, true, false, true, "db", {0.0, 60.0}},
    {"generator_error", FaultKind::kGeneratorError, false, false, false, {}, {}, "text"},
    {"generator_refuses", FaultKind::kGeneratorRefuses, false, false, true, {}, {}, "command"},
    {"generator_unanswered", FaultKind::kGeneratorUnanswered, false, false, true, {}, {}, "command"},
    {"generator_dies", FaultKind::kGeneratorDies, false, false, true},
    {"pps_missing", FaultKind::kPpsMissing, false, false, false, "count", {1.0, 1e6}},
    {"pps_doubled", FaultKind::kPpsDoubled, false, false, false, "count", {1.0, 1e6}},
    {"pps_jump", FaultKind::kPpsJump, false, false, false, "by_s", {-1e6, 1e6}},
    {"pps_delay", FaultKind::kPpsDelay, false, false, false, "by_s", {0.0, 1.0}},
    {"samples_lost", FaultKind::kSamplesLost, true, false, false, "count", {1.0, 1e6}},
    {"samples_doubled", FaultKind::kSamplesDoubled, true, false, false, "count", {1.0, 1e6}},
    {"samples_swapped", FaultKind::kSamplesSwapped, true, false, false, "count", {1.0, 1e6}},
    {"bench_exit", FaultKind::kBenchExit, false, false, false},
}};

constexpr const FaultRule& rule_of(FaultKind kind) {
  return emulators::fault_rule_of(kFaultRules, kind);
}

struct Fault {
  FaultKind kind = FaultKind::kBenchExit;
  /// Generator time of the injection; empty: at once (before the run too).
  std::optional<fsw::Duration> time = std::nullopt;
  fsw::Duration duration = {};  ///< 0: until the end
  std::size_t vehicle = 0;
  std::size_t port = 0;   ///< 0: COM1
  double value = 0.0;     ///< number of rule_of(kind).value_key
  std::string text = {};  ///< text of rule_of(kind).text_key
};

/// Reads the keys time_s, kind, vehicle, port, duration_s, ... of a table and finishes it. Throws MissionError.
Fault read_fault(const mission::TableReader& section, const std::vector<std::string>& vehicles);

/// Reads one line of JSON with these keys. Throws MissionError.
Fault fault_from_json(const std::string& line, const std::vector<std::string>& vehicles);

// Scenario file of the emulator: all parameters of generator and receivers that do not come over the wires.

struct VehicleScenario {
  std::string name;
  std::size_t com_ports = 2;
  ReceiverSettings receiver;
};

struct Scenario {
  std::uint64_t seed = 1;
  Pace pace = Pace::kLockStep;
  double speed_factor = 1.0;                 ///< real time: generator time per time of the host's clock
  fsw::Duration engine_latency{40'000'000};  ///< real time: advance of the motion before the radio
  fsw::Duration join{165'000'000};           ///< value until a command sets it
  fsw::Duration start_shift;                 ///< the radiated scenario's time minus the commanded one (a fault)
  double pps_jitter_ns = 0.0;                ///< one sigma of each edge
  twins::gnss::ConstellationSettings constellation;
  SkySettings sky;
  std::vector<VehicleScenario> vehicles;
  ControlSettings control;
  std::vector<Fault> faults;

  [[nodiscard]] std::vector<std::string> vehicle_names() const;
};

/// Reads the file with the assignments "path=value" in place of its values. Throws MissionError.
Scenario read_scenario(const std::filesystem::path& file, const std::vector<std::string>& assignments);

}  // namespace vbar::grand::bench
