// vbar: flies missions, replays their packets, reports on runs.

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/core.h>

#include "hil_drivers/external/serve_command.h"
#include "hil_drivers/testbeds.h"
#include "host_sim/cli/build_info.h"
#include "host_sim/cli/command_line.h"
#include "host_sim/cli/commands.h"
#include "host_sim/files/own_program.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/mission/mission_error.h"
#include "host_sim/mission/name_search.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/simulation/exit_codes.h"

namespace {

using namespace vbar::app;

constexpr const char* kSetHelp =
    "a key of the mission file and its value, e.g. flight_computer.target=zynq_qemu; may be given again";
constexpr const char* kMissionHelp = "mission file (TOML), or a name that vbar missions lists";
constexpr const char* kQuietHelp = "print nothing but errors";

/// One assignment for each --set, so that it never takes the mission for another.
void add_set(CLI::App* command, std::vector<std::string>& overrides) {
  command->add_option("--set", overrides, kSetHelp)->allow_extra_args(false);
}

void add_resume(CLI::App& command, ResumeOptions& resume) {
  command.add_option("run", resume.run_folder, "run folder")->required();
  CLI::Option* at = command.add_option(
      "--at", resume.branch_at_h, "leave the run as it is, and fly a branch of it from this hour of the mission on");
  add_set(&command, resume.overrides);
  CLI::Option* set = command.get_option("--set")->needs(at);
  at->needs(set)->check(number_from(0.0));
  command
      .add_option("--out", resume.out,
                  "folder of the branch; by default runs/<mission>-<seed>, the next run .2, .3, ...")
      ->needs(at);
  command.add_flag("--trust", resume.trust, "use a library, device or address that the run folder names");
  command.add_flag("--quiet", resume.quiet, kQuietHelp);
}

void add_stars(CLI::App& command, StarsOptions& stars) {
  command.add_option("image", stars.images, "images of stars: PGM or TIFF, one grey value a pixel")->required();
  command.add_option("--focal-length-px", stars.focal_length_px, "focal length over the pitch of the pixels, to 0.5 %")
      ->required()
      ->check(number_from(1.0));
  command
      .add_option("--search-percent", stars.search_percent,
                  "try focal lengths that differ by up to this from the given one")
      ->check(CLI::Range(0.0, 20.0));
  command.add_option("--principal-point-px", stars.principal_point_px, "x and y; middle of the image unless given")
      ->expected(2);
  command.add_option("--distortion", stars.distortion, "Brown-Conrady k1 k2 p1 p2 k3; 0 unless given")->expected(5);
  command
      .add_option("--centroid-floor-px", stars.centroid_floor_px,
                  "error of centroids and lens beside that by noise, 1 sigma (0.3)")
      ->check(CLI::Range(0.01, 10.0));
  command.add_option("--detection-sigmas", stars.detection_sigmas, "threshold of an object, sigmas of noise (5)")
      ->check(CLI::Range(2.0, 30.0));
  command.add_option("--utc", stars.utc,
                     "time of the images, for aberration by the Earth's motion: without, up to 20.5 "
                     "arcsec of the attitude");
  command.add_flag("--calibrate", stars.calibrate, "fit focal length and distortion to the stars of all images");
  command.add_option("--csv", stars.table, "file for the stars: pixel, Hipparcos number, residual");
}

constexpr const char* kOtherProgramsHelp =
    "vbar NAME runs the program vbar_NAME beside it with the arguments after NAME, e.g. vbar tron plan.";

/// Runs the program of the name of a first word that is not a command; it replaces this one. Returns a message if there
/// is no such program; empty if the word is a command, or an option.
std::string unknown_command(const CLI::App& program, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return {};
  std::vector<std::string_view> names;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == argv[1]) return {};
    names.push_back(command->get_name());
  }
  if (const std::filesystem::path other = vbar::files::program_beside(argv[1]); !other.empty())
    return vbar::files::become(other, {argv + 2, argv + argc});
  const auto nearest = vbar::mission::nearest_name(argv[1], names);
  return fmt::format("there is no command \"{}\"{}; vbar --help lists them", argv[1],
                     nearest ? fmt::format(", did you mean {}?", *nearest) : "");
}

