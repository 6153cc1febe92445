#pragma once
// vbar tron plan: which of a mission's images a testbed can show, for each face by which it may hold the target.

namespace CLI {
class App;
}

namespace vbar::tron {

/// Adds the command to the program; it sets `exit_code` when it has run.
void add_plan_command(CLI::App& program, int& exit_code);

}  // namespace vbar::tron

// vbar tron calibrate: measures a testbed and writes its calibration. vbar tron check: measures whether a calibration
// is still valid.

namespace CLI {}

namespace vbar::tron {

/// Adds both commands to the program; they set `exit_code` when they have run.
void add_calibrate_commands(CLI::App& program, int& exit_code);

}  // namespace vbar::tron
