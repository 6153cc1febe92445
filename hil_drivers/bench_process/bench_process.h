#pragma once
// Emulator of a testbed as a child process of the run, in a directory of its own that is removed with the process. Once
// the emulator listens it writes its addresses to addresses.json, whose form is the testbed's.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/io/child_process.h"
#include "host_sim/report/provenance.h"

namespace vbar::bench_process {

inline constexpr const char* kAddressesFile = "addresses.json";

/// File of the faults that the emulator acknowledges, a line each.
inline constexpr const char* kFaultsFile = "faults.jsonl";

/// Returns the number of faults that have taken effect, by their kind; lines of another form count as "unknown". Empty
/// without the file.
[[nodiscard]] std::map<std::string, int> count_faults(const std::filesystem::path& file);

/// Returns the words of a command line, separated by spaces; {directory}, {seed} and {data} are replaced in each.
[[nodiscard]] std::vector<std::string> bench_arguments(const std::string& command_line,
                                                       const std::filesystem::path& directory, std::uint64_t seed,
                                                       const std::filesystem::path& data_directory);

class BenchProcess {
 public:
  /// Starts the emulator and waits until it has written its addresses. A program without a slash is searched beside
  /// this program, then in PATH. Throws std::runtime_error, one sentence, if it does not start.
  BenchProcess(const std::string& command_line, std::uint64_t seed, const std::filesystem::path& data_directory);
  ~BenchProcess();
  BenchProcess(const BenchProcess&) = delete;
  BenchProcess& operator=(const BenchProcess&) = delete;

  /// File of the addresses; valid until stop().
  [[nodiscard]] std::filesystem::path addresses_file() const { return directory_ / kAddressesFile; }
  [[nodiscard]] const std::filesystem::path& directory() const { return directory_; }
  /// Digests of the program and of every file named by its arguments.
  [[nodiscard]] const std::vector<report::FileDigest>& files() const { return files_; }

  /// Number of the scenario's faults that have taken effect, by kind; after stop().
  [[nodiscard]] const std::map<std::string, int>& faults() const { return faults_; }

  /// Returns how the process has ended and its last words, if it has ended or ends within `patience`.
  [[nodiscard]] std::optional<std::string> end_report(std::chrono::milliseconds patience = {});

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
};

}  // namespace vbar::bench_process
