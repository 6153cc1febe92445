#include "hil_drivers/grand/pps/timer_edges.h"

#include <algorithm>
#include <thread>

namespace vbar::grand {
namespace {

using Clock = std::chrono::steady_clock;

class TimerEdges final : public EdgeSource {
 public:
  std::optional<Edge> next(Clock::time_point deadline) override {
    const Clock::time_point due = start_ + std::chrono::seconds(count_);
    if (Clock::now() < due) std::this_thread::sleep_until(std::min(due, deadline));
    if (Clock::now() < due) return std::nullopt;
    return Edge{std::nullopt, due.time_since_epoch(), count_++};
  }
  [[nodiscard]] std::string description() const override { return "timer"; }

 private:
  Clock::time_point start_ = Clock::now();
  std::uint32_t count_ = 0;
};

}  // namespace

const EdgeSourceKind kTimerEdges{"timer", "timer", false, [](const std::string&) -> std::unique_ptr<EdgeSource> {
                                   return std::make_unique<TimerEdges>();
                                 }};

}  // namespace vbar::grand
