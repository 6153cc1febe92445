#include "hil_drivers/tron/robot/robot_pair.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

namespace vbar::tron {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kSettledCycles = 25;
constexpr double kSettled_rad = 0.0005 * kDegree, kSettled_m = 0.005e-3;
constexpr int kVirtualPatience = 20;
/// Cycles between two looks at the states of Ethernet KRL: the notice of a stop takes so long at most.
constexpr std::uint64_t kLookEvery = 5;
constexpr auto kPollInterval = std::chrono::milliseconds(20);
/// Number of starts of RSI while an arm comes to rest: a second.
constexpr int kStartTries = 50;

Posture posture_of(const rsi::AxisPositions& camera, const rsi::AxisPositions& target, double track_home_m) {
  return {camera.axes_rad, target.axes_rad, track_home_m + camera.track_m};
}

bool is_stopped(const eki::State& state) {
  return state.emergency_stop || state.stopped || !state.drives_powered || !state.rsi_on;
}

std::string words(const std::string& name, const eki::State& state) {
  if (state.emergency_stop) return name + ": emergency stop";
  if (!state.message.empty()) return name + ": " + state.message;
  if (!state.drives_powered) return name + ": drives off";
  return name + ": RSI has ended";
}

/// One robot: both of its lines.
struct OneRobot {
  explicit OneRobot(const rsi::ClientSettings& settings) : rsi(settings) {}

  rsi::Client rsi;
  std::optional<eki::Client> eki;
  std::optional<rsi::State> state;  ///< to be answered; none: RSI is off

  [[nodiscard]] const rsi::AxisPositions& measured() const { return last; }
  rsi::AxisPositions last;

  void take(const rsi::State& received) {
    state = received;
    last = received.measured;
  }
};

}  // namespace

struct RobotPair::Parts {
  explicit Parts(const RobotPairSettings& of)
      : settings(of), camera(of.camera_rsi), target(of.target_rsi), silence(of.silence_patience) {}

  // ---- one cycle

  /// Answers both and receives the next states. False: a robot was silent, or has stopped.
  bool cycle(const Posture& command) {
    answer(camera, {command.camera_rad, command.carriage_m - settings.track_home_m});
    answer(target, {command.target_rad, 0.0});
    const bool has_camera = receive(camera), has_target = receive(target);
    const bool both = has_camera && has_target;
    if (both) count_cycle();
    if (both && counts.cycles % kLookEvery == 0) return look();
    return both;
  }

  void count_cycle() {
    ++counts.cycles;
    if (settings.on_cycle) settings.on_cycle(counts.cycles);
  }

  static void answer(OneRobot& robot, const rsi::AxisPositions& command) {
    if (!robot.state) return;
    robot.rsi.answer(command);
    robot.state.reset();
  }

  bool receive(OneRobot& robot) {
    const auto state = robot.rsi.receive(silence);
    if (!state) return false;
    robot.take(*state);
    counts.delay_max = std::max(counts.delay_max, state->delay);
    counts.skipped_states += state->skipped;
    return !state->ipoc_not_newer;
  }

  /// False: a controller has stopped.
  bool look() {
    camera.eki->poll();
    target.eki->poll();
    return !is_stopped(camera.eki->last_state()) && !is_stopped(target.eki->last_state());
  }

  /// Commands the arms to hold where they are commanded.
  [[nodiscard]] Posture commanded() const {
    return posture_of(camera.rsi.last_command(), target.rsi.last_command(), settings.track_home_m);
  }

  [[nodiscard]] Posture measured() const {
    return posture_of(camera.measured(), target.measured(), settings.track_home_m);
  }

  // ---- motion

  MotionEnd run(const Motion& motion) {
    for (int k = 1; k <= motion.cycles; ++k) {
      if (is_cancelled) return interrupted();
      if (cycle(motion.at(k))) continue;
      // The other arm stops along its path; what no longer answers is left alone.
      if (k < motion.cycles && motion.stop_after) {
        const Motion stop = motion.stop_after(k);
        for (int j = 1; j <= stop.cycles; ++j) hold_what_answers(stop.at(j));
      }
      return interrupted();
    }
    return MotionEnd::kArrived;
  }

  MotionEnd interrupted() {
    ++counts.interruptions;
    return MotionEnd::kInterrupted;
  }

