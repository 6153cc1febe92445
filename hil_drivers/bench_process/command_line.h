#pragma once
// Command line of a program that a mission names, started without a shell.

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace vbar::bench_process {

/// Word in braces and its value: {"{seed}", "1"}.
using Replacement = std::pair<std::string_view, std::string>;

/// Returns the words of a command line, separated by spaces, with replacements made in each. A program without a slash
/// is searched beside this program, so that a build need not be installed, and otherwise left to PATH. Empty for a
/// command line without a word.
[[nodiscard]] std::vector<std::string> arguments_of(const std::string& command_line,
                                                    std::span<const Replacement> replacements);

}  // namespace vbar::bench_process
