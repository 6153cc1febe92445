#pragma once
// Mode retreat: one burn away from the target, a drift, and station-keeping on a safe orbit.
//
// The burn is known before it is needed: it is computed in every step whose situation is known, and kept where it is
// not. Transfer and station-keeping begin when navigation suffices to plan and nothing calls for a retreat any more.

#include <cstdint>

#include "fsw/core/gps_time.h"
#include "fsw/gnc/management.h"
#include "fsw/safety/retreat.h"

namespace vbar::fsw::gnc {

class RetreatSequence {
 public:
  /// Numbers of telemetry_safety.phase.
  enum class Phase : std::int8_t { kNone = 0, kBurn = 1, kRecede = 2, kTransfer = 3, kKeep = 4 };

  /// The situation of the step, as far as it is known.
  struct Situation {
    bool is_known = false;          ///< the estimate suffices to plan
    bool is_demanded = false;       ///< a fault that calls for a retreat is present
    bool is_drift_unsafe = false;   ///< without another burn the distance is not kept
    Vector6 roe = Vector6::Zero();  ///< estimated mean ROE, dimensionless
  };

  /// Replaces the burn that a retreat begins with: valid at `time`.
  void prepare(GpsTime time, const safety::RetreatBurn& burn);
  [[nodiscard]] bool is_prepared() const { return is_prepared_; }
  [[nodiscard]] const safety::RetreatBurn& burn() const { return burn_; }

  /// The mode has become retreat.
  void begin();
  /// The mode has become another one.
  void end() { phase_ = Phase::kNone; }
  /// One step in mode retreat.
  void update(GpsTime now, const Situation& situation, const Management& management);

  [[nodiscard]] Phase phase() const { return phase_; }
  /// The burn to be commanded now, at `time`; zero if none is known.
  [[nodiscard]] Vector3 burn_at(GpsTime time) const;
  /// It has been commanded for `time`.
  void commanded(GpsTime time);
  /// The safe orbit, in the phases of transfer and station-keeping; null in others.
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
  int burns_ = 0;  ///< of this retreat
  Waypoint hold_orbit_;
};

}  // namespace vbar::fsw::gnc
