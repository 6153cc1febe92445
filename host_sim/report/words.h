#pragma once
// The numbers of telemetry (fsw/packets/vbar.lcm, fsw/core/result.h) in words.

#include <string>
#include <vector>

#include "host_sim/report/summary.h"

namespace vbar::report {

[[nodiscard]] std::string mode_name(int mode);
[[nodiscard]] std::string solver_name(int solver);  ///< -1: "none"
/// The control solvers of the flight software, in the order of vbar.lcm.
[[nodiscard]] std::vector<int> solvers();
[[nodiscard]] std::string status_name(int status);
[[nodiscard]] std::string sighting_name(int status);       ///< fsw/vision/target_tracking/angles_only_tracking.h
[[nodiscard]] std::string pose_sighting_name(int status);  ///< fsw/vision/pose/spacecraft_pose_network.h

// Name of the loop of a run: software, processor or hardware in the loop.

/// "SIL, in process", "PIL, emulated Zynq", "HIL, emulated bench", "HIL, hardware bench, board".
[[nodiscard]] std::string loop_name(const Summary& summary);

/// Names of the testbeds of the run that were emulated.
[[nodiscard]] std::vector<std::string> emulated_testbeds(const Summary& summary);

// Every word that terminal, tables and page print for a code, a fault, a count of the flight software or a verdict,
// with its explanation. Codes and counts are explained by the comments of fsw/packets/vbar.lcm, the response to a fault
// by fsw/faults/fault_table.h, verdicts by verdict.cpp.

struct ExplainedWord {
  std::string word;      ///< "navigation_timeout"
  std::string quantity;  ///< quantity that has this value: "fault", "mode", "count", "verdict"
  std::string owner;     ///< message that defines it; empty of verdicts
  std::string meaning;   ///< and what raises it
  std::string response;  ///< response of the flight software, for faults only
  std::string turn;      ///< what a user can change, or empty
};

/// Quantity by quantity: faults first, then counts, verdicts and the other codes.
[[nodiscard]] std::vector<ExplainedWord> explained_words();

}  // namespace vbar::report