int complain(std::string_view what, int exit_code) {
  std::fflush(stdout);
  vbar::files::print_error("vbar", what);
  return exit_code;
}

/// A descriptor 0, 1 or 2 that this program was started without would be that of the next file that it opens.
void open_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(descriptor, F_GETFD) < 0 && open("/dev/null", O_RDWR) < 0) _exit(kFailed);  // it takes the lowest one
}

/// The lines of a run stay in the buffer until its end, when they are written to a file or a pipe: one that takes none
/// of them ends no flight.
void keep_output_until_end() {
  static std::array<char, 1 << 20> buffer;
  if (isatty(STDOUT_FILENO) != 1) static_cast<void>(std::setvbuf(stdout, buffer.data(), _IOFBF, buffer.size()));
}

/// The exit code of a command whose output was not written: its own if it leaves a folder, for which it was called.
int after_output(const CLI::App& program, int result) {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return result;
  const std::string reason = errno != 0 ? ": " + std::generic_category().message(errno) : "";
  const std::vector<CLI::App*> commands = program.get_subcommands();
  const auto leaves_folder = [](const CLI::App* command) {
    const std::string name = command->get_name();
    return name == "run" || name == "resume" || name == "propagate" || name == "fit" || name == "verify" ||
           (name == "campaign" && command->got_subcommand("run"));
  };
  if (!std::ranges::any_of(commands, leaves_folder))
    return complain("standard output cannot be written" + reason, result == kDone ? kFailed : result);
  return complain(fmt::format("standard output cannot be written{}; the exit code is that of the {}, whose folder is "
                              "not concerned",
                              reason, commands.front()->get_name()),
                  result);
}

/// Parses the command line; the command runs as its callback.
int parse_and_run(CLI::App& program, int argc, char** argv, const int& exit_code) {
  if (const std::string message = unknown_command(program, argc, argv); !message.empty())
    return complain(message, kRefused);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ExtrasError&) {
    return complain(unexpected_argument(program), kRefused);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? kDone : kRefused;
  } catch (const vbar::testbeds::DriverElsewhere& elsewhere) {
    return complain(vbar::files::become(elsewhere.program, {argv + 1, argv + argc}), kFailed);
  } catch (const vbar::mission::MissionError& error) {
    return complain(error.what(), kRefused);
  } catch (const vbar::report::FolderRefused& error) {
    return complain(error.what(), kRefused);
  } catch (const Refused& error) {
    return complain(error.what(), kRefused);
  } catch (const std::exception& error) {
    return complain(error.what(), kFailed);
  }
  return exit_code;
}

int execute(int argc, char** argv);

/// A command line without the program's name, in this process.
int execute_line(std::vector<std::string> arguments) {
  std::string name = "vbar";
  std::vector<char*> argv{name.data()};
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  return execute(static_cast<int>(argv.size()) - 1, argv.data());
}

