#pragma once
// Which ticks are taken: time goes forward, in steps that are not too long, unless several ticks in a row agree that it
// has jumped.

#include "fsw/core/gps_time.h"

namespace vbar::fsw::gnc {

class TickGate {
 public:
  /// Longer than any outage that a state is propagated through, shorter than what would make all packets look old.
  static constexpr Duration kLongestJump = duration_of_seconds(1800);
  /// Ticks in a row that agree with each other and not with the last step.
  static constexpr int kAgreeing = 3;

  enum class Verdict : unsigned char { kTaken, kBackward, kTooFarAhead };

  /// `now`: a usable time.
  Verdict judge(GpsTime now) {
    if (!has_last_ || (now > last_ && now - last_ <= kLongestJump)) return take(now);
    const bool agrees = refused_ > 0 && now > last_refused_ && now - last_refused_ <= kLongestJump;
    refused_ = agrees ? refused_ + 1 : 1;
    last_refused_ = now;
    if (now <= last_) return Verdict::kBackward;
    return refused_ >= kAgreeing ? take(now) : Verdict::kTooFarAhead;
  }

 private:
  Verdict take(GpsTime now) {
    has_last_ = true;
    last_ = now;
    refused_ = 0;
    return Verdict::kTaken;
  }

  bool has_last_ = false;
  GpsTime last_;
  int refused_ = 0;  ///< in a row, in agreement with each other
  GpsTime last_refused_;
};

}  // namespace vbar::fsw::gnc
