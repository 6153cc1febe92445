#pragma once
// Folder of a resumed run, and its exchange with that of the run that it continues. It grows in a folder beside
// that run, whose log is not touched until the other one is longer: a resume that is killed can be resumed.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/engine/controlled_wall_clock.h"
#include "host_sim/mission/mission.h"
#include "host_sim/report/provenance.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/run_record.h"
#include "host_sim/simulation/assembly.h"
#include "host_sim/twins/packet_log.h"

namespace vbar::app {

/// "<run folder>.resuming"
[[nodiscard]] std::filesystem::path resuming_folder(const std::filesystem::path& run_folder);

/// Completes what a killed resume left: a folder that was to take the place of the run does so if its packet log is the
/// longer one, else it is removed. Throws std::runtime_error.
void settle_earlier_resume(const std::filesystem::path& run_folder);

/// Puts resuming_folder() in the place of the run. Files in it that no run writes are kept. Whenever it is
/// interrupted, settle_earlier_resume() completes it. Throws std::runtime_error.
void replace_run(const std::filesystem::path& run_folder);

/// Removes resuming_folder(), if there is one.
void remove_resumed(const std::filesystem::path& run_folder);

// The provenance of a run by this program: what is written at its start and its end, and what a replay finds changed.

/// Returns the provenance at the start, with mission.toml not yet written.
[[nodiscard]] report::Provenance provenance_of(const mission::Mission& mission,
                                               const std::vector<std::string>& overrides,
                                               const std::string& mission_text);

/// The data files that this process has read so far.
[[nodiscard]] std::vector<report::FileDigest> data_read();

/// A sentence for each part of `then` that is another now: program, flight software, mission copy, data files.
[[nodiscard]] std::vector<std::string> changes_since(const report::Provenance& then,
                                                     const std::filesystem::path& mission_copy,
                                                     const std::string& flight_software_now);

// A flight that leaves a run folder: of `vbar run`, and of `vbar resume`.

/// The reason of a run that was stopped by a signal.
inline constexpr const char* kInterruption = "interrupted";

/// Request of a flight: the mission, and how it was given.
struct FlightOrder {
  const mission::Mission& mission;
  std::string mission_text;            ///< content of the copy in the run folder
  std::vector<std::string> overrides;  ///< "path=value", as given
  bool quiet = false;
  std::string branch = {};                                   ///< text of kBranchCopy; empty: the run is no branch
  twins::EventCheck check = {};                              ///< check of the events of the packet log; may be empty
  engine::ControlledWallClock::Requests pace_requests = {};  ///< may be empty
};

/// The mission with its sources started, if `start`: whatever cannot fly is refused before there is a run folder.
/// Throws Refused.
[[nodiscard]] std::unique_ptr<AssembledMission> assemble(const mission::Mission& mission, bool start);

/// Prints what is known before the first step: missing and predicted data, and a serial line whose rate cannot carry
/// the packets of that step.
void report_before_flight(const AssembledMission& assembled);

/// The record before the first step: what is known already.
[[nodiscard]] report::RunRecord record_at_start(const FlightOrder& order);

/// Flies into a folder that was made with the record, and leaves it there: whole, or with the reason why it is not.
/// That reason, or nothing.
[[nodiscard]] std::optional<std::string> fly_into(report::RunFolder& folder, const FlightOrder& order,
                                                  AssembledMission& assembled, report::RunRecord& record);

/// Writes the report into `folder`, if the mission keeps tables, and prints what is to be known of the run, whose
/// folder will be called `name`. `trouble`: what fly_into returned. Throws std::runtime_error if the report of a whole
/// record cannot be written.
void report_flight(const std::filesystem::path& folder, const std::filesystem::path& name, const FlightOrder& order,
                   const report::RunRecord& record, const std::optional<std::string>& trouble);

/// Exit code of the flight. Prints the verdict as the last line: on standard output, unless `quiet`, if the code is
/// kDone, otherwise as the reason why it is not. `name`: of its folder for the message.
int exit_code_of(const report::RunRecord& record, const std::optional<std::string>& trouble,
                 const std::filesystem::path& name, bool quiet);

}  // namespace vbar::app
