#pragma once
// Exit codes of vbar, which scripts and schedulers rely on. `vbar --help` prints this list.

#include <stdexcept>

namespace vbar::app {

enum ExitCode : int {
  kDone = 0,             ///< complete; of a replay: identical to the record
  kFailed = 1,           ///< the run, propagation or replay failed; the message says why
  kRefused = 2,          ///< bad usage or input; nothing was flown and nothing written
  kDifferent = 3,        ///< replay, resume, report --fail-if-different: the outputs differ
  kKilledRun = 4,        ///< replay: the run was killed and left no summary; what it left is identical
  kEmptyLog = 5,         ///< replay: the log is empty
  kCutLog = 6,           ///< replay: the log is cut at its end
  kThinnedLog = 7,       ///< replay, resume: records are missing from the middle of the log
  kForeignLog = 8,       ///< replay: the log holds outputs other than those that the summary states
  kDamagedLog = 9,       ///< replay, resume: the log is damaged or was altered after the run
  kNeverNavigated = 10,  ///< run: complete, but the flight software never had a valid state
  kLimitMissed = 11,     ///< check: a run is incomplete or misses a limit
  kNotAchieved = 12,     ///< run: complete, but its mission was not achieved (host_sim/report/verdict.h)
  kInterrupted = 75  ///< Ctrl-C, SIGTERM or SIGHUP ended it; the record up to then is kept (EX_TEMPFAIL of sysexits.h)
};

inline constexpr const char* kExitCodeHelp =
    "Exit codes: 0 complete and achieved, or identical, 1 failed, 2 refused (bad usage or input), 3 outputs differ, 75 "
    "interrupted.\n"
    "vbar run also: 10 complete, but the flight software never had a valid state; 12 complete, but the mission was\n"
    "not achieved: missed, navigation lost, retreated or unsafe.\n"
    "vbar replay also: 4 the run was killed, 5 log empty, 6 log cut at its end, 7 records missing from the middle,\n"
    "8 log of other outputs than the summary states, 9 log damaged or altered after the run; vbar resume also 7 and "
    "9.\n"
    "vbar check also: 11 a run is incomplete or misses a limit.";

/// Bad usage or input, noticed before anything was flown or written.
class Refused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace vbar::app
