#pragma once
// The state of a source of measurements as an aid of the filter: one machine for all sources.
//
//   off -> waiting (for its first usable record) -> starting (initialising) -> aiding <-> suspended -> failed
//
// A failed or suspended source deactivates its own blocks and no others; it may start again.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "fsw/core/gps_time.h"

namespace vbar::fsw::measurements {

/// Numbers of telemetry_event, states of a source.
enum class AidState : std::uint8_t {
  kOff,        ///< not selected, or not configured
  kWaiting,    ///< no usable record yet
  kStarting,   ///< records are collected to initialise something
  kAiding,     ///< its rows update the filter
  kSuspended,  ///< nothing usable for a time, or its records contradict the filter
  kFailed,     ///< its own estimates were discarded
};

/// Whether the innovations of a source are as large as its covariances state: their normalised squares, over the last
/// records. Refused records count, each with at most kMaxOfOne a degree of freedom.
class Consistency {
 public:
  static constexpr double kMemory = 50.0;  ///< records
  static constexpr int kMinRecords = 30;
  static constexpr double kMaxOfOne = 25.0;
  static constexpr double kMin = 0.05;  ///< band of the mean per degree of freedom
  static constexpr double kMax = 3.0;

  void add(double nis, int degrees) {
    if (degrees <= 0) return;
    const double most = kMaxOfOne * degrees;
    const double counted = nis < most ? nis : most;  // a NaN counts as the most
    constexpr double kKept = 1.0 - 1.0 / kMemory;
    sum_ = kKept * sum_ + counted;
    degrees_ = kKept * degrees_ + degrees;
    if (records_ < kMinRecords) ++records_;
  }
  void reset() { *this = Consistency(); }
  /// Mean per degree of freedom; 1 before enough records.
  [[nodiscard]] double mean() const { return records_ < kMinRecords ? 1.0 : sum_ / degrees_; }
  [[nodiscard]] bool is_outside() const { return mean() < kMin || mean() > kMax; }

 private:
  double sum_ = 0.0;
  double degrees_ = 0.0;
  int records_ = 0;
};

/// Times that a source discarded estimates of its own: repeatedly, if kLimit fell within kWindow.
class Restarts {
 public:
  static constexpr std::size_t kLimit = 4;
  static constexpr Duration kWindow = duration_of_seconds(3600);

  void add(GpsTime time) {
    times_[count_ % kLimit] = time;
    ++count_;
  }
  [[nodiscard]] bool are_repeated(GpsTime now) const {
    return count_ >= kLimit && now - times_[count_ % kLimit] <= kWindow;  // the oldest of the last ones
  }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  std::array<GpsTime, kLimit> times_{};
  std::size_t count_ = 0;
};

struct AidTransition {
  AidState before = AidState::kOff;
  AidState after = AidState::kOff;
  GpsTime time;
};

class Aid {
 public:
  explicit Aid(AidState initial = AidState::kOff) : state_(initial) {}

  [[nodiscard]] AidState state() const { return state_; }
  [[nodiscard]] GpsTime since() const { return since_; }
  [[nodiscard]] bool is_on() const { return state_ != AidState::kOff; }

  void go_to(AidState next, GpsTime time) {
    if (next == state_) return;
    // The last ones of more transitions than fit are merged into one.
    if (transition_count_ == kMaxTransitions) {
      transitions_.back().after = next;
      transitions_.back().time = time;
    } else {
      transitions_[transition_count_++] = {state_, next, time};
    }
    if (next == AidState::kFailed) restarts_.add(time);
    if (next == AidState::kOff || next == AidState::kFailed) consistency_.reset();
    state_ = next;
    since_ = time;
  }

  [[nodiscard]] Consistency& consistency() { return consistency_; }
  [[nodiscard]] const Consistency& consistency() const { return consistency_; }
  [[nodiscard]] Restarts& restarts() { return restarts_; }
  [[nodiscard]] const Restarts& restarts() const { return restarts_; }

  /// Its records contradict an orbit that another source confirms.
  void set_contradicting(bool is_contradicting) { is_contradicting_ = is_contradicting; }
  [[nodiscard]] bool is_contradicting() const { return is_contradicting_; }

  /// What the source has found wrong with its own estimates in this step, beside its innovations, and has responded to;
  /// in sigmas, or as a mean NIS per degree of freedom.
  void note_inconsistency(double size) { inconsistency_ = size; }
  void forget_inconsistency() { inconsistency_.reset(); }
  [[nodiscard]] const std::optional<double>& inconsistency() const { return inconsistency_; }

  /// Since forget_transitions(), in order: an event is due for each.
  [[nodiscard]] std::span<const AidTransition> transitions() const {
    return std::span(transitions_).first(transition_count_);
  }
  void forget_transitions() { transition_count_ = 0; }

 private:
  static constexpr std::size_t kMaxTransitions = 8;

  AidState state_;
  GpsTime since_;
  std::array<AidTransition, kMaxTransitions> transitions_{};
  std::size_t transition_count_ = 0;
  Consistency consistency_;
  Restarts restarts_;
  bool is_contradicting_ = false;
  std::optional<double> inconsistency_;
};

}  // namespace vbar::fsw::measurements