  /// A cycle of the robots that still send states.
  void hold_what_answers(const Posture& command) {
    const bool has_camera = camera.state.has_value(), has_target = target.state.has_value();
    if (!has_camera && !has_target) return;
    answer(camera, {command.camera_rad, command.carriage_m - settings.track_home_m});
    answer(target, {command.target_rad, 0.0});
    if (has_camera) static_cast<void>(receive(camera));
    if (has_target) static_cast<void>(receive(target));
    count_cycle();
  }

  MotionEnd settle() {
    const Posture at = commanded();
    const int limit = static_cast<int>(settings.settle_limit_s / rsi::kCycle_s);
    Posture before = measured();
    for (int quiet = 0, k = 0; quiet < kSettledCycles; ++k) {
      if (is_cancelled || !cycle(at)) return interrupted();
      const Posture now = measured();
      const double moved_rad = std::max((now.camera_rad - before.camera_rad).cwiseAbs().maxCoeff(),
                                        (now.target_rad - before.target_rad).cwiseAbs().maxCoeff());
      const bool is_quiet = moved_rad < kSettled_rad && std::abs(now.carriage_m - before.carriage_m) < kSettled_m;
      quiet = is_quiet ? quiet + 1 : 0;
      before = now;
      if (k > limit)
        throw std::runtime_error(
            fmt::format("robots: not at rest {} s of bench time after a motion; the last cycle "
                        "moved a joint by {:.4f} deg",
                        settings.settle_limit_s, moved_rad / kDegree));
    }
    return MotionEnd::kArrived;
  }

  // ---- start and recovery

  /// Starts RSI of a robot and waits for its first state.
  void start(OneRobot& robot) {
    robot.rsi.restart();
    robot.state.reset();
    eki::State state = robot.eki->status();
    if (state.rsi_on) state = robot.eki->stop();
    if (is_stopped(state) && (state.stopped || !state.drives_powered)) state = robot.eki->reset();
    state = robot.eki->start();
    // Rejected while the axes still move, to the end of a stop.
    for (int k = 0; k < kStartTries && !state.rsi_on; ++k) {
      let_time_pass();
      state = robot.eki->start();
    }
    const std::string& name = robot.rsi.settings().name;
    if (!state.rsi_on) throw std::runtime_error(words(name, state) + "; RSI does not start");
    const auto first = robot.rsi.receive(settings.start_patience);
    if (!first)
      throw std::runtime_error(fmt::format("{}: RSI has started, but no state came to UDP port {} within {} ms", name,
                                           robot.rsi.port(), settings.start_patience.count()));
    robot.take(*first);
  }

  /// Whether the robot runs; false: the operator has to clear its stop.
  bool restore(OneRobot& robot) {
    const eki::State state = robot.eki->status();
    if (state.emergency_stop) return false;
    if (is_stopped(state) || !robot.state) {
      start(robot);
      ++counts.rsi_restarts;
    }
    return true;
  }

  /// Bench time passes as long as one robot takes answers.
  void let_time_pass() {
    if (camera.state || target.state) {
      for (std::uint64_t k = 0; k < kLookEvery; ++k) hold_what_answers(commanded());
    } else {
      std::this_thread::sleep_for(kPollInterval);
      idle_s += std::chrono::duration<double>(kPollInterval).count();
    }
  }

  // ---- the thread that holds the arms in real time

