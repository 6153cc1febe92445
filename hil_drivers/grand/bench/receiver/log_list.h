#pragma once
// Logs that have been requested: at most 30 over all ports.

#include <cstdint>
#include <vector>

#include "hil_drivers/grand/bench/receiver/commands.h"
#include "hil_drivers/grand/bench/receiver/log_kinds.h"

namespace vbar::grand::bench {

struct LogRequest {
  int port = 0;  ///< port to which the log goes
  const LogKind* kind = nullptr;
  LogFormat format = LogFormat::kBinary;
  Trigger trigger = Trigger::kOnce;
  std::int64_t period = 0;  ///< in multiples of 10 ms
  std::int64_t offset = 0;
  bool hold = false;

  /// Returns true if an ONTIME log is due at the epoch of this number (10 ms each).
  [[nodiscard]] bool due_at(std::int64_t epoch) const {
    return trigger == Trigger::kOnTime && (epoch - offset) % period == 0;
  }
};

class LogList {
 public:
  static constexpr std::size_t kMaxLogs = 30;

  /// Adds a request; it replaces the request for the same log on the same port. `port` is the number of the port,
  /// resolved.
  Response add(const Command& command, int port);
  /// Removes the log, held or not.
  void remove(int port, std::uint16_t id, LogFormat format);
  /// Removes all logs of the port (-1: of all ports); held ones only with `held`.
  void remove_all(int port, bool held);
  void remove(const LogRequest& request) {
    remove(request.port, static_cast<std::uint16_t>(request.kind->id), request.format);
  }

  [[nodiscard]] bool any_due_at(std::int64_t epoch) const;
  [[nodiscard]] const std::vector<LogRequest>& requests() const { return requests_; }

 private:
  std::vector<LogRequest> requests_;
};

}  // namespace vbar::grand::bench
