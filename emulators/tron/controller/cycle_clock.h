#pragma once
// Bench time, in robot cycles of 4 ms, of both controllers.
//
// kVirtual: the next cycle begins when every robot that waits for an answer has a valid one, or `patience` of wall
// clock after the first datagram that arrived in the cycle. Until a datagram arrives, bench time stands still; so it
// does while no robot has RSI on, once the arms stand. kReal: a cycle is 4 ms of wall clock.
//
// A cycle: functions of before_cycle() (faults by cycle; lights' socket, so that what was sent before an answer acts
// before its cycle) -> the controllers take the answers and move -> functions of after_motion() (Vicon frames of the
// time passed, camera) -> <Rob> to the computer -> answers.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "emulators/tron/controller/controller.h"

namespace vbar::tron::bench {

enum class ClockKind { kVirtual, kReal };

struct ClockSettings {
  ClockKind kind = ClockKind::kVirtual;
  std::chrono::milliseconds patience{10000};
  /// Virtual clock: bench time waits for the first datagram of a cycle for ever. False: for `patience` only.
  bool waits_for_first_answer = true;
};

class CycleClock {
 public:
  using Function = std::function<void(std::uint64_t cycle)>;

  /// The controllers outlive the clock.
  CycleClock(boost::asio::io_context& context, const ClockSettings& settings, std::vector<Controller*> controllers);
  ~CycleClock();
  CycleClock(const CycleClock&) = delete;
  CycleClock& operator=(const CycleClock&) = delete;

  /// Registers a call with the number of the cycle that begins, from 1; in the order of registration.
  void before_cycle(Function function);
  void after_motion(Function function);

  /// Starts the clock; the rest happens in handlers of the io_context. stop() ends it.
  void start();
  void stop();

  [[nodiscard]] std::uint64_t cycle() const;
  /// Returns the number of cycles of the real clock that began more than 4 ms late; bench time is behind the wall clock
  /// since then.
  [[nodiscard]] std::uint64_t overruns() const;
  /// Returns 4 ms times cycle().
  [[nodiscard]] double time_s() const;

 private:
  struct Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace vbar::tron::bench
