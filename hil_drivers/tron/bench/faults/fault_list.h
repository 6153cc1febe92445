#pragma once
// Faults of a session: each begins when it is due, lasts for its images, cycles or seconds, and is acknowledged
// when it has taken effect, on the control line and as one line of JSON in a file.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "hil_drivers/bench_lines/fault_log.h"
#include "hil_drivers/tron/bench/faults/bench_fault.h"

namespace vbar::tron::bench {

class FaultList {
 public:
  /// Lets a fault begin or end. A fault of FaultSpan::kOnce only begins.
  using Act = std::function<void(const Fault& fault, bool is_on)>;

  /// Opens `file`, which gets a line for each fault that took effect. Throws std::runtime_error if it cannot be made.
  FaultList(Act act, const std::filesystem::path& file);

  /// Adds a fault. `now_s`: wall clock, the same in all calls.
  void add(const Fault& fault, double now_s, bench_lines::Acknowledge acknowledge = {});

  /// Begins the faults that are due before a robot cycle, from 1.
  void begin_cycle(std::uint64_t cycle, double now_s);
  /// Counts the exposure with this number, from 0, after it has ended.
  void end_exposure(std::uint64_t image, double now_s);
  /// Counts a frame of motion capture, after it was sent.
  void vicon_frame_sent();
  /// Ends faults whose seconds have passed, in between.
  void advance(double now_s);

 private:
  enum class Phase { kWaiting, kDue, kActive, kOver };
  struct Entry {
    Fault fault;
    bench_lines::Acknowledge acknowledge;
    Phase phase = Phase::kWaiting;
    bool is_acknowledged = false;
    std::uint64_t due_cycle = 0, begun_cycle = 0, begun_image = 0;
    double begun_s = 0.0;
  };
  void step(Entry& entry, double now_s);
  void begin(Entry& entry, double now_s);
  void end(Entry& entry);
  [[nodiscard]] bool is_due(const Fault& fault) const;
  [[nodiscard]] bool is_over(const Entry& entry, double now_s) const;
  void take_effect(FaultEffect effect);
  void acknowledge(Entry& entry);

  Act act_;
  bench_lines::FaultLog log_;
  std::vector<Entry> entries_;
  std::uint64_t cycle_ = 0;  ///< the present one
  std::uint64_t image_ = 0;  ///< number of the next exposure
};

}  // namespace vbar::tron::bench
