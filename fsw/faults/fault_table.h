#pragma once
// The table of all faults: how long a detection must persist, and the response. The names and bits are those of
// vbar.lcm, telemetry_health.kFault...

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "fsw/packets/messages.h"

namespace vbar::fsw::faults {

// Persistence of a detection, the counter that all faults use.

/// Counts detections. A detection is persistent once `limit` of the last `window` checks detect it, until none of them
/// does.
class Persistence {
 public:
  static constexpr int kMaxWindow = 64;

  /// Requires 1 <= limit <= window <= kMaxWindow.
  constexpr Persistence(int limit, int window) : limit_(limit), window_(window) {}

  /// Records a check. Returns whether the detection is persistent after it.
  constexpr bool add(bool is_detected) {
    const std::uint64_t mask = window_ == kMaxWindow ? ~std::uint64_t{0} : (std::uint64_t{1} << window_) - 1;
    history_ = ((history_ << 1U) | (is_detected ? 1U : 0U)) & mask;
    if (detections() >= limit_) is_persistent_ = true;
    if (history_ == 0) is_persistent_ = false;
    return is_persistent_;
  }
  [[nodiscard]] constexpr bool is_persistent() const { return is_persistent_; }
  constexpr void reset() {
    history_ = 0;
    is_persistent_ = false;
  }

 private:
  /// Returns the number of detections within the window.
  [[nodiscard]] constexpr int detections() const {
    int count = 0;
    for (int k = 0; k < window_; ++k) count += static_cast<int>((history_ >> static_cast<unsigned>(k)) & 1U);
    return count;
  }

