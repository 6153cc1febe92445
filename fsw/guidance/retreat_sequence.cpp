#include "fsw/guidance/retreat_sequence.h"

#include "fsw/math/math.h"

namespace vbar::fsw::guidance {
namespace {

// Longest age of a burn of the menu, which depends on the place in the orbit. Its along-track part does not.
constexpr Duration kMenuIsCurrent = duration_of_seconds(120);

// Time after the burn until measurements show its effect.
constexpr Duration kSettling = duration_of_seconds(600);

}  // namespace

void RetreatSequence::prepare(GpsTime time, const safety::RetreatBurn& burn) {
  prepared_ = time;
  burn_ = burn;
  is_prepared_ = true;
}

void RetreatSequence::begin() {
  phase_ = is_prepared_ ? Phase::kBurn : Phase::kRecede;
  burns_ = 0;
}

Vector3 RetreatSequence::burn_at(GpsTime time) const {
  if (!is_prepared_) return Vector3::Zero();
  const bool is_current = time - prepared_ <= kMenuIsCurrent && prepared_ - time <= kMenuIsCurrent;
  if (is_current || burn_.choice == safety::RetreatChoice::kReceding) return burn_.dv_rtn;
  return {0.0, burn_.dv_rtn(1), 0.0};
}

void RetreatSequence::commanded(GpsTime time) {
  burned_ = time;
  ++burns_;
  phase_ = Phase::kRecede;
}

void RetreatSequence::update(GpsTime now, const Situation& situation, const Management& management) {
  const bool has_settled = burns_ == 0 || now - burned_ > kSettling;
  switch (phase_) {
    case Phase::kNone:
    case Phase::kBurn:
      return;
    case Phase::kRecede:
      if (!situation.is_known || !has_settled) return;
      if ((situation.is_drift_unsafe || burns_ == 0) && burns_ < kMaxBurns) {
        phase_ = Phase::kBurn;
      } else if (!situation.is_demanded) {
        choose_hold_orbit(situation.roe, management);
        phase_ = Phase::kTransfer;
      }
      return;
    case Phase::kTransfer:
    case Phase::kKeep:
      if (situation.is_demanded) {
        begin();
        return;
      }
      if (!situation.is_known) return;
      const double error_m =
          management.reference_semi_major_axis() * math::sqrt((situation.roe - hold_orbit_.roe).squaredNorm());
      if (error_m <= 2.0 * management.configuration().station_keeping_deadband_m) phase_ = Phase::kKeep;
      return;
  }
}

/// Places the hold orbit on the side of the target where the servicer is, not nearer than the servicer is, with
/// parallel eccentricity and inclination vectors: an error of the drift does not reduce their separation across the
/// flight direction.
void RetreatSequence::choose_hold_orbit(const Vector6& roe, const Management& management) {
  const safety_configuration& safety = *management.safety();
  const double a = management.reference_semi_major_axis();
  const double side = roe(1) < 0.0 ? -1.0 : 1.0;
  const double distance =
      math::abs(a * roe(1)) > safety.hold_distance_m ? math::abs(a * roe(1)) : safety.hold_distance_m;
  hold_orbit_ = {};
  hold_orbit_.control_mode = waypoint::kSolverKoenigDamico;
  hold_orbit_.roe(1) = side * distance / a;
  hold_orbit_.roe(3) = safety.hold_separation_m / a;
  hold_orbit_.roe(5) = safety.hold_separation_m / a;
  hold_orbit_.keep_out_radius_m = safety.contact_distance_m;
}

}  // namespace vbar::fsw::guidance
