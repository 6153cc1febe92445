#pragma once
// vbar campaign run | status | report | rerun | worker on the command line.

#include <CLI/CLI.hpp>

namespace vbar::app {

/// Adds the command; when it was chosen, `exit_code` is its exit code.
void add_campaign_command(CLI::App& program, int& exit_code);

}  // namespace vbar::app
