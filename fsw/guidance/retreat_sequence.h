#pragma once
// Mode retreat: one burn away from the target, a drift, and station-keeping on a safe orbit.
//
// The burn is prepared before it is needed: every step with a known situation computes it, and other steps keep the
// last one. Transfer and station-keeping begin when navigation suffices to plan and no fault demands a retreat any
// more.

#include <cstdint>

#include "fsw/core/gps_time.h"
#include "fsw/guidance/management.h"
#include "fsw/safety/retreat.h"

namespace vbar::fsw::guidance {

class RetreatSequence {
 public:
  /// Phases, with the numbers of telemetry_safety.phase.
  enum class Phase : std::int8_t { kNone = 0, kBurn = 1, kRecede = 2, kTransfer = 3, kKeep = 4 };

  /// Describes the situation of the step.
  struct Situation {
    bool is_known = false;          ///< the estimate suffices to plan
    bool is_demanded = false;       ///< a fault that demands a retreat is present
    bool is_drift_unsafe = false;   ///< without another burn the distance is not kept
    Vector6 roe = Vector6::Zero();  ///< estimated mean ROE, dimensionless
  };

  /// Replaces the burn that a retreat begins with; it is valid at `time`.
  void prepare(GpsTime time, const safety::RetreatBurn& burn);
  [[nodiscard]] bool is_prepared() const { return is_prepared_; }
  [[nodiscard]] const safety::RetreatBurn& burn() const { return burn_; }

  /// Begins the retreat, when the mode becomes retreat.
  void begin();
  /// Ends the retreat, when the mode becomes another one.
  void end() { phase_ = Phase::kNone; }
  /// Updates the phase in a step in mode retreat.
  void update(GpsTime now, const Situation& situation, const Management& management);

  [[nodiscard]] Phase phase() const { return phase_; }
  /// Returns the burn to be commanded now for `time`; zero if none is prepared.
  [[nodiscard]] Vector3 burn_at(GpsTime time) const;
  /// Notes that the burn has been commanded for `time`.
  void commanded(GpsTime time);
  /// Returns the safe orbit in the phases of transfer and station-keeping, else nullptr.
  [[nodiscard]] const Waypoint* hold_orbit() const {
    return phase_ == Phase::kTransfer || phase_ == Phase::kKeep ? &hold_orbit_ : nullptr;
  }

 private:
  void choose_hold_orbit(const Vector6& roe, const Management& management);

  static constexpr int kMaxBurns = 3;

  Phase phase_ = Phase::kNone;
  bool is_prepared_ = false;
  GpsTime prepared_;
  safety::RetreatBurn burn_;
  GpsTime burned_;
  int burns_ = 0;  ///< number of burns of this retreat
  Waypoint hold_orbit_;
};

}  // namespace vbar::fsw::guidance
