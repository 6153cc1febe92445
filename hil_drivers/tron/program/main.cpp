// vbar_tron, also called as "vbar tron": what a robotic bench needs besides the runs of vbar.

#include <cstdio>
#include <exception>
#include <string_view>

#include <CLI/CLI.hpp>

#include "hil_drivers/testbeds.h"
#include "hil_drivers/tron/program/commands.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/simulation/exit_codes.h"

namespace {

/// One line for each command.
void add_commands(CLI::App& program, int& exit_code) {
  vbar::tron::add_plan_command(program, exit_code);
#ifdef VBAR_TRON_CALIBRATION
  vbar::tron::add_calibrate_commands(program, exit_code);
#endif
}

int complain(std::string_view what, int exit_code) {
  std::fflush(stdout);
  vbar::files::print_error("vbar tron", what);
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  vbar::testbeds::install(vbar::testbeds::drivers());
  CLI::App program{"Planning and calibration of a robotic testbed (TRON)", "vbar tron"};
  program.require_subcommand(1);
  vbar::files::print_parse_errors_by_line(program);
  int exit_code = vbar::app::kDone;
  add_commands(program, exit_code);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? vbar::app::kDone : vbar::app::kRefused;
  } catch (const vbar::mission::MissionError& error) {
    return complain(error.what(), vbar::app::kRefused);
  } catch (const vbar::app::Refused& error) {
    return complain(error.what(), vbar::app::kRefused);
  } catch (const std::exception& error) {
    return complain(error.what(), vbar::app::kFailed);
  }
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
  return complain("standard output cannot be written", vbar::app::kFailed);
}
