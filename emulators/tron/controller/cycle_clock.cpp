#include "emulators/tron/controller/cycle_clock.h"

#include <algorithm>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "emulators/tron/controller/controller_core.h"

namespace vbar::tron::bench {
namespace {

using WallClock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kCycle{rsi::kCycle_ms};

}  // namespace

struct CycleClock::Loop {
  enum class Phase { kStopped, kStandsStill, kWaits, kMoves };

  Loop(boost::asio::io_context& given, const ClockSettings& clock, std::vector<Controller*> robots)
      : context(given), settings(clock), controllers(std::move(robots)), timer(given), alive(std::make_shared<int>()) {
    for (Controller* controller : controllers) {
      controller->core_->on_datagram = [this] { check_answers(); };
      controller->core_->on_rsi_start = [this] { join(); };
    }
  }

  ~Loop() {
    for (Controller* controller : controllers) {
      controller->core_->on_datagram = nullptr;
      controller->core_->on_rsi_start = nullptr;
    }
  }

  [[nodiscard]] bool is_virtual() const { return settings.kind == ClockKind::kVirtual; }

  template <class Predicate>
  [[nodiscard]] bool any(Predicate predicate) const {
    return std::any_of(controllers.begin(), controllers.end(),
                       [&](const Controller* controller) { return predicate(*controller->core_); });
  }
  [[nodiscard]] bool any_waits() const {
    return any([](const Controller::Core& core) { return core.link.waits(); });
  }
  [[nodiscard]] bool any_reached() const {
    return any([](const Controller::Core& core) { return core.link.was_reached(); });
  }
  /// Something happens without an answer: axes that brake, a robot that is silent.
  [[nodiscard]] bool any_active() const {
    return any([](const Controller::Core& core) { return core.rsi_on || !core.servo.stands(); });
  }

  void start() {
    if (phase != Phase::kStopped) return;
    phase = Phase::kStandsStill;
    if (is_virtual()) return await_answers();
    next_tick = WallClock::now() + kCycle;
    tick();
  }

  void begin_cycle() {
    phase = Phase::kMoves;
    ++cycle;
    for (const Function& function : before) function(cycle);
    for (Controller* controller : controllers) controller->core_->move();
    for (const Function& function : after) function(cycle);
    for (Controller* controller : controllers) controller->core_->send_state();
    // One of the functions may have stopped the clock.
    if (phase == Phase::kMoves) await_answers();
  }

  /// The states of the cycle are sent.
  void await_answers() {
    phase = Phase::kWaits;
    has_deadline = false;
    if (!is_virtual()) return;
    if (any_waits()) {
      if (!settings.waits_for_first_answer) set_deadline();
      return;
    }
    phase = Phase::kStandsStill;
    // Other handlers, those of faults and documents, come first.
    if (any_active())
      boost::asio::post(context, [this, watch = std::weak_ptr(alive)] {
        if (!watch.expired() && phase == Phase::kStandsStill) begin_cycle();
      });
  }

  void check_answers() {
    if (!is_virtual() || phase != Phase::kWaits) return;
    if (!any_waits()) return begin_cycle();
    if (any_reached() && !has_deadline) set_deadline();
  }

  /// RSI was switched on: the robot takes part in the cycle that waits.
  void join() {
    if (!is_virtual() || (phase != Phase::kWaits && phase != Phase::kStandsStill)) return;
    for (Controller* controller : controllers) controller->core_->send_state();
    if (phase == Phase::kStandsStill) await_answers();
  }

  /// The timer is not set again every cycle: when it ends it looks at the deadline.
  void set_deadline() {
    deadline = WallClock::now() + settings.patience;
    has_deadline = true;
    if (!timer_runs) run_timer();
  }

  void run_timer() {
    timer_runs = true;
    timer.expires_at(deadline);
    timer.async_wait([this, watch = std::weak_ptr(alive)](const boost::system::error_code& error) {
      if (watch.expired() || error) return;
      timer_runs = false;
      if (!has_deadline || phase != Phase::kWaits) return;
      if (WallClock::now() < deadline) return run_timer();
      begin_cycle();
    });
  }

  void tick() {
    timer.expires_at(next_tick);
    timer.async_wait([this, watch = std::weak_ptr(alive)](const boost::system::error_code& error) {
      if (watch.expired() || error || phase == Phase::kStopped) return;
      const auto now = WallClock::now();
      if (now - next_tick > kCycle) {
        ++overruns;
        next_tick = now;
      }
      next_tick += kCycle;
      begin_cycle();
      if (phase != Phase::kStopped) tick();
    });
  }

  boost::asio::io_context& context;
  ClockSettings settings;
  std::vector<Controller*> controllers;
  boost::asio::steady_timer timer;
  std::vector<Function> before, after;
  std::shared_ptr<int> alive;  ///< handlers that are under way ask whether this object is
  WallClock::time_point next_tick, deadline;
  Phase phase = Phase::kStopped;
  bool has_deadline = false, timer_runs = false;
  std::uint64_t cycle = 0, overruns = 0;
};

CycleClock::CycleClock(boost::asio::io_context& context, const ClockSettings& settings,
                       std::vector<Controller*> controllers)
    : loop_(std::make_unique<Loop>(context, settings, std::move(controllers))) {}

CycleClock::~CycleClock() = default;

void CycleClock::before_cycle(Function function) {
  loop_->before.push_back(std::move(function));
}

void CycleClock::after_motion(Function function) {
  loop_->after.push_back(std::move(function));
}

void CycleClock::start() {
  loop_->start();
}

void CycleClock::stop() {
  loop_->phase = Loop::Phase::kStopped;
  loop_->timer_runs = false;
  loop_->timer.cancel();
}

std::uint64_t CycleClock::cycle() const {
  return loop_->cycle;
}

std::uint64_t CycleClock::overruns() const {
  return loop_->overruns;
}

double CycleClock::time_s() const {
  return static_cast<double>(cycle()) * rsi::kCycle_s;
}

}  // namespace vbar::tron::bench
