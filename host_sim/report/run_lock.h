#pragma once
// One writer at a time in a run folder.

#include <filesystem>
#include <stdexcept>

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

}  // namespace vbar::report
