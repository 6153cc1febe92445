#include "host_sim/cli/command_line.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "host_sim/mission/name_search.h"

namespace vbar::app {
namespace {

constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();

template <class Number>
std::optional<Number> parsed(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// CLI11 prints a message of a validator behind the name of the option.
std::string refusal(const std::string& text, const std::string& accepted) {
  return fmt::format("found {}; accepted: {}", text, accepted);
}

/// The command that was parsed last, with the names of those around it.
std::pair<const CLI::App*, std::string> parsed_command(const CLI::App& program) {
  const CLI::App* command = &program;
  std::string name = "vbar";
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    name += " " + command->get_name();
  }
  return {command, name};
}

}  // namespace

CLI::Validator integer_from(std::int64_t low) {
  return {[low](std::string& text) {
            const auto value = parsed<std::int64_t>(text);
            return value && *value >= low ? std::string()
                                          : refusal(text, fmt::format("an integer from {} to {}", low, kLargest));
          },
          ""};
}

CLI::Validator number_from(double low) {
  return {[low](std::string& text) {
            const auto value = parsed<double>(text);
            return value && std::isfinite(*value) && *value >= low
                       ? std::string()
                       : refusal(text, fmt::format("a number from {}", low));
          },
          ""};
}

std::string unexpected_argument(const CLI::App& program) {
  const auto [command, name] = parsed_command(program);
  std::vector<std::string> extras = program.remaining(true);
  const auto option = std::ranges::find_if(extras, [](const std::string& word) { return word.starts_with('-'); });
  if (option == extras.end()) return fmt::format("{}: unexpected argument \"{}\"", name, extras.front());
  std::vector<std::string> known;
  for (const CLI::Option* one : command->get_options())
    for (const std::string& word : one->get_lnames()) known.push_back("--" + word);
  const std::string given = option->substr(0, option->find('='));
  return fmt::format("{}: there is no option {}{}; {} --help lists them", name, given,
                     mission::did_you_mean(given, {known.begin(), known.end()}), name);
}

}  // namespace vbar::app
