#pragma once
// Errors of a program on its standard error, one line each: names, paths and values of foreign origin that a message
// quotes act upon no terminal and look like no second message.

#include <string>
#include <string_view>

namespace vbar::files {

/// Prints "program: message" without control characters. Standard error may be closed or full.
void print_error(std::string_view program, std::string_view message);

/// Returns the text of an error in a command line, likewise.
[[nodiscard]] std::string parse_error_text(std::string_view message);

/// Lets a parser of command lines, a CLI::App, print its errors by parse_error_text().
template <class Parser>
void print_parse_errors_by_line(Parser& parser) {
  parser.failure_message([](const auto* /*command*/, const auto& error) { return parse_error_text(error.what()); });
}

}  // namespace vbar::files
