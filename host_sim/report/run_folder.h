#pragma once
// One writer at a time in a run folder.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "host_sim/report/run_record.h"
#include "host_sim/report/run_tables.h"

namespace vbar::report {

/// The folder is in use, or holds something that may not be replaced.
class FolderRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Holds `run.lock` in a folder; the file disappears with this object, or stays unlocked if the process is killed.
class RunLock {
 public:
  static constexpr const char* kFile = "run.lock";

  /// Throws FolderRefused that names the process that holds the lock, std::runtime_error if there can be no lock.
  explicit RunLock(const std::filesystem::path& folder);
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

// The folder that a run leaves, and reading it back. A folder says that its run is incomplete from the moment it exists
// until the run is known to be whole, so that a killed run can never be taken for a finished one.

/// Returns the default folder of a run: runs/<mission>-<seed>, and from the second run on runs/<mission>-<seed>.2, .3,
/// ...: the first that does not exist.
[[nodiscard]] std::filesystem::path default_run_folder(const std::string& mission, std::uint64_t seed);

[[nodiscard]] std::filesystem::path summary_file(const std::filesystem::path& run_folder);
[[nodiscard]] std::filesystem::path packet_log_file(const std::filesystem::path& run_folder);
[[nodiscard]] std::filesystem::path report_file(const std::filesystem::path& run_folder);
[[nodiscard]] std::filesystem::path view_file(const std::filesystem::path& run_folder);

/// Names of what a flight may leave in its folder beside its summary: log, tables, page, pictures, and what a kill
/// leaves of them.
[[nodiscard]] std::vector<std::string> flight_files(Extensions extensions = {});

class RunFolder {
 public:
  /// Treatment of a run that the folder already holds.
  enum class Existing { kReplace, kRefuse };

  /// Makes the folder, locks it while this object lives, and writes a summary that says the run is under way. The files
  /// of an earlier run are removed; files that no run writes stay. Throws FolderRefused that names the folder if it
  /// holds anything but a run, a run that is not to be replaced, or one under way; std::runtime_error if it cannot be
  /// made or written.
  RunFolder(std::filesystem::path folder, const Summary& start, Existing existing = Existing::kReplace,
            Extensions extensions = {});

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
  [[nodiscard]] std::filesystem::path packet_log() const { return packet_log_file(folder_); }

  /// Ends the writing of tables and pictures: summary.json alone remains of the run.
  void leave_out_tables() { with_tables_ = false; }

  /// Writes what has been added to the tables since the last call, so that a killed run leaves them. Throws
  /// std::runtime_error that names the file that could not be written, here and below.
  void update(const RunRecord& record);

  /// Writes the tables, then the summary, which alone may say that the run is complete. If it throws, the folder still
  /// says incomplete.
  void finish(const RunRecord& record);

  /// Writes, after finish() threw, a summary that says why the record is incomplete, in the space that was reserved for
  /// it where the disk is full. Without space the summary that says that the run was killed stays.
  void give_up(Summary summary, const std::string& reason) const;

 private:
  void keep_room_for_summary() const;

  std::filesystem::path folder_;
  TableWriter tables_;
  bool with_tables_ = true;
  std::optional<RunLock> lock_;
};

/// Throws std::runtime_error that names the file and the line for a folder that is no run's, or damaged.
[[nodiscard]] RunRecord read_run(const std::filesystem::path& run_folder, Extensions extensions = {});

}  // namespace vbar::report
