#pragma once
// What the receiver decoder promises of whatever it reports, however the bytes came about.

#include <cmath>

#include "fsw/gnss/receiver_decoder.h"

namespace vbar::test {

inline bool keeps_promises(const fsw::gnss::ObservationEpoch& epoch) {
  if (epoch.count > fsw::gnss::kMaxObservations || epoch.receiver_time.ns <= 0) return false;
  for (std::size_t k = 0; k < epoch.count; ++k) {
    const fsw::gnss::Observation& o = epoch.observations[k];
    for (const double value : {o.pseudorange_m, o.carrier_phase_cycles, o.doppler_hz, o.pseudorange_sigma_m,
                               o.phase_sigma_cycles, o.cn0_dbhz, o.lock_time_s}) {
      if (!std::isfinite(value)) return false;
    }
    if (o.satellite.prn == 0 || !(o.pseudorange_m >= 1e7 && o.pseudorange_m <= 6e7)) return false;
    if (k == 0) continue;
    const fsw::gnss::Observation& before = epoch.observations[k - 1];
    if (o.satellite < before.satellite) return false;
    if (o.satellite == before.satellite && o.signal <= before.signal) return false;
  }
  return true;
}

/// Finite throughout, in order, and an ephemeris gives a state at its reference time.
inline bool keeps_promises(const fsw::gnss::ReceiverDecoder& decoder, fsw::gnss::ReceiverUpdate update) {
  using fsw::gnss::ReceiverUpdate;
  switch (update) {
    case ReceiverUpdate::kNone:
      return true;
    case ReceiverUpdate::kObservations:
      return keeps_promises(decoder.observations());
    case ReceiverUpdate::kEphemeris: {
      const auto state = fsw::gnss::satellite_state(decoder.ephemeris(), decoder.ephemeris().toe);
      return state.ok() && state.value().position_ecef.allFinite() && state.value().velocity_ecef.allFinite() &&
             std::isfinite(state.value().clock_s);
    }
    case ReceiverUpdate::kIonosphere:
      return fsw::gnss::check(decoder.ionosphere()) == fsw::Status::kOk;
    case ReceiverUpdate::kClock:
      return std::isfinite(decoder.receiver_clock().offset_s) && std::isfinite(decoder.receiver_clock().sigma_s);
    case ReceiverUpdate::kPosition:
      return decoder.position().position_ecef.allFinite() && decoder.position().velocity_ecef.allFinite() &&
             decoder.position().position_sigma_m.allFinite() && decoder.position().velocity_sigma_mps.allFinite();
  }
  return false;
}

}  // namespace vbar::test
