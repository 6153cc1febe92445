#pragma once
// vbar tron calibrate: measures a testbed and writes its calibration. vbar tron check: measures whether a calibration
// is still valid.

namespace CLI {
class App;
}

namespace vbar::tron {

/// Adds both commands to the program; they set `exit_code` when they have run.
void add_calibrate_commands(CLI::App& program, int& exit_code);

}  // namespace vbar::tron
