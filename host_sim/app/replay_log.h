#pragma once
// Checks of a run's log before a replay feeds it to a flight computer.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/app/exit_codes.h"
#include "host_sim/report/run_record.h"
#include "host_sim/twins/packet_log.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::app {

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