  std::uint64_t history_ = 0;  ///< checks in the window, the latest in the lowest bit
  int limit_;
  int window_;
  bool is_persistent_ = false;
};

/// Response of the flight software while a fault is present, besides the report.
enum class Response : std::uint8_t {
  kReport,   ///< none: the ground must act, or the event is over
  kIsolate,  ///< what failed is not used: its data are rejected or replaced, or the source is suspended; if no other
             ///< source confirms the orbit, its covariance is inflated instead (fsw/navigation/measurement_scheduler.h)
  kHold,     ///< no burn is planned or commanded but the retreat
  kRetreat,  ///< mode retreat
};

struct Rule {
  std::int32_t fault = 0;    ///< bit of telemetry_health.faults
  std::int8_t severity = 0;  ///< telemetry_event.kSeverity
  int limit = 1;             ///< number of the last `window` checks that must detect it
  int window = 1;
  Response response = Response::kReport;
};

using vbar::telemetry_event;
using vbar::telemetry_health;

// The comment states the argument of the event. A check is one step, image, epoch or burn, as its detector has it.
inline constexpr auto kFaultTable = std::to_array<Rule>({
    // navigation
    {telemetry_health::kFaultNavigationTimeout, telemetry_event::kSeverityFault},                      // age, s
    {telemetry_health::kFaultNeverNavigated, telemetry_event::kSeverityFault},                         // time, s
    {telemetry_health::kFaultImagesMissing, telemetry_event::kSeverityFault},                          // camera
    {telemetry_health::kFaultImageFrozen, telemetry_event::kSeverityFault, 1, 1, Response::kIsolate},  // camera
    {telemetry_health::kFaultPoseNetwork, telemetry_event::kSeverityFault, 3, 3, Response::kIsolate},  // rad
    {telemetry_health::kFaultAttitude, telemetry_event::kSeverityFault, 2, 3, Response::kIsolate},     // rad
    {telemetry_health::kFaultReceiverSilent, telemetry_event::kSeverityFault},                         // silence, s
    {telemetry_health::kFaultCrosslinkSilent, telemetry_event::kSeverityWarning},                      // silence, s
    // mean NIS per degree of freedom, or sigmas of an estimate that the source itself has found inconsistent
    {telemetry_health::kFaultSourceInconsistent, telemetry_event::kSeverityWarning, 1, 1, Response::kIsolate},
    // restarts; the source is isolated as well
    {telemetry_health::kFaultSourceRestarts, telemetry_event::kSeverityFault, 1, 1, Response::kHold},
    {telemetry_health::kFaultSourcesContradict, telemetry_event::kSeverityFault, 1, 1, Response::kIsolate},  // mean NIS
    {telemetry_health::kFaultState, telemetry_event::kSeverityFault, 1, 1, Response::kIsolate},  // Integrity
    // guidance
    {telemetry_health::kFaultHold, telemetry_event::kSeverityFault},                                   // holds so far
    {telemetry_health::kFaultDriftUnsafe, telemetry_event::kSeverityFault, 2, 3, Response::kRetreat},  // distance, m
    {telemetry_health::kFaultCollisionProbability, telemetry_event::kSeverityFault, 2, 3, Response::kRetreat},
    {telemetry_health::kFaultRetreat, telemetry_event::kSeverityFault},  // size, m/s
    // burns
    {telemetry_health::kFaultBurnRefused, telemetry_event::kSeverityWarning},                              // maneuver
    {telemetry_health::kFaultBurnMissed, telemetry_event::kSeverityWarning},                               // maneuver
    {telemetry_health::kFaultBurnLate, telemetry_event::kSeverityWarning},                                 // delay, s
    {telemetry_health::kFaultBurnSize, telemetry_event::kSeverityWarning},                                 // scale
    {telemetry_health::kFaultBurnUncommanded, telemetry_event::kSeverityFault, 1, 1, Response::kRetreat},  // m/s
    {telemetry_health::kFaultThruster, telemetry_event::kSeverityFault, 2, 2, Response::kHold},            // scale
    // guard
    {telemetry_health::kFaultGuardRange, telemetry_event::kSeverityFault, 1, 1, Response::kRetreat},    // ln ratio
    {telemetry_health::kFaultGuardSilence, telemetry_event::kSeverityFault, 1, 1, Response::kRetreat},  // age, s
    {telemetry_health::kFaultGuardBurns, telemetry_event::kSeverityFault, 2, 2, Response::kRetreat},    // difference
    {telemetry_health::kFaultGuardClosing, telemetry_event::kSeverityFault, 3, 5, Response::kRetreat},  // rate, m/s
    // computer
    {telemetry_health::kFaultInboxFull, telemetry_event::kSeverityWarning},  // packets
    {telemetry_health::kFaultClock, telemetry_event::kSeverityFault},        // jump, s
    {telemetry_health::kFaultStepLate, telemetry_event::kSeverityWarning},   // delay, s
    {telemetry_health::kFaultRestart, telemetry_event::kSeverityWarning},    // age of state, s
    {telemetry_health::kFaultColdStart, telemetry_event::kSeverityWarning},  // Status
});

inline constexpr std::size_t kFaultCount = kFaultTable.size();

namespace detail {
constexpr bool is_complete() {
  std::uint32_t seen = 0;
  for (const Rule& rule : kFaultTable) {
    const auto bit = static_cast<std::uint32_t>(rule.fault);
    if (!std::has_single_bit(bit) || (seen & bit) != 0) return false;
    if (rule.limit < 1 || rule.limit > rule.window || rule.window > Persistence::kMaxWindow) return false;
    seen |= bit;
  }
  return seen == (std::uint32_t{1} << kFaultCount) - 1;
}
}  // namespace detail
static_assert(detail::is_complete(), "one rule for each fault of vbar.lcm, whose bits have no gap");

/// Returns the place in the table of a fault given by its bit.
constexpr std::size_t place_of(std::int32_t fault) {
  for (std::size_t k = 0; k < kFaultCount; ++k) {
    if (kFaultTable[k].fault == fault) return k;
  }
  return 0;
}

}  // namespace vbar::fsw::faults