  void begin_holding() {
    if (settings.is_virtual) return;
    holder = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        {
          const std::scoped_lock lock(mutex);
          if (callers == 0) hold_what_answers(commanded());
        }
        if (callers > 0 || (!camera.state && !target.state)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
  }

  /// A caller's turn at the robots.
  class Turn {
   public:
    explicit Turn(Parts& parts) : parts_(parts) {
      ++parts_.callers;
      lock_ = std::unique_lock(parts_.mutex);
    }
    ~Turn() { --parts_.callers; }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    Parts& parts_;
    std::unique_lock<std::mutex> lock_;
  };

  RobotPairSettings settings;
  OneRobot camera, target;
  std::chrono::milliseconds silence;
  RobotPairCounts counts;
  double idle_s = 0.0;  ///< wall clock waited while no robot took answers
  std::atomic<bool> is_cancelled{false};
  std::atomic<int> callers{0};
  std::mutex mutex;
  std::jthread holder;  // last: it uses all the others
};

RobotPair::RobotPair(const RobotPairSettings& settings) : parts_(std::make_unique<Parts>(settings)) {}

RobotPair::~RobotPair() {
  close();
}

std::uint16_t RobotPair::camera_rsi_port() const {
  return parts_->camera.rsi.port();
}
std::uint16_t RobotPair::target_rsi_port() const {
  return parts_->target.rsi.port();
}

void RobotPair::open(const eki::ClientSettings& camera_eki, const eki::ClientSettings& target_eki, bool is_virtual) {
  Parts& parts = *parts_;
  parts.settings.is_virtual = is_virtual;
  // Bench time stands still while it is computed elsewhere: a loaded machine is not a silent robot.
  parts.silence = parts.settings.silence_patience * (is_virtual ? kVirtualPatience : 1);
  parts.camera.eki.emplace(camera_eki);
  parts.target.eki.emplace(target_eki);
  parts.start(parts.camera);
  parts.start(parts.target);
  parts.begin_holding();
}

void RobotPair::close() noexcept {
  Parts& parts = *parts_;
  parts.is_cancelled = true;
  parts.holder = std::jthread();
  for (OneRobot* const robot : {&parts.camera, &parts.target}) {
    try {
      if (robot->state) {
        robot->rsi.answer_stop();
        robot->state.reset();
      }
      if (robot->eki) static_cast<void>(robot->eki->stop());
    } catch (const std::exception&) {
      // Gone already.
    }
    robot->eki.reset();
  }
}

Posture RobotPair::posture() const {
  const Parts::Turn turn(*parts_);
  return parts_->measured();
}

Posture RobotPair::command() const {
  const Parts::Turn turn(*parts_);
  return parts_->commanded();
}

MotionEnd RobotPair::follow(const Motion& motion) {
  const Parts::Turn turn(*parts_);
  const MotionEnd end = parts_->run(motion);
  return end == MotionEnd::kArrived ? parts_->settle() : end;
}

MotionEnd RobotPair::hold(int cycles) {
  const Parts::Turn turn(*parts_);
  const Posture at = parts_->commanded();
  return parts_->run({cycles, [&at](int /*cycle*/) { return at; }, nullptr});
}

void RobotPair::recover(const std::function<void(const std::string&)>& report) {
  const Parts::Turn turn(*parts_);
  Parts& parts = *parts_;
  const std::uint64_t first = parts.counts.cycles;
  const double idle_s = parts.idle_s;
  bool is_reported = false;
  while (!parts.is_cancelled) {
    const bool camera_runs = parts.restore(parts.camera), target_runs = parts.restore(parts.target);
    if (camera_runs && target_runs) return;
    const OneRobot& waited = camera_runs ? parts.target : parts.camera;
    const std::string reason = words(waited.rsi.settings().name, waited.eki->last_state());
    if (!is_reported && report) report(reason + "; waiting until it is cleared");
    is_reported = true;
    const double waited_s = static_cast<double>(parts.counts.cycles - first) * rsi::kCycle_s + parts.idle_s - idle_s;
    if (waited_s > parts.settings.operator_timeout_s)
      throw std::runtime_error(fmt::format("{}; not cleared within {} s", reason, parts.settings.operator_timeout_s));
    parts.let_time_pass();
  }
  throw std::runtime_error("robots: stopped");
}

Posture RobotPair::rest_posture() {
  const Parts::Turn turn(*parts_);
  const auto joints = [](const eki::RobotState& state) {
    Joints angles;
    for (Eigen::Index k = 0; k < 6; ++k) angles(k) = state.axes_deg[static_cast<std::size_t>(k)] * kDegree;
    return angles;
  };
  const eki::RobotState camera = parts_->camera.eki->pose(), target = parts_->target.eki->pose();
  return {joints(camera), joints(target), parts_->settings.track_home_m + 1e-3 * camera.track_mm};
}

void RobotPair::cancel() noexcept {
  parts_->is_cancelled = true;
}

double RobotPair::time_s() const {
  const Parts::Turn turn(*parts_);
  return static_cast<double>(parts_->counts.cycles) * rsi::kCycle_s;
}

RobotPairCounts RobotPair::counts() const {
  const Parts::Turn turn(*parts_);
  RobotPairCounts counts = parts_->counts;
  for (const OneRobot* const robot : {&parts_->camera, &parts_->target}) {
    counts.foreign_datagrams += robot->rsi.foreign_datagrams();
    counts.unreadable_datagrams += robot->rsi.unreadable_datagrams();
  }
  return counts;
}

}  // namespace vbar::tron
