#pragma once
// vbar verify: flies rows of the verification and leaves verification.json.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign/worker.h"
#include "host_sim/verification/record.h"

namespace vbar::verification {

struct Request {
  std::filesystem::path missions;    ///< folder of the rows
  std::filesystem::path to;          ///< folder of their campaigns and of verification.json
  std::vector<std::string> names;    ///< rows or folders of rows; none: all but the sample
  std::optional<double> budget_min;  ///< wall clock; none: every seed
  int jobs = 0;                      ///< flights at once; 0: as there are processors
  bool trust = false;                ///< as of campaign::RunRequest
  bool quiet = false;
  campaign::Build build;
  std::function<bool()> stop_requested;
  campaign::CommandLine command_line;
};

/// Returns kDone if the seeds that the budget allows were flown and meet all requirements of their rows, kFailed if a
/// requirement is not met or a row cannot be flown, kInterrupted after a signal. Rows that were flown in part are
/// continued. Throws app::Refused before anything is flown.
[[nodiscard]] int verify(const Request& request);

/// Returns the rows, a line for each: expected processor minutes, requirements, seeds, name and description.
[[nodiscard]] std::string list_of(std::vector<Row> rows);

}  // namespace vbar::verification
