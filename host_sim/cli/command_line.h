#pragma once
// Additions to CLI11: ranges in messages, and the option that was meant.

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

#include <CLI/CLI.hpp>

#include "host_sim/campaign/worker.h"

namespace vbar::app {

/// Accepts integers from `low` on (CLI11's own check prints the largest double as its upper limit).
[[nodiscard]] CLI::Validator integer_from(std::int64_t low);

/// Accepts finite numbers from `low` on.
[[nodiscard]] CLI::Validator number_from(double low);

/// Message for a command line that ended with CLI::ExtrasError: the argument without a place, and the nearest option.
[[nodiscard]] std::string unexpected_argument(const CLI::App& program);

// vbar campaign run | status | report | rerun | export | import | worker on the command line.

/// Adds the command; when it was chosen, `exit_code` is its exit code. `command_line` executes a command line of vbar:
/// a flight of a campaign is one.
void add_campaign_command(CLI::App& program, int& exit_code, const campaign::CommandLine& command_line);

// vbar verify on the command line: rows of missions/verification are campaigns.

/// Adds the command, as above.
void add_verify_command(CLI::App& program, int& exit_code, const campaign::CommandLine& command_line);

// vbar completion: command lines completed by a shell.

/// The command; it reads the commands and options of `program`, which all have to be there when it runs.
void add_completion_command(CLI::App& program, int& exit_code);

/// The script for a shell, "bash" or "zsh": commands and options as `program` defines them. Missions, and keys after
/// --set, are those of the program when it is asked for them.
[[nodiscard]] std::string completion_script(const CLI::App& program, const std::string& shell);

/// Returns what --set accepts for a mission, one assignment "path=" a line; empty if there is no such mission.
[[nodiscard]] std::string settable_keys(const std::filesystem::path& mission);

}  // namespace vbar::app