int execute(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "help") {
    std::string help = "--help";
    std::vector<char*> command(argv, argv + argc);
    command.erase(command.begin() + 1);
    command.insert(command.end(), {help.data(), nullptr});
    return execute(argc, command.data());
  }
  CLI::App program{"Flight-software harness for spacecraft rendezvous and formation flying"};
  program.require_subcommand(1);
  vbar::files::print_parse_errors_by_line(program);
  program.footer(fmt::format("{}\n\n{}", kOtherProgramsHelp, kExitCodeHelp));
  program.set_version_flag("--version", fmt::format("vbar {}, commit {}, {}, {}", build_version(), kBuildCommit,
                                                    build_compiler(), build_type()));
  int exit_code = kDone;

  RunOptions run;
  std::int64_t seed = 0;
  CLI::App* run_app = program.add_subcommand("run", "fly a mission and leave a run folder");
  run_app->add_option("mission", run.mission, kMissionHelp)->required();
  const CLI::Option* seed_option =
      run_app->add_option("--seed", seed, "seed of every random stream (mission.seed)")->check(integer_from(0));
  run_app->add_option("--out", run.out, "run folder; by default runs/<mission>-<seed>, the next run .2, .3, ...");
  run_app->add_flag("--force", run.force, "replace the run that the folder of --out holds");
  run_app->add_flag("--check", run.check, "check the mission file and fly nothing");
  run_app->add_flag("--quiet", run.quiet, kQuietHelp);
  run_app->add_flag("--view", run.view, "serve the page of the run on 127.0.0.1 while it goes on (vbar watch)");
  run_app->add_flag("--view-control", run.view_control,
                    "as --view, and the page may pause the run, step it and set its speed (clock.mode = real_time)");
  add_set(run_app, run.overrides);
  run_app->callback([&] {
    if (*seed_option) run.overrides.push_back("mission.seed=" + std::to_string(seed));
    exit_code = run_command(run);
  });

  PropagateOptions propagate;
  CLI::App* propagate_app = program.add_subcommand(
      "propagate", "fly a mission's spacecraft without flight software and leave their ephemerides");
  propagate_app->add_option("mission", propagate.mission, kMissionHelp)->required();
  propagate_app->add_option("--out", propagate.out, "folder; runs/<mission>-truth unless given");
  propagate_app->add_flag("--oem", propagate.oem, "write CCSDS orbit ephemeris messages as well");
  propagate_app->add_flag("--quiet", propagate.quiet, kQuietHelp);
  add_set(propagate_app, propagate.overrides);
  propagate_app->callback([&] { exit_code = propagate_command(propagate); });

  add_fit_command(program, exit_code);

  ReplayOptions replay;
  CLI::App* replay_app =
      program.add_subcommand("replay", "feed a run's packets to a flight computer; are the outputs the same bits?");
  replay_app->add_option("run", replay.run_folder, "run folder")->required();
  replay_app->add_flag("--trust", replay.trust, "use a library, device or address that the run folder names");
  replay_app->add_flag("--quiet", replay.quiet, kQuietHelp);
  CLI::Option* save =
      replay_app->add_option("--save", replay.save, "write a snapshot of the flight software to a file");
  replay_app->add_option("--at-h", replay.save_at_h, "with --save: after the last step until this hour of the mission")
      ->needs(save)
      ->check(number_from(0.0));
  replay_app->add_option("--from", replay.from, "continue from a snapshot, at the step after it");
  add_set(replay_app, replay.overrides);
  replay_app->callback([&] { exit_code = replay_command(replay); });

  ResumeOptions resume;
  CLI::App* resume_app = program.add_subcommand(
      "resume", "continue a run that was killed or interrupted: fly it again, compare it with its log, and go on");
  add_resume(*resume_app, resume);
  resume_app->callback([&] { exit_code = resume_command(resume); });

  ReportOptions report;
  CLI::App* report_app = program.add_subcommand("report", "write the report of a run, or of several side by side");
  report_app->add_option("run", report.run_folders, "run folders")->required();
  report_app->add_option("--out", report.out,
                         "file of the comparison; comparison.html beside the first run unless given");
  report_app->add_flag("--fail-if-different", report.fail_if_different,
                       "exit code 3 unless all runs gave the same outputs as the first");
  report_app->callback([&] { exit_code = report_command(report); });

  ViewOptions view;
  CLI::App* view_app = program.add_subcommand(
      "view",
      "write the page on which a run is watched: scene, plots and tables over time; more runs are drawn beside it");
  view_app->add_option("run", view.run_folders, "run folders, or the folder of one propagation")->required();
  view_app->add_option("--out", view.out,
                       "file of the page; view.html in the run folder, or beside the first of several, unless given");
  view_app->callback([&] { exit_code = view_command(view); });

  CheckOptions check;
  CLI::App* check_app = program.add_subcommand("check", "judge runs by the limits of their mission, for a CI");
  check_app->add_option("run", check.run_folders, "run folders")->required();
  CLI::Option* limits = check_app->add_option(
      "--limits", check.limits, "mission file whose [[limit]] tables hold in place of those of the runs' own missions");
  CLI::Option* junit = check_app->add_option("--junit", check.junit, "file for the results as JUnit XML");
  check_app->add_flag("--numbers", check.numbers, "only print the numbers that a limit can name")
      ->excludes(limits)
      ->excludes(junit);
  check_app->callback([&] { exit_code = check_command(check); });

  add_campaign_command(program, exit_code, execute_line);
  add_verify_command(program, exit_code, execute_line);

  std::filesystem::path missions;
  CLI::App* missions_app = program.add_subcommand("missions", "what can be run, one line each");
  missions_app->add_option("mission", missions, "folder of mission files, or one mission by its name or file");
  missions_app->callback([&] { exit_code = missions_command(missions); });

  std::string key_word;
  bool key_page = false;
  CLI::App* keys_app = program.add_subcommand("keys", "keys of mission files: what is accepted, defaults, meaning");
  CLI::Option* word_option = keys_app->add_option("word", key_word, "word of a key, of its table or of its meaning");
  keys_app->add_flag("--markdown", key_page, "all of them, as docs/keys.md")->excludes(word_option);
  keys_app->callback([&] { exit_code = keys_command(key_word, key_page); });

  std::string column_word;
  bool column_page = false;
  CLI::App* columns_app = program.add_subcommand("columns", "columns of the tables of a run: names and meaning");
  CLI::Option* column_option = columns_app->add_option("word", column_word, "word of a table, a column or its meaning");
  columns_app->add_flag("--markdown", column_page, "all of them, as docs/tables.md")->excludes(column_option);
  columns_app->callback([&] { exit_code = columns_command(column_word, column_page); });

  std::vector<std::string> explained;
  bool word_page = false;
  CLI::App* explain_app =
      program.add_subcommand("explain", "words that a run prints: faults, counts, verdicts, codes of tables");
  CLI::Option* explained_option = explain_app->add_option("word", explained, "one of them; all are listed without it");
  explain_app->add_flag("--markdown", word_page, "all of them, as docs/words.md")->excludes(explained_option);
  explain_app->callback([&] { exit_code = explain_command(explained, word_page); });

  StarsOptions stars;
  CLI::App* stars_app = program.add_subcommand(
      "stars", "attitude of a camera by its images of stars, and its focal length and distortion");
  add_stars(*stars_app, stars);
  stars_app->callback([&] { exit_code = stars_command(stars); });

  NewArticleOptions article;
  CLI::App* article_app = program.add_subcommand("new-article", "create a project of your own flight software");
  article_app->add_option("folder", article.folder, "created; its name is that of the flight software")->required();
  article_app->add_option("--language", article.language, "c or c++ (default c)");
  article_app->callback([&] { exit_code = new_article_command(article); });

  vbar::external::ServeOptions serve;
  CLI::App* serve_app = program.add_subcommand(
      "serve",
      "be a digital sensor, or the truth, of a run that has it as testbed.external (docs/external_sources.md)");
  serve_app->add_option("mission", serve.mission, kMissionHelp)->required();
  serve_app->add_option("--stream", serve.stream, "descriptor of the line, inherited")->check(integer_from(0));
  add_set(serve_app, serve.overrides);
  serve_app->callback([&] { exit_code = vbar::external::serve_command(serve, build_version()); });

  add_completion_command(program, exit_code);

  const int result = parse_and_run(program, argc, argv, exit_code);
  return after_output(program, result);
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_descriptors();
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on the size of files is an error with a sentence, like a full disk
  keep_output_until_end();
  vbar::testbeds::install(vbar::testbeds::drivers());
  return execute(argc, argv);
}
