#pragma once
// A snapshot of the flight software in a file: a line of text that names the step after it, then the bytes of
// vbar_gnc_save.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/report/run_record.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/twins/packet_log.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::app {

struct Snapshot {
  std::uint32_t next_step = 0;  ///< number of the step after it
  std::vector<std::uint8_t> bytes;
};

/// Throws std::runtime_error.
void write_snapshot(const std::filesystem::path& file, const Snapshot& snapshot);

/// Throws Refused if the file cannot be read, is not a snapshot or is not whole. Its content is checked by the flight
/// software.
[[nodiscard]] Snapshot read_snapshot(const std::filesystem::path& file);

// Checks of a run's log before a replay feeds it to a flight computer.

struct Verdict {
  ExitCode code = kDone;
  std::string sentence;
};

struct RecordedStep {
  std::vector<twins::PacketRecord> inputs;
  std::vector<pil::Packet> outputs;
};

using RecordedSteps = std::map<std::uint32_t, RecordedStep>;

[[nodiscard]] RecordedSteps steps_of(const twins::PacketLog& log);

/// Whether the run wrote its summary at its end, complete or not; one that was killed did not.
[[nodiscard]] bool has_ended(const report::Summary& summary);

/// Returns why the log is not that of the run or lacks a part of it; empty if it is whole.
[[nodiscard]] std::optional<Verdict> verdict_on_log(const std::filesystem::path& file, const twins::PacketLog& log,
                                                    const RecordedSteps& steps, const report::Summary& summary);

}  // namespace vbar::app
