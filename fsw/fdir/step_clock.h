#pragma once
// Acceptance of the time of a step: a clock that jumps must neither silence the flight software nor carry its state to
// another time unnoticed.

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"

namespace vbar::fsw::fdir {

class StepClock {
 public:
  /// Longest accepted time between two steps: one and a half times the age up to which a snapshot is continued, so that
  /// a link that was down for that long is not a jump. After a longer time navigation restarts in any case.
  static constexpr Duration kLongestGap = duration_of_seconds(900);
  /// Number of rejected ticks in a row, each one period after the last, whose successor is accepted: the clock did
  /// jump.
  static constexpr int kConsistentTicks = 3;

  enum class Verdict {
    kContinue,  ///< the next step
    kRestart,   ///< the clock was set: the state belongs to another time
    kRefuse,
  };

  /// Judges `now`, usable as a time, after a step at `last`. `period` is that of the tick, 0 if unknown.
  Verdict judge(GpsTime last, GpsTime now, Duration period) {
    const bool is_next = now > last && now - last <= (period > kLongestGap ? period : kLongestGap);
    const bool is_consistent = count_ > 0 && period.ns > 0 && now - refused_ == period;
    if (is_next || accepts_next_ || (is_consistent && count_ >= kConsistentTicks)) {
      *this = {};
      return is_next ? Verdict::kContinue : Verdict::kRestart;
    }
    count_ = is_consistent ? count_ + 1 : 1;
    refused_ = now;
    return Verdict::kRefuse;
  }

  /// Accepts the next time, by telecommand.
  void accept_next() { accepts_next_ = true; }

 private:
  GpsTime refused_;  ///< last rejected time
  int count_ = 0;    ///< rejected in a row, consistent with each other
  bool accepts_next_ = false;
};

}  // namespace vbar::fsw::fdir
