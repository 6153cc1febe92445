#pragma once
// The emulated bench of a testbed as a child process of the run, in a directory of its own that is removed with it.
// Once the bench listens it writes where to addresses.json, whose form is the testbed's.

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

/// What the bench acknowledges of its faults, a line each.
inline constexpr const char* kFaultsFile = "faults.jsonl";

/// Faults that have taken effect, by their kind; lines of another form count as "unknown". None without the file.
[[nodiscard]] std::map<std::string, int> count_faults(const std::filesystem::path& file);

/// The words of a command line, separated by spaces; {directory}, {seed} and {data} are replaced in each.
[[nodiscard]] std::vector<std::string> bench_arguments(const std::string& command_line,
                                                       const std::filesystem::path& directory, std::uint64_t seed,
                                                       const std::filesystem::path& data_directory);

class BenchProcess {
 public:
  /// Starts it and waits until it has written its addresses. A program without a slash is searched beside this
  /// program, then in PATH. Throws std::runtime_error, one sentence, if it does not start.
  BenchProcess(const std::string& command_line, std::uint64_t seed, const std::filesystem::path& data_directory);
  ~BenchProcess();
  BenchProcess(const BenchProcess&) = delete;
  BenchProcess& operator=(const BenchProcess&) = delete;

  /// Until stop().
  [[nodiscard]] std::filesystem::path addresses_file() const { return directory_ / kAddressesFile; }
  [[nodiscard]] const std::filesystem::path& directory() const { return directory_; }
  /// The program and every file named by its arguments.
  [[nodiscard]] const std::vector<report::FileDigest>& files() const { return files_; }

  /// Of the scenario, that have taken effect, by kind; after stop().
  [[nodiscard]] const std::map<std::string, int>& faults() const { return faults_; }

  /// If it has ended, or ends within `patience`: how, and its last words.
  [[nodiscard]] std::optional<std::string> end_report(std::chrono::milliseconds patience = {});

  /// Ends it and removes the directory.
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
