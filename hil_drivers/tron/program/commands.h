#pragma once
// Commands of vbar tron.

namespace CLI {
class App;
}

namespace vbar::tron {

/// Adds `vbar tron plan`, which of a mission's images a testbed can show, for each face by which it may hold the
/// target; it sets `exit_code` when it has run.
void add_plan_command(CLI::App& program, int& exit_code);

/// Adds `vbar tron calibrate`, which measures a testbed and writes its calibration, and `vbar tron check`, whether a
/// calibration is still valid; they set `exit_code` when they have run.
void add_calibrate_commands(CLI::App& program, int& exit_code);

}  // namespace vbar::tron
