#include <algorithm>
#include <memory>
#include <sstream>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "host_sim/cli/command_line.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/load.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/simulation/exit_codes.h"

namespace vbar::app {
namespace {

constexpr std::string_view kMissionArgument = "mission";

// Functions of both shells: @TABLE@ gives, for a command, its commands, its options, those with a value, and its first
// argument; _vbar_take takes a word before the cursor, in the variables of its caller.
constexpr std::string_view kFunctions = R"SCRIPT(_vbar_table() {
  case "$1" in
@TABLE@  esac
}
_vbar_take() {
  if [[ "$1" == -* ]]; then
    [[ " $vbar_valued " == *" $1 "* ]] && index=$((index + 1))
  elif [[ -z "$first" && " $vbar_commands " == *" $1 "* ]]; then
    command="${command:+$command }$1"
    _vbar_table "$command"
  elif [[ -z "$first" ]]; then
    first="$1"
  fi
}
)SCRIPT";

constexpr std::string_view kBash = R"SCRIPT(# Completion of vbar for bash, written by `vbar completion bash`.
@FUNCTIONS@
_vbar() {
  local program="${COMP_WORDS[0]}" current="${COMP_WORDS[COMP_CWORD]}" previous="${COMP_WORDS[COMP_CWORD - 1]}"
  local command="" first="" index vbar_commands vbar_options vbar_valued vbar_argument
  _vbar_table ""
  for ((index = 1; index < COMP_CWORD; ++index)); do
    _vbar_take "${COMP_WORDS[index]}"
    # "=" parts words here.
    while ((index + 1 < COMP_CWORD)) && [[ "${COMP_WORDS[index + 1]}" == "=" ]]; do index=$((index + 2)); done
  done
  COMPREPLY=()
  if [[ "$previous" == "--set" ]]; then
    compopt -o nospace 2>/dev/null
    COMPREPLY=($(compgen -W "$("$program" completion keys ${first:+"$first"} 2>/dev/null)" -- "$current"))
  elif [[ "$current" == -* ]]; then
    COMPREPLY=($(compgen -W "$vbar_options" -- "$current"))
  elif [[ "$previous" == "=" || "$current" == "=" ]]; then
    return 0
  elif [[ " $vbar_valued " == *" $previous "* ]]; then
    compopt -o filenames 2>/dev/null
    COMPREPLY=($(compgen -f -- "$current"))
  elif [[ -n "$vbar_commands" && -z "$first" ]]; then
    COMPREPLY=($(compgen -W "$vbar_commands" -- "$current"))
  else
    compopt -o filenames 2>/dev/null
    if [[ "$vbar_argument" == mission && -z "$first" ]]; then
      COMPREPLY=($(compgen -W "$("$program" completion missions 2>/dev/null)" -- "$current"))
    fi
    COMPREPLY+=($(compgen -f -- "$current"))
  fi
}
complete -F _vbar vbar
)SCRIPT";

constexpr std::string_view kZsh = R"SCRIPT(#compdef vbar
# Completion of vbar for zsh, written by `vbar completion zsh`.
@FUNCTIONS@
_vbar() {
  local program="${words[1]}" current="${words[CURRENT]}" previous="${words[CURRENT - 1]}"
  local command="" first="" index vbar_commands vbar_options vbar_valued vbar_argument
  _vbar_table ""
  for ((index = 2; index < CURRENT; ++index)); do
    _vbar_take "${words[index]}"
  done
  if [[ "$previous" == "--set" ]]; then
    compadd -S '' -- ${(f)"$("$program" completion keys ${first:+"$first"} 2>/dev/null)"}
  elif [[ "$current" == -* ]]; then
    compadd -- ${=vbar_options}
  elif [[ " $vbar_valued " == *" $previous "* ]]; then
    _files
  elif [[ -n "$vbar_commands" && -z "$first" ]]; then
    compadd -- ${=vbar_commands}
  else
    if [[ "$vbar_argument" == mission && -z "$first" ]]; then
      compadd -- ${(f)"$("$program" completion missions 2>/dev/null)"}
    fi
    _files
  fi
}
_vbar "$@"
)SCRIPT";

std::string filled(std::string_view text, std::string_view mark, std::string_view content) {
  const std::size_t at = text.find(mark);
  return fmt::format("{}{}{}", text.substr(0, at), content, text.substr(at + mark.size()));
}

