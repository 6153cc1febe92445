#pragma once
// A digest of satellite states and ionospheric delays over random elements of every kind that is accepted.

#include "fsw/gnss/ephemeris.h"
#include "fsw/gnss/ionosphere.h"
#include "tests/unit/fsw/same_bits/digest.h"

namespace vbar::same_bits {

inline fsw::gnss::Ephemeris random_ephemeris(Arguments& arguments, int k) {
  using fsw::gnss::Constellation;
  constexpr std::int64_t kToe = 345'600;
  fsw::gnss::Ephemeris e;
  e.satellite.constellation = static_cast<Constellation>(k % 3);
  e.satellite.prn = static_cast<std::uint8_t>(1 + k / 3 % 32);  // geostationary ones of BeiDou among them
  const std::int64_t ahead = e.satellite.constellation == Constellation::kBeidou ? 14 : 0;
  e.toe = fsw::GpsTime{} + fsw::duration_of_seconds(1658LL * 604'800 + kToe + ahead);
  e.toc = e.toe;
  e.toe_of_week_s = static_cast<double>(kToe);
  e.sqrt_a = arguments.between(5100.0, 6500.0);
  e.e = arguments.between(0.0, 0.03);
  for (double* angle : {&e.m0, &e.omega0, &e.i0, &e.omega}) *angle = arguments.between(-3.1, 3.1);
  for (double* rate : {&e.delta_n, &e.omega_dot, &e.i_dot}) *rate = arguments.between(-1e-9, 1e-9);
  for (double* harmonic : {&e.cuc, &e.cus, &e.cic, &e.cis}) *harmonic = arguments.between(-6e-5, 6e-5);
  for (double* harmonic : {&e.crc, &e.crs}) *harmonic = arguments.between(-1000.0, 1000.0);
  e.af0 = arguments.between(-1e-3, 1e-3);
  e.af1 = arguments.between(-1e-9, 1e-9);
  e.af2 = arguments.between(-1e-15, 1e-15);
  return e;
}

inline std::uint64_t gnss_digest() {
  Arguments arguments(6);
  Digest digest;
  for (int k = 0; k < 2000; ++k) {
    const fsw::gnss::Ephemeris e = random_ephemeris(arguments, k);
    const fsw::GpsTime time = e.toe + fsw::nearest_duration(arguments.between(-14'400.0, 14'400.0));
    const fsw::gnss::SatelliteState state = fsw::gnss::satellite_state(e, time).value();
    for (int axis = 0; axis < 3; ++axis) {
      digest.add(state.position_ecef(axis));
      digest.add(state.velocity_ecef(axis));
    }
    digest.add(state.clock_s);
    digest.add(state.clock_drift);
    const fsw::gnss::KlobucharCoefficients coefficients{.alpha = {2.5e-8, -7.5e-9, -1.2e-7, 1.2e-7},
                                                        .beta = {1.3e5, -1.6e4, -2.0e5, -6.5e4}};
    const fsw::gnss::LineOfSight sight{.latitude = arguments.between(-1.5, 1.5),
                                       .longitude = arguments.between(-3.1, 3.1),
                                       .azimuth = arguments.between(-3.1, 3.1),
                                       .elevation = arguments.between(0.0, 1.5)};
    digest.add(fsw::gnss::klobuchar_delay_l1_m(coefficients, sight, time).value());
  }
  return digest.value();
}

}  // namespace vbar::same_bits
