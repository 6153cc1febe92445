#pragma once
// One flight of a case: `vbar run` in a process of its own, and what it left.

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign/folder.h"
#include "host_sim/campaign/plan.h"
#include "host_sim/campaign/result.h"
#include "host_sim/io/child_process.h"

namespace vbar::campaign {

/// Name of this computer, and the type of its processor.
struct Computer {
  std::string host, processor;
};
[[nodiscard]] Computer this_computer();

/// Executes the arguments that follow the program's name; the result is its exit code.
using CommandLine = std::function<int(const std::vector<std::string>& arguments)>;

class CaseFlight {
 public:
  struct Request {
    const Folder& folder;
    const Plan& plan;
    const Case& one;
    std::string attempt;  ///< its name: of the run folder while it flies
    bool full_record = false;
    /// Runs a command line of vbar, without the program, in this process; null: the copied program is started.
    const CommandLine* command_line = nullptr;
  };

  /// Starts the process, in a folder that no other attempt has. Throws std::runtime_error if it cannot be started.
  explicit CaseFlight(const Request& request);
  ~CaseFlight();
  CaseFlight(const CaseFlight&) = delete;
  CaseFlight& operator=(const CaseFlight&) = delete;

  /// kResult: the case succeeded or failed by itself. kKilled: it is to be flown again. kTrouble: the computer or the
  /// campaign failed, not the case (a full disk, a program that does not start); nothing more can be flown here.
  struct End {
    enum class Kind { kResult, kKilled, kTrouble };
    Kind kind = Kind::kResult;
    Result result = {};
    std::string reason = {};
  };

  /// Returns the end once the process has ended, or has flown for too long and was ended.
  [[nodiscard]] std::optional<End> poll();

  [[nodiscard]] const Case& one() const { return one_; }
  [[nodiscard]] const std::string& attempt() const { return attempt_; }
  [[nodiscard]] const std::filesystem::path& run_folder() const { return run_folder_; }
  [[nodiscard]] std::int64_t process() const { return child_->pid(); }

 private:
  [[nodiscard]] End judge();
  [[nodiscard]] End judge_failure(Result result, const Json& summary) const;

  const Case one_;
  const std::string attempt_, identity_;
  const double time_limit_s_;
  std::filesystem::path run_folder_;
  std::unique_ptr<io::ChildProcess> child_;
  std::chrono::steady_clock::time_point started_;
  bool over_time_ = false;
};

}  // namespace vbar::campaign
