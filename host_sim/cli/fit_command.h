#pragma once
// vbar fit on the command line: an orbit fitted to the positions of a file, with the forces of a mission.

#include <CLI/CLI.hpp>

namespace vbar::app {

/// Adds the command; when it was chosen, `exit_code` is its exit code.
void add_fit_command(CLI::App& program, int& exit_code);

}  // namespace vbar::app
