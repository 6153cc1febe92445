#pragma once
// vbar campaign run | status | report | rerun | worker on the command line.

#include <CLI/CLI.hpp>

#include "host_sim/campaign/case_flight.h"

namespace vbar::app {

/// Adds the command; when it was chosen, `exit_code` is its exit code. `command_line` executes a command line of vbar:
/// a flight of a campaign is one.
void add_campaign_command(CLI::App& program, int& exit_code, const campaign::CommandLine& command_line);

}  // namespace vbar::app
