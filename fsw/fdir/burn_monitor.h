#pragma once
// Comparison of commanded with executed burns: rejected, late, missing, of another size, or never commanded. The ratio
// of executed to commanded size is estimated, and commands are corrected by it.

#include <array>
#include <cstddef>
#include <cstdint>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/faults/fault_monitor.h"
#include "fsw/messaging/inbox.h"

namespace vbar::fsw::fdir {

/// Estimates the ratio of executed to commanded size: one state, updated by each report. The ratio drifts slowly; after
/// a jump its estimate is re-initialised.
class BurnScale {
 public:
  /// Updates the estimate by the `ratio` of a burn of `dv` m/s.
  void update(double ratio, double dv);
  /// Returns the ratio, limited to kMinScale and kMaxScale: a thruster that errs by more has failed and is not
  /// corrected.
  [[nodiscard]] double scale() const {
    return scale_ < kMinScale ? kMinScale : (scale_ > kMaxScale ? kMaxScale : scale_);
  }
  [[nodiscard]] double sigma() const { return sigma_; }
  /// Returns whether the ratio differs from one by more than `share` and by more than this multiple of its sigma.
  [[nodiscard]] bool differs(double share, double sigmas) const;

  static constexpr double kMinScale = 0.5;
  static constexpr double kMaxScale = 2.0;

 private:
  static constexpr double kInitialSigma = 0.1;

  double scale_ = 1.0;
  double sigma_ = kInitialSigma;
};

class BurnMonitor {
 public:
  /// Notes a commanded burn, whose report is due at its `end`; that of an impulse is its time.
  void expect(std::int32_t maneuver_id, GpsTime time, const Vector3& dv_rtn, GpsTime end);
  void expect(std::int32_t maneuver_id, GpsTime time, const Vector3& dv_rtn) {
    expect(maneuver_id, time, dv_rtn, time);
  }

  /// Checks the reports of the step, and the burns that remain without a report.
  void update(GpsTime now, const messaging::Inbox& inbox, faults::FaultMonitor& faults);

  [[nodiscard]] const BurnScale& scale() const { return scale_; }
  /// Returns the number of burns reported as executed so far.
  [[nodiscard]] std::int32_t executed() const { return executed_; }

 private:
  struct Commanded {
    std::int32_t id = 0;
    GpsTime time;
    Vector3 dv_rtn = Vector3::Zero();
    GpsTime end;
  };

  void judge(const Commanded& commanded, GpsTime time, const executed_maneuver& report, GpsTime now,
             faults::FaultMonitor& faults);
  void forget(std::size_t k);

  static constexpr std::size_t kMaxCommanded = 32;  // at most 16 in a step, each reported within minutes

  std::array<Commanded, kMaxCommanded> commanded_{};
  std::size_t count_ = 0;
  std::int32_t executed_ = 0;
  BurnScale scale_;
};

}  // namespace vbar::fsw::fdir
