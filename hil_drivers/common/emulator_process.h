#pragma once
// Command line of a program that a mission names, started without a shell.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "hil_drivers/wire/emulator_files.h"
#include "host_sim/io/child_process.h"
#include "host_sim/report/provenance.h"

namespace vbar::testbeds {

/// Word in braces and its value: {"{seed}", "1"}.
using Replacement = std::pair<std::string_view, std::string>;

/// Returns the words of a command line, separated by spaces, with replacements made in each. A program without a slash
/// is searched beside this program, so that a build need not be installed, and otherwise left to PATH. Empty for a
/// command line without a word.
[[nodiscard]] std::vector<std::string> arguments_of(const std::string& command_line,
                                                    std::span<const Replacement> replacements);

// Emulator of a testbed as a child process of the run, in a directory of its own that is removed with the process. Once
// the emulator listens it writes its addresses to addresses.json, whose form is the testbed's.

/// Returns the number of faults that have taken effect, by their kind; lines of another form count as "unknown". Empty
/// without the file.
[[nodiscard]] std::map<std::string, int> count_faults(const std::filesystem::path& file);

/// Returns the numbers of an emulator's counters by name; anything else in the file is left out. Empty without the
/// file.
[[nodiscard]] std::map<std::string, double> read_counters(const std::filesystem::path& file);

/// Returns the words of a command line, separated by spaces; {directory}, {seed} and {data} are replaced in each.
[[nodiscard]] std::vector<std::string> emulator_arguments(const std::string& command_line,
                                                          const std::filesystem::path& directory, std::uint64_t seed,
                                                          const std::filesystem::path& data_directory);

class EmulatorProcess {
 public:
  /// Starts the emulator and waits until it has written its addresses. A program without a slash is searched beside
  /// this program, then in PATH. Throws std::runtime_error, one sentence, if it does not start.
  EmulatorProcess(const std::string& command_line, std::uint64_t seed, const std::filesystem::path& data_directory);
  ~EmulatorProcess();
  EmulatorProcess(const EmulatorProcess&) = delete;
  EmulatorProcess& operator=(const EmulatorProcess&) = delete;

  /// File of the addresses; valid until stop().
  [[nodiscard]] std::filesystem::path addresses_file() const { return directory_ / wire::kAddressesFile; }
  [[nodiscard]] const std::filesystem::path& directory() const { return directory_; }
  /// Digests of the program and of every file named by its arguments.
  [[nodiscard]] const std::vector<report::FileDigest>& files() const { return files_; }

  /// Number of the scenario's faults that have taken effect, by kind; after stop().
  [[nodiscard]] const std::map<std::string, int>& faults() const { return faults_; }

  /// What the emulator counted, by name; after stop(). Empty if it did not end in order.
  [[nodiscard]] const std::map<std::string, double>& counters() const { return counters_; }

  /// Returns how the process has ended and its last words, if it has ended or ends within `patience`.
  [[nodiscard]] std::optional<std::string> end_report(std::chrono::milliseconds patience = {});

  /// Calls `on_end` from another thread if the process ends before stop(): devices that wait for an answer of it are
  /// to wait no longer.
  void watch(std::function<void()> on_end);
  /// Ends that thread, so that what it would stop can be closed.
  void end_watch() noexcept { watch_ = {}; }

  /// Ends the process and removes the directory.
  void stop() noexcept;

 private:
  [[nodiscard]] std::string last_words() const;
  void wait_for_addresses();

  std::filesystem::path directory_;
  std::vector<std::string> arguments_;
  std::vector<report::FileDigest> files_;
  std::optional<io::ChildProcess> process_;
  std::map<std::string, int> faults_;
  std::map<std::string, double> counters_;
  std::jthread watch_;  // last: it uses the process
};

// File of the calibration that a mission names for its testbed.

/// Command that makes a calibration of a testbed.
struct CalibrationCommand {
  std::string_view testbed;  ///< table of the mission: "testbed.tron"
  std::string command;  ///< with {N} for the seed and {out} for the file or its folder: of the emulated bench or of the
                        ///< hardware
  std::string_view duration;
};

/// Returns `path` with {data} and {seed} replaced: relative to the working directory or, if there is no such file, to
/// the data folder, which has the calibration of the emulated TRON for seed 1. Throws a MissionError with the command
/// that makes the file if it is in neither.
[[nodiscard]] std::filesystem::path find_calibration_file(const std::string& path,
                                                          const std::filesystem::path& data_directory,
                                                          std::uint64_t seed, const CalibrationCommand& made_by);

}  // namespace vbar::testbeds