/// The entry of a command, and those of its commands. `path`: "campaign run"; empty for the program.
void add_entries(const CLI::App& command, const std::string& path, std::string& table) {
  std::vector<std::string> commands, options, valued;
  std::string argument;
  for (const CLI::App* inner : command.get_subcommands([](const CLI::App*) { return true; }))
    commands.push_back(inner->get_name());
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_lnames().empty() && argument.empty()) argument = option->get_name();
    for (const std::string& name : option->get_lnames()) {
      options.push_back("--" + name);
      if (option->get_items_expected_max() > 0) valued.push_back("--" + name);
    }
  }
  table += fmt::format(
      "    \"{}\")\n      vbar_commands=\"{}\"\n      vbar_options=\"{}\"\n      vbar_valued=\"{}\"\n"
      "      vbar_argument=\"{}\" ;;\n",
      path, fmt::join(commands, " "), fmt::join(options, " "), fmt::join(valued, " "),
      argument == kMissionArgument ? argument : "");
  for (const CLI::App* inner : command.get_subcommands([](const CLI::App*) { return true; }))
    add_entries(*inner, path.empty() ? inner->get_name() : path + " " + inner->get_name(), table);
}

/// Elements of an array are set by a name or an index of their own, if at all.
bool is_settable(std::string_view path) {
  if (path.starts_with("waypoint.")) return true;
  std::istringstream parts{std::string(path)};
  for (std::string part; std::getline(parts, part, '.');)
    if (part.find_first_not_of("0123456789") == std::string::npos) return false;
  return true;
}

std::string mission_names() {
  std::string names;
  for (const std::filesystem::path& file : mission::mission_files(mission::missions_directory()))
    names += file.stem().string() + "\n";
  return names;
}

}  // namespace

std::string completion_script(const CLI::App& program, const std::string& shell) {
  std::string table;
  add_entries(program, "", table);
  return filled(shell == "zsh" ? kZsh : kBash, "@FUNCTIONS@", filled(kFunctions, "@TABLE@", table));
}

std::string settable_keys(const std::filesystem::path& mission) {
  // As --set takes them: the servicer's flight computer and sensors need no spacecraft.
  constexpr std::string_view kComputer = "spacecraft.servicer.flight_computer";
  constexpr std::string_view kSensors = "spacecraft.servicer.sensors.";
  std::string keys;
  try {
    const mission::Installation installation = sensors::installation();
    const auto all = mission::accepted_keys(mission::find_mission(mission, installation), {}, installation);
    // A table of the name of a sensor, as [navigation], is hidden by it where the mission does not have the table.
    const auto is_hidden = [&](const std::string& path) {
      const std::string sensor = std::string(kSensors) + path.substr(0, path.find('.'));
      return std::ranges::any_of(all, [&](const auto& table) { return table.first == sensor; });
    };
    for (const auto& [path, accepted] : all) {
      if (!is_settable(path) || path.empty() || is_hidden(path)) continue;
      for (const mission::AcceptedKey& key : accepted) {
        if (key.accepted == mission::kTable) continue;
        keys += fmt::format("{}.{}=\n", path, key.name);
        if (path == kComputer) keys += fmt::format("flight_computer.{}=\n", key.name);
        if (path.starts_with(kSensors)) keys += fmt::format("{}.{}=\n", path.substr(kSensors.size()), key.name);
      }
    }
  } catch (const mission::MissionError&) {  // while it is being typed
  }
  return keys;
}

void add_completion_command(CLI::App& program, int& exit_code) {
  const auto what = std::make_shared<std::string>();
  const auto mission = std::make_shared<std::filesystem::path>();
  CLI::App* command = program.add_subcommand("completion", "print the completion script of a shell");
  command->footer(
      "bash: source <(vbar completion bash)\nzsh: vbar completion zsh > _vbar, in a folder of fpath\n"
      "An installation has both in its places.");
  command->add_option("what", *what, "bash or zsh; for these scripts: missions, or keys of a mission")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "missions", "keys"}));
  command->add_option("of", *mission, "keys: mission file, or a name that vbar missions lists");
  command->callback([what, mission, &program, &exit_code] {
    fmt::print("{}", *what == "missions" ? mission_names()
                     : *what == "keys"   ? settable_keys(*mission)
                                         : completion_script(program, *what));
    exit_code = kDone;
  });
}

}  // namespace vbar::app
