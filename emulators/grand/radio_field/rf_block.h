#pragma once
// Radio field at one RF output of the emulated generator during 100 ms: the interface between generator and receivers.
//
// The generator's time is the time of the radio field; the receivers' clocks run beside it. In the field at time t a
// carrier that left the satellite's oscillator at t - carrier_m(t)/c arrives, so that the phase of the carrier against
// the generator's own oscillator is -carrier_m(t)/lambda cycles: differences between receivers and satellites of one
// signal are integers because the phase is exactly that, with no offset of its own at the start.

#include <array>
#include <vector>

#include "fsw/core/gps_time.h"
#include "host_sim/twins/gnss/satellite.h"

namespace vbar::grand::bench {

/// Quintic in seconds since the beginning of the block, metres.
struct RangePolynomial {
  std::array<double, 6> coefficients{};

  [[nodiscard]] double at(double s) const {
    double value = 0.0;
    for (std::size_t k = coefficients.size(); k-- > 0;) value = value * s + coefficients[k];
    return value;
  }
  [[nodiscard]] double rate_at(double s) const {
    double value = 0.0;
    for (std::size_t k = coefficients.size(); k-- > 1;) value = value * s + static_cast<double>(k) * coefficients[k];
    return value;
  }
};

/// Signal of one satellite. Both ranges contain geometry, relativity, the satellite's clock and the imperfections of
/// the generator; the ionosphere delays the code and advances the carrier.
struct RfSignal {
  twins::gnss::SatelliteId satellite;
  twins::gnss::Signal signal = twins::gnss::Signal::kGpsL1;
  RangePolynomial carrier_m;
  RangePolynomial code_m;  ///< the code (and message) received at t was transmitted at t - code_m(t)/c of GPS time
  double cn0_dbhz = 0.0;   ///< at the output of a perfect correlator, receiver noise included
};

/// Signals of one block, ordered by satellite, then signal; a signal that is not listed is not radiated.
struct RfBlock {
  static constexpr fsw::Duration kLength = fsw::Duration{100'000'000};

  fsw::GpsTime begin;    ///< multiple of kLength after the generator's start
  bool snapped = false;  ///< the motion jumped at the beginning of this block: every channel loses lock
  std::vector<RfSignal> signals;
};

}  // namespace vbar::grand::bench
