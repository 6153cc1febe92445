#pragma once
// vbar completion: command lines completed by a shell.

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

namespace vbar::app {

/// The command; it reads the commands and options of `program`, which all have to be there when it runs.
void add_completion_command(CLI::App& program, int& exit_code);

/// The script for a shell, "bash" or "zsh": commands and options as `program` defines them. Missions, and keys after
/// --set, are those of the program when it is asked for them.
[[nodiscard]] std::string completion_script(const CLI::App& program, const std::string& shell);

/// Returns what --set accepts for a mission, one assignment "path=" a line; empty if there is no such mission.
[[nodiscard]] std::string settable_keys(const std::filesystem::path& mission);

}  // namespace vbar::app
