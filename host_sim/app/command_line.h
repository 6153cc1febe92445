#pragma once
// Additions to CLI11: ranges in messages, and the option that was meant.

#include <cstdint>
#include <limits>
#include <string>

#include <CLI/CLI.hpp>

namespace vbar::app {

/// Accepts integers from `low` on (CLI11's own check prints the largest double as its upper limit).
[[nodiscard]] CLI::Validator integer_from(std::int64_t low);

/// Accepts finite numbers from `low` on.
[[nodiscard]] CLI::Validator number_from(double low);

/// Message for a command line that ended with CLI::ExtrasError: the argument without a place, and the nearest option.
[[nodiscard]] std::string unexpected_argument(const CLI::App& program);

}  // namespace vbar::app
