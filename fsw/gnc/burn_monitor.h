#pragma once
// Burns as commanded against burns as executed: refused, late, missing, of another size, or never commanded; and the
// ratio of executed to commanded size, by which commands are corrected.

#include <array>
#include <cstddef>
#include <cstdint>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/faults/fault_monitor.h"
#include "fsw/gnc/inbox.h"

namespace vbar::fsw::gnc {

/// Ratio of executed to commanded size: one state, updated by each report. It is constant but for a slow drift, and for
/// jumps, after which it is learnt again.
class BurnScale {
 public:
  /// `ratio` of a burn of `dv` m/s.
  void update(double ratio, double dv);
  /// Within kMinScale and kMaxScale: a thruster off by more is not corrected but failed.
  [[nodiscard]] double scale() const {
    return scale_ < kMinScale ? kMinScale : (scale_ > kMaxScale ? kMaxScale : scale_);
  }
  [[nodiscard]] double sigma() const { return sigma_; }
  /// Whether it differs from one by more than `share` and by more than this multiple of its sigma.
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
  /// A burn was commanded.
  void expect(std::int32_t maneuver_id, GpsTime time, const Vector3& dv_rtn);

  /// Checks the reports of the step, and burns of which none has come.
  void update(GpsTime now, const Inbox& inbox, faults::FaultMonitor& faults);

  [[nodiscard]] const BurnScale& scale() const { return scale_; }
  /// Burns reported so far, other than refused or missing ones.
  [[nodiscard]] std::int32_t executed() const { return executed_; }

 private:
  struct Commanded {
    std::int32_t id = 0;
    GpsTime time;
    Vector3 dv_rtn = Vector3::Zero();
  };

  void judge(const Commanded& commanded, GpsTime time, const executed_maneuver& report, GpsTime now,
             faults::FaultMonitor& faults);
  void forget(std::size_t k);

  static constexpr std::size_t kMaxCommanded = 32;  // of a step at most 16, each reported within minutes

  std::array<Commanded, kMaxCommanded> commanded_{};
  std::size_t count_ = 0;
  std::int32_t executed_ = 0;
  BurnScale scale_;
};

}  // namespace vbar::fsw::gnc
