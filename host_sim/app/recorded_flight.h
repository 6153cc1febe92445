#pragma once
// A flight that leaves a run folder: of `vbar run`, and of `vbar resume`.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/app/assemble.h"
#include "host_sim/mission/mission.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/run_record.h"
#include "host_sim/twins/packet_log.h"

namespace vbar::app {

/// The reason of a run that was stopped by a signal.
inline constexpr const char* kInterruption = "interrupted";

/// Request of a flight: the mission, and how it was given.
struct FlightOrder {
  const mission::Mission& mission;
  std::string mission_text;            ///< content of the copy in the run folder
  std::vector<std::string> overrides;  ///< "path=value", as given
  bool quiet = false;
  std::string branch = {};       ///< text of kBranchCopy; empty: the run is no branch
  twins::EventCheck check = {};  ///< check of the events of the packet log; may be empty
};

/// The mission with its sources started, if `start`: whatever cannot fly is refused before there is a run folder.
/// Throws Refused.
[[nodiscard]] std::unique_ptr<AssembledMission> assemble(const mission::Mission& mission, bool start);

/// Prints what the truth model states about missing and predicted data.
void report_data(const std::vector<std::string>& notes);

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
